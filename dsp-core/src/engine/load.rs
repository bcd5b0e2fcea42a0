//! Loading: from a kit to an engine.
//!
//! Every slice is taken in one order, from a memory that has words or from one that only counts.

use super::awake::Awake;
use super::error::LoadError;
use super::fader::Fader;
use super::held::Held;
use super::report::TickReport;
use super::scrapes::Scrapes;
use super::setup::{Fitting, STRUCK_PAD_FRAME, Setup};
use super::stage::Stage;
use super::state::{Engine, STANDARD_CONTACTS};
use crate::built::Built;
use crate::contact::ActiveContacts;
use crate::limiter::Limiter;
use crate::memory::{Memory, OutOfMemory, Region, Words};
use crate::noise::Sfc32;
use crate::output::Panner;
use crate::residual::Shaper;
use crate::room::{Room, Sample};
use crate::scrape::Contact;
use crate::table::Kit;
use crate::table::layout::STRIKERS_PER_PAD;
use crate::voice::{Filters, FiltersSize, Residual, Voice};

/// Output below which noise ends, rms, 1.0 = full scale: -110 dBFS.
const SILENCE: f32 = 3.162_277_7e-6;

/// Nominal cycles of the dearest tick of a room that sounds, without its bands.
///
/// With [`ROOM_BAND_TICK`] they are a little more than is measured, up to 430 a frame with 4 bands
/// (`cargo test -p host-tests --test on_chip room -- --nocapture`). They hold for bands of octaves
/// and more; several bands near the full rate cost more.
pub(super) const ROOM_TICK: u32 = 11_200;
/// Nominal cycles that each band of a room adds to its dearest tick.
pub(super) const ROOM_BAND_TICK: u32 = 950;

impl<'k: 'm, 'm, S: Sample> Engine<'k, 'm, S> {
    /// Derives all stages of a kit in lent memory, as many words as [`Plan::of`](super::Plan::of)
    /// says. Time begins at 0.
    ///
    /// Coefficients are derived in software `f64` on a Cortex-M4F: thousands of cycles a mode, not
    /// for the audio path.
    ///
    /// # Errors
    /// A [`LoadError`] for the first stage of the kit that does not fit or is invalid.
    pub fn new(kit: &Kit<'k>, setup: Setup, memory: Memory<'m>) -> Result<Self, LoadError> {
        let mut memory = memory;
        Self::build(kit, setup, &mut memory, Fitting::ALL)
    }

    /// Derives all modes of a kit, and those of its other stages that there is memory and time for.
    ///
    /// The room comes first, then the background, contacts that go on, and residuals and filters
    /// pad by pad. All stages
    /// together have `stage_cycles` a tick, of which pads, room, background and filters that modes
    /// go through take theirs for good. `tell` hears of each stage that is left out because it
    /// alone would take more than the rest; the kit plays without it.
    ///
    /// Residuals and filters that sound at once share the rest: a strike that finds no time for one
    /// does not begin it ([`TickReport::refused_stages`]). The [budget](Self::set_budget) sheds
    /// modes, not stages. All these cycles are the cycle model's worst, with the waits of flash.
    ///
    /// # Errors
    /// A [`LoadError`] for modes that do not fit or are invalid.
    pub fn new_within(
        kit: &Kit<'k>,
        setup: Setup,
        memory: Memory<'m>,
        stage_cycles: u32,
        tell: &mut dyn FnMut(LoadError),
    ) -> Result<Self, LoadError> {
        let mut memory = memory;
        let fitting = Fitting::within(stage_cycles, kit.pads().len(), tell);
        Self::build(kit, setup, &mut memory, fitting)
    }

    /// Builds an engine. From a memory that only counts it cannot be played.
    pub(super) fn build(
        kit: &Kit<'k>,
        setup: Setup,
        memory: &mut Memory<'m>,
        mut fitting: Fitting<'_>,
    ) -> Result<Self, LoadError> {
        let mut engine = Self::take(kit, setup, memory)?;
        engine.load_modes(setup.position_cycles, memory, &mut fitting)?;
        if let Some(left) = engine.frame_cycles.filter(|_| engine.has_mixer) {
            fitting.limit_beside_frames(left, setup.frame_worst_percent);
        }
        // Stages that sound for good come first: strikes share the time that they leave.
        engine.load_room(memory, &mut fitting)?;
        engine.load_background(memory, &mut fitting)?;
        engine.load_scrapes(memory, &mut fitting)?;
        for number in 0..kit.pads().len() as u8 {
            engine.load_residual(number, memory, &mut fitting)?;
        }
        for number in 0..kit.pads().len() as u8 {
            engine.load_filters(number, memory, &mut fitting)?;
        }
        engine.words = memory.used();
        engine.stage_cycles = fitting.left();
        engine.modes_built = engine.voices.iter().map(|voice| voice.mode_count() as u32).sum();
        (engine.asleep_modes, engine.asleep_unstruck_modes) = (engine.modes_built, engine.modes_built);
        (0..engine.voices.len() as u8).for_each(|number| engine.wake(number));
        engine.lay_to_sleep();
        Ok(engine)
    }

    /// Takes the memory of the engine's own state.
    fn take(kit: &Kit<'k>, setup: Setup, memory: &mut Memory<'m>) -> Result<Self, LoadError> {
        let pads = kit.pads().len();
        // Events count pads in a byte.
        let capacity = usize::from(u8::MAX);
        match pads {
            0 => return Err(LoadError::NoPads),
            _ if pads > capacity => return Err(LoadError::TooManyPads { pads, capacity }),
            _ => {}
        }
        let missing = |error| LoadError::Memory { stage: Stage::Engine, error };
        Ok(Self {
            kit: *kit,
            voices: memory.take(Region::Fast, pads, Voice::empty).map_err(missing)?,
            contacts: ActiveContacts::take(memory, STANDARD_CONTACTS).map_err(missing)?,
            scrapes: Scrapes::none(),
            frames: None,
            background: None,
            centre: Panner::new(0.0, 0.0),
            room: None,
            fader: Fader::OPEN,
            held: Held::NONE,
            limiter: match setup.ceiling_db {
                Some(ceiling_db) => Limiter::place(memory, ceiling_db, setup.rate).map_err(missing)?,
                None => None,
            },
            hearings: memory.take(Region::Fast, pads, || None).map_err(missing)?,
            awake: Awake::take(memory, pads).map_err(missing)?,
            struck: memory.take(Region::Fast, pads, || 0).map_err(missing)?,
            rate: setup.rate,
            skipping: setup.skipping,
            position_step: setup.position_step,
            built: setup.built,
            room_samples: setup.room_samples,
            has_mixer: false,
            retired_in_frames: 0.0,
            frames_tick_cycles: 0,
            loop_percent: setup.loop_percent,
            frame_cycles: setup.frame_cycles.map(|all| all.saturating_sub(STRUCK_PAD_FRAME * (pads - 1) as u32)),
            words: Words::default(),
            now: 0,
            budget: None,
            stage_cycles: None,
            noisy: false,
            filtered: false,
            report: TickReport::EMPTY,
            idle: false,
            was_idle: false,
            modes_built: 0,
            groups_built: 0,
            expects: false,
            chokes_changed: false,
            unstruck_modes: 0,
            asleep_modes: 0,
            asleep_unstruck_modes: 0,
            retired_amplitude: 0.0,
            cycles_ahead: 0,
            ticks_without_strike: 0,
        })
    }

    #[inline(never)] // runs on load only: keeps its stack apart from the program's
    fn load_room(&mut self, memory: &mut Memory<'m>, fitting: &mut Fitting<'_>) -> Result<(), LoadError> {
        let (bands, rate, samples) = (self.kit.room(), self.rate, self.room_samples);
        if bands.is_empty() {
            return Ok(());
        }
        if !(Built::HERE.room && self.built.room) {
            return fitting.leave_out(LoadError::NotBuilt { stage: Stage::Room });
        }
        let size = match Room::<S>::size(bands, rate, samples) {
            Ok(size) => size,
            Err(error) => return fitting.leave_out(LoadError::Room(error)),
        };
        if !fits(memory, |count| Room::<S>::place(count, size), Stage::Room, fitting)?
            || !fitting.take(Stage::Room, ROOM_TICK + size.bands as u32 * ROOM_BAND_TICK)
        {
            return Ok(());
        }
        let missing = |error| LoadError::Memory { stage: Stage::Room, error };
        self.room = Room::place(memory, size).map_err(missing)?;
        match self.room.as_deref_mut() {
            Some(room) => room.load(bands, rate, samples).map_err(LoadError::Room),
            None => Ok(()),
        }
    }

    #[inline(never)] // runs on load only: keeps its stack apart from the program's
    fn load_scrapes(&mut self, memory: &mut Memory<'m>, fitting: &mut Fitting<'_>) -> Result<(), LoadError> {
        let (stage, kit) = (Stage::Scrapes, self.kit);
        if kit.object_surfaces().is_empty() {
            return Ok(());
        }
        if !self.can_scrape() {
            return fitting.leave_out(LoadError::NotBuilt { stage });
        }
        if let Err(error) = kit.check_surfaces() {
            return fitting.leave_out(LoadError::SurfaceTable(error));
        }
        let pads = (0..kit.pads().len()).flat_map(|pad| (0..STRIKERS_PER_PAD).map(move |striker| (pad, striker)));
        let mut contacts = pads.filter_map(|(pad, striker)| Contact::of(&kit, pad, striker, false, [0.0; 2]));
        let Some(contact) = contacts.next() else { return Ok(()) };
        if !fits(memory, |count| Scrapes::take(count, contact, self.rate), stage, fitting)? {
            return Ok(());
        }
        let missing = |error| LoadError::Memory { stage, error };
        (self.scrapes, self.contacts.ongoing) = Scrapes::take(memory, contact, self.rate).map_err(missing)?;
        Ok(())
    }

    #[inline(never)]
    fn load_background(&mut self, memory: &mut Memory<'m>, fitting: &mut Fitting<'_>) -> Result<(), LoadError> {
        let Some(background) = self.kit.background() else { return Ok(()) };
        let highest_hz = background.bands().last().map_or(0.0, |band| band.edges_hz[1]);
        let bands = background.bands().count();
        let Some(place) = self.take_noise(Stage::Background, (bands, highest_hz), memory, fitting)? else {
            return Ok(());
        };
        self.noisy = true;
        if let Some(place) = place {
            place.load(background.bands(), self.rate, Sfc32::new(background.seed(), u32::MAX), 0.0, 0.0);
            place.begin();
            self.background = Some(place);
        }
        Ok(())
    }

    #[inline(never)]
    fn load_residual(
        &mut self,
        number: u8,
        memory: &mut Memory<'m>,
        fitting: &mut Fitting<'_>,
    ) -> Result<(), LoadError> {
        let Some(pad) = self.kit.pads().nth(usize::from(number)) else { return Ok(()) };
        let Some(residual) = self.kit.residual_of(pad.object_index()) else { return Ok(()) };
        let highest_hz = residual.bands().last().map_or(0.0, |band| band.edges_hz[1]);
        let bands = residual.bands().count();
        let Some(place) = self.take_noise(Stage::Residual(number), (bands, highest_hz), memory, fitting)? else {
            return Ok(());
        };
        self.noisy = true;
        if let (Some(place), Some(voice)) = (place, self.voices.get_mut(usize::from(number))) {
            let noise = Sfc32::new(residual.seed(), u32::from(number));
            let choke_t60_s = f64::from(pad.choke_t60_s());
            let choke_db_per_s = if choke_t60_s > 0.0 { 60.0 / choke_t60_s } else { 0.0 };
            let silence = SILENCE / voice.loudest();
            place.load(residual.bands(), self.rate, noise, silence, choke_db_per_s);
            voice.residual = Some(place);
        }
        Ok(())
    }

    /// Takes the memory and the time of noise in a number of bands up to an edge in Hz.
    ///
    /// `None` if it is left out, `Some(None)` from a memory that only counts.
    fn take_noise(
        &self,
        stage: Stage,
        (bands, edge_hz): (usize, f32),
        memory: &mut Memory<'m>,
        fitting: &mut Fitting<'_>,
    ) -> Result<Option<Option<&'m mut Residual<'m>>>, LoadError> {
        if f64::from(edge_hz) > self.rate.hz() / 2.0 {
            return fitting.leave_out(LoadError::BeyondNyquist { stage, edge_hz, rate: self.rate }).map(|()| None);
        }
        if !fits(memory, |count| Residual::place(count, bands), stage, fitting)? {
            return Ok(None);
        }
        let cycles = match stage {
            Stage::Background => fitting.take(stage, Shaper::dearest_tick(bands)).then_some(0),
            _ => (self.is_only_noise())
                .then(|| fitting.afford_beside_frames(stage, Shaper::dear_tick(bands)))
                .flatten()
                .unwrap_or_else(|| fitting.afford(stage, Shaper::dearest_tick(bands))),
        };
        let Some(cycles) = cycles else { return Ok(None) };
        let mut place = Residual::place(memory, bands).map_err(|error| LoadError::Memory { stage, error })?;
        if let Some(place) = &mut place {
            place.worst_cycles = cycles;
        }
        Ok(Some(place))
    }

    /// True if the kit has noise of one pad only: it then waits where pads in frames make ticks
    /// dear.
    fn is_only_noise(&self) -> bool {
        let residuals = self.kit.pads().filter_map(|pad| self.kit.residual_of(pad.object_index()));
        residuals.count() == 1 && self.kit.background().is_none()
    }

    #[inline(never)] // runs on load only: keeps its stack apart from the program's
    fn load_filters(
        &mut self,
        number: u8,
        memory: &mut Memory<'m>,
        fitting: &mut Fitting<'_>,
    ) -> Result<(), LoadError> {
        let (kit, rate) = (self.kit, self.rate);
        let Some(pad) = kit.pads().nth(usize::from(number)) else { return Ok(()) };
        let object = pad.object_index();
        let filter = kit.dynamic_filter_of(object).map_err(LoadError::FilterTable)?;
        let biquads = kit.biquads_of(object).map_err(LoadError::FilterTable)?;
        let reference_force = kit.object_of(pad).map_or(1.0, |object| object.reference_force());
        let hardest = kit.strikers_of(pad).map(|striker| striker.contact().peak_force()).fold(0.0, f32::max);
        let (mut size, mut cycles) = (FiltersSize::default(), [0, 0]);
        // Without memory first, for their cost and their errors.
        if let Some(filter) = &filter {
            let stage = Stage::DynamicFilter(number);
            let mut tried = Filters::empty();
            let sized = Filters::size_of_dynamic(filter, rate);
            let derived = sized.and_then(|size| {
                tried.load_dynamic(filter, rate, u32::from(number), hardest / reference_force, false).map(|()| size)
            });
            match derived {
                Err(error) => fitting.leave_out(LoadError::DynamicFilter { pad: number, error })?,
                Ok(dynamic) => {
                    let wanted = FiltersSize { dynamic: Some(dynamic), ..FiltersSize::default() };
                    if fits(memory, |count| Filters::place(count, wanted), stage, fitting)? {
                        // A filter that modes go through runs with them, with or without noise.
                        let afforded = match tried.takes_modes() {
                            true => fitting.take(stage, tried.dynamic_cycles()).then_some(0),
                            false => fitting.afford(stage, tried.dynamic_cycles()),
                        };
                        if let Some(afforded) = afforded {
                            (size, cycles[0]) = (wanted, afforded);
                        }
                    }
                }
            }
        }
        if let Some(biquads) = &biquads {
            let stage = Stage::Biquads(number);
            let wanted = FiltersSize { biquads: biquads.records().len(), ..size };
            if !(Built::HERE.biquads && self.built.biquads) {
                fitting.leave_out(LoadError::NotBuilt { stage })?;
            } else if let Err(error) = Filters::check_biquads(biquads, rate, reference_force) {
                fitting.leave_out(LoadError::Biquads { pad: number, error })?;
            } else if fits(memory, |count| Filters::place(count, wanted), stage, fitting)? {
                let worst = Filters::max_biquad_cycles(wanted.biquads, biquads.depth());
                if let Some(afforded) = fitting.afford(stage, worst) {
                    (size, cycles[1]) = (wanted, afforded);
                }
            }
        }
        if size == FiltersSize::default() {
            return Ok(());
        }
        let stage = if size.dynamic.is_some() { Stage::DynamicFilter(number) } else { Stage::Biquads(number) };
        let place = Filters::place(memory, size).map_err(|error| LoadError::Memory { stage, error })?;
        self.filtered = true;
        let (Some(place), Some(voice)) = (place, self.voices.get_mut(usize::from(number))) else { return Ok(()) };
        place.worst_cycles = cycles;
        if let (Some(filter), Some(_)) = (&filter, size.dynamic) {
            let loaded = place.load_dynamic(filter, rate, u32::from(number), hardest / reference_force, true);
            loaded.map_err(|error| LoadError::DynamicFilter { pad: number, error })?;
        }
        if let (true, Some(biquads), 1..) = (Built::HERE.biquads, &biquads, size.biquads) {
            let loaded = place.load_biquads(biquads, rate, reference_force, pad.choke_t60_s());
            if let Err(error) = loaded {
                place.unload_biquads();
                fitting.leave_out(LoadError::Biquads { pad: number, error })?;
            }
        }
        (voice.filters, voice.is_plain) = (Some(place), false);
        Ok(())
    }
}

/// True if there is memory for a stage, which is still to be taken; otherwise the stage is left
/// out.
fn fits<'m, T>(
    memory: &Memory<'m>,
    take: impl FnOnce(&mut Memory<'m>) -> Result<T, OutOfMemory>,
    stage: Stage,
    fitting: &mut Fitting<'_>,
) -> Result<bool, LoadError> {
    match take(&mut memory.rest()) {
        Ok(_) => Ok(true),
        Err(error) => fitting.leave_out(LoadError::Memory { stage, error }).map(|()| false),
    }
}
