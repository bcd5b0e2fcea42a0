//! A pad: one struck object with its strikers (diffimpact eq. 1 without residual, background and room).
//!
//! ```text
//! contacts of striker s --> F_s --+--> η · striker bank s --+
//! direct force (counts as s = 0) -+                         |
//!                                 +-- F = Σ F_s --> object bank --+--> level, pan --> stereo
//!                                              \--> α · F --------+
//! ```
//!
//! A second strike adds energy to the same ringing banks.

mod render;
mod tables;

pub use tables::PadTables;

use crate::SampleRate;
use crate::contact::law::{Impact, StrikerLaw, typical_contact};
use crate::fixed;
use crate::output::Panner;
use crate::radiation::Acceleration;
use crate::resonator::{Bank, BankError, BankWork, Group, Memory, Retirement, Used};
use crate::table::layout::STRIKERS_PER_PAD;
use crate::table::{Kit, Object, Pad as PadTable};
use tables::{object_table, striker_table};

/// A pad's stages and their state.
#[derive(Clone, Debug)]
pub struct Pad {
    object: Bank,
    /// The first `striker_count` are the pad's.
    strikers: [PadStriker; STRIKERS_PER_PAD],
    striker_count: u8,
    /// Those of the strikers that come up to the last one with modes.
    sounding_strikers: u8,
    mode_count: u16,
    acceleration: Acceleration,
    panner: Panner,
    /// |force| that contacts which have just begun will bring, until the banks are guarded for it.
    expected: u64,
    choked: bool,
    struck: bool,
    /// Coming ticks in which no bank has anything to do, and those of them that have passed without the banks' knowing.
    rest_ticks: u8,
    passed_ticks: u8,
    /// Sum of the banks' retired amplitudes at the last tick that had something to do.
    retired_amplitude: f32,
}

#[derive(Clone, Debug)]
struct PadStriker {
    law: StrikerLaw,
    bank: Bank,
}

impl PadStriker {
    const NONE: Self = Self { law: StrikerLaw::NONE, bank: Bank::EMPTY };
}

/// What a pad did over a run of frames.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct PadWork {
    /// The object's bank.
    pub object: BankWork,
    /// All strikers' banks.
    pub strikers: BankWork,
    /// Frames for which the acceleration sound was computed.
    pub acceleration_frames: u32,
    /// Frames for which a direct force was taken in.
    pub direct_frames: u32,
    /// Frames in which a force was made or taken in.
    pub force_frames: u32,
}

/// A run of frames of at most a tick, as a pad renders it.
#[derive(Clone, Copy, Debug)]
pub struct Run<'a> {
    /// Number of frames.
    pub frames: usize,
    /// Whether the first frame's absolute number is odd.
    pub odd_start: bool,
    /// Whether what is not needed may be left out.
    pub skip: bool,
    /// Direct force for this pad, Q4.27.
    pub direct: Option<&'a [i32]>,
}

impl Pad {
    /// A pad without object or strikers.
    pub const EMPTY: Self = Self {
        object: Bank::EMPTY,
        strikers: [PadStriker::NONE; STRIKERS_PER_PAD],
        striker_count: 0,
        sounding_strikers: 0,
        mode_count: 0,
        acceleration: Acceleration::NONE,
        panner: Panner::SILENT,
        expected: 0,
        choked: false,
        struck: false,
        rest_ticks: 0,
        passed_ticks: 0,
        retired_amplitude: 0.0,
    };

    /// Derives a pad from its tables for a sample rate. `which` names, in case of an error, the bank: `None` the object's, or a striker's.
    ///
    /// # Errors
    /// A [`BankError`] and the bank that it concerns.
    pub fn load(
        kit: &Kit<'_>,
        pad: PadTable<'_>,
        object: &Object<'_>,
        rate: SampleRate,
        memory: &mut Memory<'_>,
        used: &mut Used,
    ) -> Result<Self, (BankError, Option<usize>)> {
        let reference_force = object.reference_force();
        let first = kit.strikers_of(pad).next();
        let contact = first.map_or((0.0, 0.0), |striker| typical_contact(&striker, reference_force));
        let table = object_table(object, pad, contact);
        let mut strikers = [PadStriker::NONE; STRIKERS_PER_PAD];
        let (mut striker_count, mut sounding_strikers) = (0, 0);
        let mut mode_count = 0;
        let object_bank = Bank::load(&table, rate, memory, used).map_err(|error| (error, None))?;
        for (index, (slot, striker)) in strikers.iter_mut().zip(kit.strikers_of(pad)).enumerate() {
            let law = StrikerLaw::new(&striker, reference_force, rate);
            let table = striker_table(&striker, pad, reference_force, typical_contact(&striker, reference_force));
            let bank = Bank::load(&table, rate, memory, used).map_err(|error| (error, Some(index)))?;
            mode_count += bank.mode_count();
            *slot = PadStriker { law, bank };
            striker_count += 1;
            if slot.bank.mode_count() > 0 {
                sounding_strikers = striker_count;
            }
        }
        mode_count += object_bank.mode_count();
        Ok(Self {
            object: object_bank,
            mode_count: mode_count as u16, // all banks count in 16 bits
            strikers,
            striker_count,
            sounding_strikers,
            acceleration: Acceleration::new(object.acceleration(), reference_force),
            panner: Panner::new(pad.level_db(), pad.pan()),
            ..Self::EMPTY
        })
    }

    /// Number of strikers.
    pub fn striker_count(&self) -> usize {
        usize::from(self.striker_count)
    }

    /// All strikers that make a sound, and possibly others.
    #[inline(always)]
    fn sounding(&self) -> &[PadStriker] {
        self.strikers.get(..usize::from(self.sounding_strikers)).unwrap_or(&[])
    }

    #[inline(always)]
    fn sounding_mut(&mut self) -> &mut [PadStriker] {
        self.strikers.get_mut(..usize::from(self.sounding_strikers)).unwrap_or(&mut [])
    }

    /// The object's bank and the strikers' banks.
    pub fn banks(&self) -> impl Iterator<Item = &Bank> {
        core::iter::once(&self.object).chain(self.sounding().iter().map(|striker| &striker.bank))
    }

    /// The same to be changed.
    pub fn banks_mut(&mut self) -> impl Iterator<Item = &mut Bank> {
        self.wake();
        let strikers = self.strikers.iter_mut().take(usize::from(self.sounding_strikers));
        core::iter::once(&mut self.object).chain(strikers.map(|striker| &mut striker.bank))
    }

    /// Register groups of all banks.
    pub fn group_count(&self) -> u32 {
        self.banks().map(Bank::group_count).sum()
    }

    /// Output (1.0 = full scale) that a bus step of a bank makes on the louder side.
    pub fn unit(&self) -> f32 {
        self.panner.loudest() / fixed::ONE_Q27 as f32
    }

    /// Modes of the object's bank and of all strikers' banks.
    #[inline(always)]
    pub fn mode_count(&self) -> usize {
        usize::from(self.mode_count)
    }

    /// Whether the pad has been struck, or driven, since it was loaded.
    #[inline(always)]
    pub fn was_struck(&self) -> bool {
        self.struck
    }

    /// Whether any mode rings.
    #[inline(always)]
    pub fn is_ringing(&self) -> bool {
        self.object.is_ringing() || self.sounding().iter().any(|striker| striker.bank.is_ringing())
    }

    /// Bound of the amplitude that retirement leaves out, output units (1.0 = full scale).
    #[inline(always)]
    pub fn retired_amplitude(&self) -> f32 {
        self.retired_amplitude
    }

    /// The impact of a strike, and the object moved to its position. `None` where the strike does nothing.
    pub fn strike(
        &mut self,
        tables: &PadTables<'_>,
        velocity: f32,
        position: f32,
        striker: u8,
        rate: SampleRate,
        memory: &mut Memory<'_>,
    ) -> Option<Impact> {
        let impact = self.strikers.get(usize::from(striker))?.law.impact(velocity)?;
        self.expected += impact.sum();
        self.struck = true;
        self.wake();
        self.object.set_position(position, &tables.object_table(), rate, memory);
        Some(impact)
    }

    /// Lays a hand on, or lets go.
    pub fn set_choked(&mut self, choked: bool, tables: &PadTables<'_>, rate: SampleRate, memory: &mut Memory<'_>) {
        if choked == self.choked {
            return;
        }
        self.choked = choked;
        self.wake();
        self.object.set_choked(choked, &tables.object_table(), rate, memory);
        for (index, striker) in self.sounding_mut().iter_mut().enumerate() {
            if let Some(table) = tables.striker_table(index) {
                striker.bank.set_choked(choked, &table, rate, memory);
            }
        }
    }

    /// Whether [`Pad::ring`] goes straight to the stereo bus.
    pub fn rings_quickly(&self) -> bool {
        self.panner.gains(self.object.mix_shift().is_loud).is_some() && !self.banks().skip(1).any(Bank::is_ringing)
    }

    /// Whether a run under a force, which may be loud, goes straight to the stereo bus.
    pub fn drives_quickly(&self) -> bool {
        let is_loud = self.object.mix_shift().is_loud || self.expects();
        let is_simple = self.sounding_strikers == 0 && !self.acceleration.is_built() && !self.object.has_onset();
        is_simple && self.panner.gains(is_loud).is_some()
    }

    /// Whether a contact has begun that the banks are not guarded for yet.
    pub fn expects(&self) -> bool {
        self.expected > 0
    }

    /// Whether a force would be heard: some group is not left out, or there is an acceleration sound.
    pub fn responds(&self, groups: &[Group]) -> bool {
        self.acceleration.is_built() || self.banks().any(|bank| bank.has_admitted(groups))
    }

    /// Guards the banks for the contacts that have just begun. Before the run in which they do.
    pub fn meet_expected(&mut self, memory: &mut Memory<'_>) {
        let expected = core::mem::take(&mut self.expected);
        if expected > 0 {
            // What is left out altogether needs no guard.
            for bank in self.banks_mut() {
                if bank.has_admitted(memory.groups) {
                    bank.expect(memory, expected);
                }
            }
        }
    }

    /// Whether the next tick guards any group, if no more force comes before it.
    pub fn is_guard_due(&self) -> bool {
        self.rest_ticks == 0 && self.banks().any(|bank| bank.is_guard_due(self.passed_ticks))
    }

    /// Whether no bank has anything to do at the coming tick.
    pub fn rests(&self) -> bool {
        self.rest_ticks > 0
    }

    /// Lets a tick pass in which no bank has anything to do; false, and nothing happens, where one has: then [`Pad::tick`] must follow.
    #[inline(always)]
    pub fn pass_tick(&mut self) -> bool {
        let rests = self.rest_ticks > 0;
        if rests {
            self.rest_ticks -= 1;
            self.passed_ticks += 1;
        }
        rests
    }

    /// Tells the banks of the ticks that have passed, before anything happens to them.
    #[inline(always)]
    fn wake(&mut self) {
        self.rest_ticks = 0;
        if self.passed_ticks > 0 {
            self.catch_up();
        }
    }

    #[inline(never)]
    fn catch_up(&mut self) {
        let passed = core::mem::take(&mut self.passed_ticks);
        self.object.pass(passed);
        self.sounding_mut().iter_mut().for_each(|striker| striker.bank.pass(passed));
    }

    /// The bookkeeping of a tick; gives how many modes retired. `retired_elsewhere` is what other pads leave out, output units.
    #[inline(never)]
    pub fn tick(&mut self, memory: &mut Memory<'_>, skip: bool, retired_elsewhere: f32) -> u32 {
        self.wake();
        let mut already = retired_elsewhere;
        self.banks().for_each(|bank| already += bank.retired_amplitude());
        // 1.0 on the bus is full scale, so that a bus step is 2^-27 of it.
        let mut retirement = Retirement::new(already, self.panner.loudest() / fixed::ONE_Q27 as f32);
        let (mut rest_ticks, mut retired_amplitude) = (if skip { u8::MAX } else { 0 }, 0.0);
        for bank in self.banks_mut() {
            bank.tick(memory, skip.then_some(&mut retirement));
            rest_ticks = rest_ticks.min(bank.rest_ticks());
            retired_amplitude += bank.retired_amplitude();
        }
        (self.rest_ticks, self.retired_amplitude) = (rest_ticks, retired_amplitude);
        retirement.retired_modes()
    }
}
