//! Dynamic filters and biquad banks: what objects have beside their modes, where an engine has room for it.

use super::{Engine, Fitting, Left, LoadError, Stage, Surroundings, TickReport};
use crate::SampleRate;
use crate::contact::Flight;
use crate::pad::{FilterWork, Pad, PadFilters, Run, is_ringing};
use crate::resonator::{Bank, Memory, TICK_FRAMES};
use crate::table::Kit;

/// An engine's room for dynamic filters and biquads: [`NoFilters`], or [`Filters`] of some number. Pads are named by their number.
pub trait FilterRoom {
    /// All silent.
    const EMPTY: Self;

    /// Derives the filters of all pads whose object has some.
    ///
    /// # Errors
    /// A [`LoadError`]; there are then no filters.
    fn load<F: Fitting>(&mut self, kit: &Kit<'_>, rate: SampleRate, fitting: &mut F) -> Result<(), LoadError>;

    /// Whether a pad's filters have a part in its next run: they sound, or take its force or its modes.
    fn join_in(&self, pad: u8, has_force: bool, banks: &[Bank]) -> bool;

    /// Whether a force makes a pad's filters sound.
    fn takes_force(&self, pad: u8) -> bool;

    /// Whether the modes of a pad's object go through its filter.
    fn takes_modes(&self, pad: u8) -> bool;

    /// Whether a pad has filters.
    fn has(&self, pad: u8) -> bool;

    /// A strike of a pad at a frame of the tick; `level` is its peak force over the reference force. What finds no time in `left` goes without it.
    fn strike(&mut self, pad: u8, level: f32, frame: usize, left: &mut Left);

    /// What filters that sound take.
    fn sounding_cycles(&self) -> u32;

    /// A hand that comes to a pad, on a tick, to let the sound fall by so many nepers a frame, or goes.
    fn set_choked(&mut self, pad: u8, nepers: Option<f64>);

    /// Adds a pad's filters to its bus: see [`PadFilters::render`].
    fn render(
        &mut self,
        pad: u8,
        frame: usize,
        force: Option<&[i32]>,
        modes: Option<&mut [i32]>,
        out: &mut [i32],
    ) -> FilterWork;

    /// Pads whose filters sound.
    fn ringing(&self) -> u32;

    /// Nominal cycles that the filters of a pad take in this tick if they sound on; with `struck`, those that a strike adds to them.
    fn cycles(&self, pad: u8, struck: bool) -> u32;

    /// Nominal cycles that a hand's coming to a pad, or going, adds to its tick.
    fn hand_cycles(&self, pad: u8) -> u32;
}

/// No room: no memory and no code. A kit's dynamic filters and biquads are then not heard.
#[derive(Clone, Copy, Debug)]
pub struct NoFilters;

impl FilterRoom for NoFilters {
    const EMPTY: Self = Self;

    fn load<F: Fitting>(&mut self, kit: &Kit<'_>, _: SampleRate, fitting: &mut F) -> Result<(), LoadError> {
        if !F::TELLS {
            return Ok(());
        }
        for (pad, number) in kit.pads().zip(0u8..) {
            let object = pad.object_index();
            if matches!(kit.dynamic_filter_of(object), Ok(Some(_))) {
                fitting.pass_over(Stage::DynamicFilter(number));
            }
            if matches!(kit.biquads_of(object), Ok(Some(_))) {
                fitting.pass_over(Stage::Biquads(number));
            }
        }
        Ok(())
    }

    #[inline(always)]
    fn join_in(&self, _: u8, _: bool, _: &[Bank]) -> bool {
        false
    }

    #[inline(always)]
    fn takes_force(&self, _: u8) -> bool {
        false
    }

    #[inline(always)]
    fn takes_modes(&self, _: u8) -> bool {
        false
    }

    #[inline(always)]
    fn has(&self, _: u8) -> bool {
        false
    }

    #[inline(always)]
    fn strike(&mut self, _: u8, _: f32, _: usize, _: &mut Left) {}

    #[inline(always)]
    fn sounding_cycles(&self) -> u32 {
        0
    }

    #[inline(always)]
    fn set_choked(&mut self, _: u8, _: Option<f64>) {}

    #[inline(always)]
    fn render(&mut self, _: u8, _: usize, _: Option<&[i32]>, _: Option<&mut [i32]>, _: &mut [i32]) -> FilterWork {
        FilterWork::default()
    }

    #[inline(always)]
    fn ringing(&self) -> u32 {
        0
    }

    #[inline(always)]
    fn cycles(&self, _: u8, _: bool) -> u32 {
        0
    }

    #[inline(always)]
    fn hand_cycles(&self, _: u8) -> u32 {
        0
    }
}

/// Room for the filters of so many pads: dynamic filters of at most `POINTS` breakpoints with at most `LOOPS` loops whose delays fit `FRAMES` frames, and biquads
/// in at most `PAIRS` pairs each (a pair for each biquad suffices).
pub type Filters<const COUNT: usize, const POINTS: usize, const LOOPS: usize, const FRAMES: usize, const PAIRS: usize> =
    [Place<POINTS, LOOPS, FRAMES, PAIRS>; COUNT];

/// Room for the filters of one pad.
#[derive(Clone, Debug)]
pub struct Place<const POINTS: usize, const LOOPS: usize, const FRAMES: usize, const PAIRS: usize> {
    pad: Option<u8>,
    /// What the dynamic filter takes while it sounds, and the biquads.
    cycles: [u32; 2],
    filters: PadFilters<POINTS, LOOPS, FRAMES, PAIRS>,
}

impl<const POINTS: usize, const LOOPS: usize, const FRAMES: usize, const PAIRS: usize>
    Place<POINTS, LOOPS, FRAMES, PAIRS>
{
    /// Of no pad.
    pub const FREE: Self = Self { pad: None, cycles: [0; 2], filters: PadFilters::EMPTY };

    fn unload(&mut self) {
        self.pad = None;
        self.filters.unload();
    }
}

/// The filters of a pad.
fn of<const POINTS: usize, const LOOPS: usize, const FRAMES: usize, const PAIRS: usize>(
    places: &[Place<POINTS, LOOPS, FRAMES, PAIRS>],
    pad: u8,
) -> Option<&PadFilters<POINTS, LOOPS, FRAMES, PAIRS>> {
    places.iter().find(|place| place.pad == Some(pad)).map(|place| &place.filters)
}

fn of_mut<const POINTS: usize, const LOOPS: usize, const FRAMES: usize, const PAIRS: usize>(
    places: &mut [Place<POINTS, LOOPS, FRAMES, PAIRS>],
    pad: u8,
) -> Option<&mut PadFilters<POINTS, LOOPS, FRAMES, PAIRS>> {
    places.iter_mut().find(|place| place.pad == Some(pad)).map(|place| &mut place.filters)
}

/// Derives the filters of a kit's pads.
#[inline(never)] // only on load: its stack is not the program's
fn derive<const POINTS: usize, const LOOPS: usize, const FRAMES: usize, const PAIRS: usize>(
    places: &mut [Place<POINTS, LOOPS, FRAMES, PAIRS>],
    kit: &Kit<'_>,
    rate: SampleRate,
    fitting: &mut impl Fitting,
) -> Result<(), LoadError> {
    let capacity = places.len();
    let mut free = places.iter_mut().peekable();
    for (pad, number) in kit.pads().zip(0u8..) {
        let object = pad.object_index();
        let filter = kit.dynamic_filter_of(object).map_err(LoadError::FilterTable)?;
        let biquads = kit.biquads_of(object).map_err(LoadError::FilterTable)?;
        if filter.is_none() && biquads.is_none() {
            continue;
        }
        let Some(place) = free.peek_mut() else {
            fitting.leave_out(LoadError::TooManyFilters { pad: number, capacity })?;
            continue;
        };
        let (filters, mut dynamic_cycles, mut biquad_cycles) = (&mut place.filters, 0, 0);
        let reference_force = kit.object_of(pad).map_or(1.0, |object| object.reference_force());
        if let Some(filter) = filter {
            let hardest = kit.strikers_of(pad).map(|striker| striker.contact().peak_force()).fold(0.0, f32::max);
            match filters.load_dynamic(&filter, rate, u32::from(number), hardest / reference_force) {
                Err(error) => fitting.leave_out(LoadError::DynamicFilter { pad: number, error })?,
                Ok(()) => {
                    let (stage, cycles) = (Stage::DynamicFilter(number), filters.dearest_of_dynamic());
                    // What modes go through runs with them, whether a strike brings noise or not.
                    let afforded = match filters.takes_modes() {
                        true => fitting.take(stage, cycles).then_some(0),
                        false => fitting.afford(stage, cycles),
                    };
                    match afforded {
                        Some(cycles) => dynamic_cycles = cycles,
                        None => filters.unload_dynamic(),
                    }
                }
            }
        }
        if let Some(biquads) = biquads {
            match filters.load_biquads(&biquads, rate, reference_force, pad.choke_t60_s()) {
                Err(error) => fitting.leave_out(LoadError::Biquads { pad: number, error })?,
                Ok(()) => match fitting.afford(Stage::Biquads(number), filters.dearest_of_biquads()) {
                    Some(cycles) => biquad_cycles = cycles,
                    None => filters.unload_biquads(),
                },
            }
        }
        if filters.is_built()
            && let Some(place) = free.next()
        {
            (place.pad, place.cycles) = (Some(number), [dynamic_cycles, biquad_cycles]);
        }
    }
    Ok(())
}

impl<const COUNT: usize, const POINTS: usize, const LOOPS: usize, const FRAMES: usize, const PAIRS: usize> FilterRoom
    for Filters<COUNT, POINTS, LOOPS, FRAMES, PAIRS>
{
    const EMPTY: Self = [const { Place::FREE }; COUNT];

    fn load<F: Fitting>(&mut self, kit: &Kit<'_>, rate: SampleRate, fitting: &mut F) -> Result<(), LoadError> {
        self.iter_mut().for_each(Place::unload);
        let result = derive(self, kit, rate, fitting);
        if result.is_err() {
            self.iter_mut().for_each(Place::unload);
        }
        result
    }

    #[inline(never)]
    fn join_in(&self, pad: u8, has_force: bool, banks: &[Bank]) -> bool {
        of(self, pad).is_some_and(|filters| {
            filters.is_ringing()
                || has_force && filters.takes_force()
                || filters.takes_modes() && (has_force || is_ringing(banks))
        })
    }

    fn takes_force(&self, pad: u8) -> bool {
        of(self, pad).is_some_and(PadFilters::takes_force)
    }

    fn takes_modes(&self, pad: u8) -> bool {
        of(self, pad).is_some_and(PadFilters::takes_modes)
    }

    fn has(&self, pad: u8) -> bool {
        of(self, pad).is_some()
    }

    fn strike(&mut self, pad: u8, level: f32, frame: usize, left: &mut Left) {
        let Some(place) = self.iter_mut().find(|place| place.pad == Some(pad)) else { return };
        let [has_dynamic, has_biquads] = place.filters.parts();
        let ([dynamic_sounds, biquads_sound], [of_dynamic, of_biquads]) = (place.filters.sounding(), place.cycles);
        let dynamic = has_dynamic && left.admits(dynamic_sounds, of_dynamic);
        let biquads = has_biquads && left.admits(biquads_sound, of_biquads);
        place.filters.strike(level, frame, [dynamic, biquads]);
    }

    fn sounding_cycles(&self) -> u32 {
        let places = self.iter().filter(|place| place.pad.is_some());
        let parts = places.flat_map(|place| place.filters.sounding().into_iter().zip(place.cycles));
        parts.map(|(sounds, cycles)| if sounds { cycles } else { 0 }).sum()
    }

    fn set_choked(&mut self, pad: u8, nepers: Option<f64>) {
        if let Some(filters) = of_mut(self, pad) {
            filters.set_choked(nepers);
        }
    }

    fn render(
        &mut self,
        pad: u8,
        frame: usize,
        force: Option<&[i32]>,
        modes: Option<&mut [i32]>,
        out: &mut [i32],
    ) -> FilterWork {
        of_mut(self, pad).map_or(FilterWork::default(), |filters| filters.render(frame, force, modes, out))
    }

    fn ringing(&self) -> u32 {
        self.iter().filter(|place| place.pad.is_some() && place.filters.is_ringing()).count() as u32
    }

    fn cycles(&self, pad: u8, struck: bool) -> u32 {
        let Some(filters) = of(self, pad) else { return 0 };
        let ringing = if filters.is_ringing() { filters.cycles_a_tick(false) } else { 0 };
        if struck { filters.cycles_a_tick(true).saturating_sub(ringing) } else { ringing }
    }

    fn hand_cycles(&self, pad: u8) -> u32 {
        of(self, pad).map_or(0, PadFilters::cycles_of_hand)
    }
}

/// What a pad's run is made from.
pub(super) struct Sources<'r, 'm, const CONTACTS: usize> {
    pub(super) has_force: bool,
    pub(super) flight: &'r mut Flight<CONTACTS>,
    pub(super) memory: &'r mut Memory<'m>,
    pub(super) banks: &'r mut [Bank],
}

/// Renders a run of a pad whose filters have a part in it, on a mono bus. `place` is the pad's number and the frame within the tick.
#[inline(never)] // its buffers must not weigh on pads that do without
pub(super) fn render_filtered<const CONTACTS: usize, F: FilterRoom>(
    pad: &mut Pad<'_>,
    (number, frame): (u8, usize),
    run: Run<'_>,
    sources: Sources<'_, '_, CONTACTS>,
    filters: &mut F,
    report: &mut TickReport,
    out: &mut [[i32; 2]],
) {
    let Sources { has_force, flight, memory, banks } = sources;
    let (mut force, mut sound, mut modes) = ([0; TICK_FRAMES], [0; TICK_FRAMES], [0; TICK_FRAMES]);
    let frames = run.frames;
    let (Some(force), Some(sound), Some(modes)) =
        (force.get_mut(..frames), sound.get_mut(..frames), modes.get_mut(..frames))
    else {
        return;
    };
    let takes_modes = filters.takes_modes(number);
    let is_heard = has_force && (!run.skip || pad.responds(banks, memory.groups) || filters.takes_force(number));
    let mut brings_modes = takes_modes && (is_heard || is_ringing(banks));
    if has_force && !is_heard {
        flight.pass(number, frames);
    }
    if is_heard || !run.skip {
        let buses = (&mut *sound, takes_modes.then_some(&mut *modes));
        let work = pad.drive_mono(number, run, flight, memory, banks, force, buses);
        report.add(pad, &work, frames);
        brings_modes |= takes_modes;
    } else {
        let ringing = is_ringing(banks);
        let buses = (&mut *sound, takes_modes.then_some(&mut *modes));
        let ran = if ringing { pad.ring_mono(run.odd_start, memory, banks, buses) } else { (0, 0) };
        report.add_ringing(pad, ran, frames);
    }
    let force = is_heard.then_some(&*force);
    let work = filters.render(number, frame, force, brings_modes.then_some(modes), sound);
    report.filter_frames += work.filter_frames;
    report.loop_frames += work.loop_frames;
    report.biquad_frames += work.biquad_frames;
    pad.pan(sound, out);
}

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
    /// A strike of a pad, its peak force in bus steps.
    #[inline(never)]
    pub(super) fn strike_filters(&mut self, pad: u8, peak: i32, left: &mut Left) {
        let frame = (self.now % TICK_FRAMES as u64) as usize;
        self.filters.strike(pad, peak as f32 / crate::fixed::ONE_Q27 as f32, frame, left);
    }

    /// A strike of a pad that may have stages, its peak force in bus steps.
    #[inline(never)] // kits without have nothing of it
    pub(super) fn strike_stages(&mut self, pad: u8, peak: i32) {
        let sounding = match self.stage_cycles {
            Some(_) => self.sounding_noise_cycles() + self.filters.sounding_cycles(),
            None => 0,
        };
        let mut left = Left::new(self.stage_cycles, sounding);
        self.strike_noise(pad, peak, &mut left);
        self.strike_filters(pad, peak, &mut left);
        self.report.refused_stages += left.refused;
    }

    /// A hand that comes to a pad or goes, on a tick; `t60_s` is what it imposes.
    #[inline(always)]
    pub(super) fn choke_filters(&mut self, pad: u8, t60_s: Option<f32>) {
        if self.filtered.may_have(pad) {
            let nepers = t60_s.map(|t60_s| crate::pad::nepers(t60_s, self.rate()));
            self.filters.set_choked(pad, nepers);
        }
    }

    /// Cycles of the filters that sound, in this tick.
    #[inline(always)]
    pub(super) fn filter_cycles(&self) -> u32 {
        if self.filtered.is_empty() { 0 } else { self.cycles_of_filters() }
    }

    #[inline(never)]
    fn cycles_of_filters(&self) -> u32 {
        let pads = 0..self.pad_count as u8; // events count pads in a byte
        pads.map(|pad| self.filters.cycles(pad, false)).sum()
    }

    /// Cycles of the filters that a strike begins, in its tick.
    #[inline(always)]
    pub(super) fn filter_strike_cycles(&self, pad: u8) -> u32 {
        if self.filtered.may_have(pad) { self.filters.cycles(pad, true) } else { 0 }
    }

    /// Cycles of a pad's filters for a hand that comes or goes.
    #[inline(always)]
    pub(super) fn filter_hand_cycles(&self, pad: u8) -> u32 {
        if self.filtered.may_have(pad) { self.filters.hand_cycles(pad) } else { 0 }
    }
}
