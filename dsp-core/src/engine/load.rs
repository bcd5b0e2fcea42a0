//! From a kit to a playing engine.

use core::fmt;

use super::fitting::{All, Fitting, Stage, Within};
use super::pad_set::PadSet;
use super::{Engine, FilterRoom, Skipping, Surroundings, TickReport};
use crate::SampleRate;
use crate::biquad::BiquadError;
use crate::contact::Flight;
use crate::dynamic_filter::DynamicFilterError;
use crate::pad::{Pad, PadTables, group_count};
use crate::resonator::{Bank, BankError, Memory, Mode, Used, max_decay_per_s};
use crate::room::RoomError;
use crate::table::{Kit, TableError};

/// What an engine has room for, all pads together.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Capacity {
    /// Banks: a pad's object, and its strikers up to the last one with modes.
    pub banks: usize,
    /// Modes.
    pub modes: usize,
    /// Register groups.
    pub groups: usize,
    /// Modes of pads that can be choked or have several positions.
    pub origins: usize,
}

/// Why a kit cannot be played by this engine.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum LoadError {
    /// The kit has no pad.
    NoPads,
    /// The kit has more pads than the engine.
    TooManyPads {
        /// Pads of the kit.
        pads: usize,
        /// Pads of the engine.
        capacity: usize,
    },
    /// More pads with a residual, the background counting as one, than the engine has room for.
    TooManyResiduals {
        /// The first pad whose residual finds no room, or `None` for the background.
        pad: Option<u8>,
        /// Room of the engine.
        capacity: usize,
    },
    /// A band of noise reaches beyond half the sample rate.
    BeyondNyquist {
        /// Which pad's residual, or `None` for the background.
        pad: Option<u8>,
        /// The highest edge, in Hz.
        edge_hz: f32,
        /// The rate at which it was loaded.
        rate: SampleRate,
    },
    /// The kit's room cannot be built.
    Room(RoomError),
    /// More pads with a dynamic filter or biquads than the engine has room for.
    TooManyFilters {
        /// The first pad whose filters find no room.
        pad: u8,
        /// Room of the engine.
        capacity: usize,
    },
    /// The engine has neither memory nor code for such a stage. Only of [`Engine::load_what_fits`]: otherwise it is passed over.
    NoPlace {
        /// Which stage.
        stage: Stage,
    },
    /// A stage for which there is no time in a tick beside the pads, the room and the background. Only of [`Engine::load_what_fits`].
    TooDear {
        /// Which stage.
        stage: Stage,
        /// Cycles of its dearest tick, with the cycle model's worst case and the waits of flash.
        cycles: u32,
        /// Cycles that are left.
        left: u32,
    },
    /// A dynamic filter or a biquad bank in the kit is none.
    FilterTable(TableError),
    /// The dynamic filter of a pad's object cannot be built at this rate, or in this memory.
    DynamicFilter {
        /// Which pad.
        pad: u8,
        /// What.
        error: DynamicFilterError,
    },
    /// The biquad bank of a pad's object cannot be built at this rate, or in this memory.
    Biquads {
        /// Which pad.
        pad: u8,
        /// What.
        error: BiquadError,
    },
    /// Something of a pad does not fit.
    Pad {
        /// Which pad.
        pad: usize,
        /// Which of its strikers' banks, or `None` for its object's.
        striker: Option<usize>,
        /// What.
        error: BankError,
        /// What the engine has room for.
        capacity: Capacity,
        /// The rate at which it was loaded.
        rate: SampleRate,
    },
}

impl fmt::Display for LoadError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::NoPads => write!(f, "the kit has no pads: there is nothing to play"),
            Self::TooManyPads { pads, capacity } => {
                write!(f, "pads: {pads}, this engine has room for {capacity}")
            }
            Self::TooManyResiduals { pad, capacity } => {
                match pad {
                    Some(pad) => write!(f, "pad {pad}, residual of its object: ")?,
                    None => write!(f, "background: ")?,
                }
                write!(f, "residuals: more than {capacity}, the background counting as one: take some out of the kit")
            }
            Self::BeyondNyquist { pad, edge_hz, rate } => {
                match pad {
                    Some(pad) => write!(f, "pad {pad}, residual of its object: ")?,
                    None => write!(f, "background: ")?,
                }
                write!(
                    f,
                    "edges_hz = {edge_hz}: must be at most {} Hz at {rate}; leave out the bands above",
                    rate.hz() / 2.0
                )
            }
            Self::Room(error) => error.fmt(f),
            Self::TooManyFilters { pad, capacity } => write!(
                f,
                "pad {pad}, filters of its object: pads with a dynamic filter or biquads: more than {capacity}: take some out of the kit"
            ),
            Self::NoPlace { stage } => write!(f, "{stage}: this engine has none"),
            Self::TooDear { stage, cycles, left } => write!(
                f,
                "{stage}: takes up to {cycles} cycles a tick, and {left} are left beside pads, room and background: fewer of those, or a smaller one"
            ),
            Self::FilterTable(error) => error.fmt(f),
            Self::DynamicFilter { pad, error } => write!(f, "pad {pad}, dynamic filter of its object: {error}"),
            Self::Biquads { pad, error } => write!(f, "pad {pad}, biquads of its object: {error}"),
            Self::Pad { pad, striker, error, capacity: Capacity { banks, modes, groups, origins }, rate } => {
                write!(f, "pad {pad}, ")?;
                match striker {
                    Some(striker) => write!(f, "striker {striker} of the pad: ")?,
                    None => write!(f, "its object: ")?,
                }
                match error {
                    BankError::TooManyModes => {
                        write!(f, "modes: more than the {modes} that this engine has room for in all")
                    }
                    BankError::TooManyGroups => {
                        write!(f, "modes: more than the {groups} register groups that this engine has room for in all")
                    }
                    BankError::TooManyOrigins => write!(
                        f,
                        "modes: more than {origins} modes in all of pads with choke_t60_s above 0 or several positions"
                    ),
                    BankError::TooManyBanks => write!(
                        f,
                        "banks: more than {banks} in all: a pad has one for its object, and one for each striker up to the last one with modes"
                    ),
                    BankError::DecayTooFast { mode, decay_per_s } => write!(
                        f,
                        "mode {mode}: decay_per_s = {decay_per_s}: must be at most {:.1} at {rate}",
                        max_decay_per_s(rate)
                    ),
                    BankError::GainTooLarge => write!(
                        f,
                        "gain_sine or gain_cosine times reference_force (and striker_weight): must be below 2^14 times the rate"
                    ),
                }
            }
        }
    }
}

impl core::error::Error for LoadError {}

impl<
    'k,
    const PADS: usize,
    const BANKS: usize,
    const MODES: usize,
    const GROUPS: usize,
    const ORIGINS: usize,
    const CONTACTS: usize,
    S: Surroundings,
> Engine<'k, PADS, BANKS, MODES, GROUPS, ORIGINS, CONTACTS, S>
{
    /// Derives all stages from a kit for a sample rate and sets time to 0. What rang before is gone.
    ///
    /// Coefficients are derived in software `f64` on a Cortex-M4F: thousands of cycles a mode, not for the audio path.
    ///
    /// # Errors
    /// A [`LoadError`]; the engine is then without a kit and silent.
    pub fn load(&mut self, kit: &Kit<'k>, rate: SampleRate, skipping: Skipping) -> Result<(), LoadError> {
        self.load_all(kit, rate, skipping, All)
    }

    /// Loads all pads, and of the room, the background, residuals and filters, in this order and pad by pad, what there is memory for and what alone takes no
    /// more than what is left of `stage_cycles` a tick by the pads, the room and the background. `tell` is told what is left out, and why; the kit plays
    /// without it.
    ///
    /// A filter that modes go through takes its time for good. Residuals and filters that sound at once take no more than what is left, either: where a strike finds no time for one, it goes without
    /// ([`TickReport::refused_stages`]). The [budget](Self::set_budget) sheds modes, not stages. These cycles are the cycle model's worst, with the waits of flash.
    ///
    /// # Errors
    /// A [`LoadError`] for pads that do not fit, and for a table that is none; the engine is then without a kit and silent.
    pub fn load_what_fits(
        &mut self,
        kit: &Kit<'k>,
        rate: SampleRate,
        skipping: Skipping,
        stage_cycles: u32,
        mut tell: impl FnMut(LoadError),
    ) -> Result<(), LoadError> {
        self.load_all(kit, rate, skipping, Within::new(stage_cycles, kit.pads().len(), &mut tell))
    }

    fn load_all(
        &mut self,
        kit: &Kit<'k>,
        rate: SampleRate,
        skipping: Skipping,
        mut fitting: impl Fitting,
    ) -> Result<(), LoadError> {
        // One by one: an array would be made on the stack.
        self.banks.iter_mut().for_each(|bank| *bank = Bank::EMPTY);
        (self.pad_count, self.idle, self.expects, self.retired_amplitude) = (0, false, false, 0.0);
        (self.noisy, self.filtered) = (false, PadSet::NONE);
        self.modes.fill(Mode::SILENT);
        self.flight = Flight::EMPTY;
        self.report = TickReport::EMPTY;
        (self.rate, self.skipping, self.now) = (Some(rate), skipping, 0);
        self.load_pads(kit, rate)?;
        // First what sounds on: what it takes is not there for what strikes begin.
        self.load_room(kit, rate, &mut fitting)?;
        self.load_noise(kit, rate, &mut fitting)?;
        self.filters.load(kit, rate, &mut fitting)?;
        self.stage_cycles = fitting.left();
        self.noisy = self.has_any_noise();
        (self.pad_count, self.kit) = (kit.pads().len(), Some(*kit));
        for pad in (0..self.pad_count as u8).filter(|&pad| self.filters.has(pad)) {
            self.filtered.insert(pad);
        }
        self.modes_built = self.pads().iter().map(|pad| pad.mode_count() as u32).sum();
        self.groups_built = self.pads().iter().map(|pad| group_count(pad.own(&self.banks))).sum();
        Ok(())
    }

    #[inline(never)] // its stack is not that of the stages that follow
    fn load_pads(&mut self, kit: &Kit<'k>, rate: SampleRate) -> Result<(), LoadError> {
        let pads = kit.pads().len();
        // Events count pads in a byte.
        let capacity = PADS.min(usize::from(u8::MAX));
        match pads {
            0 => return Err(LoadError::NoPads),
            _ if pads > capacity => return Err(LoadError::TooManyPads { pads, capacity }),
            _ => {}
        }
        let mut memory = Memory { modes: &mut self.modes, groups: &mut self.groups, origins: &mut self.origins };
        let mut used = Used::default();
        for (index, slot) in self.pads.iter_mut().take(pads).enumerate() {
            let Some(tables) = PadTables::new(*kit, index) else { continue };
            let loaded = Pad::load(&tables, rate, &mut memory, &mut used, &mut self.banks);
            *slot = loaded.map_err(|(error, striker)| LoadError::Pad {
                pad: index,
                striker,
                error,
                capacity: Capacity { banks: BANKS, modes: MODES, groups: GROUPS, origins: ORIGINS },
                rate,
            })?;
        }
        // Memory that is left then serves second positions.
        self.banks.iter_mut().take(used.banks).for_each(|bank| bank.reserve_second(&memory, &mut used));
        Ok(())
    }
}
