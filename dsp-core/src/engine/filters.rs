//! Dynamic filters and biquad banks: what objects have beside their modes, where an engine has room for it.

use super::{Engine, LoadError, Surroundings, TickReport};
use crate::SampleRate;
use crate::contact::Flight;
use crate::event::{Action, Event};
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
    fn load(&mut self, kit: &Kit<'_>, rate: SampleRate) -> Result<(), LoadError>;

    /// Whether a pad's filters have a part in its next run: they sound, or take its force or its modes.
    fn join_in(&self, pad: u8, has_force: bool, banks: &[Bank]) -> bool;

    /// Whether a force makes a pad's filters sound.
    fn takes_force(&self, pad: u8) -> bool;

    /// Whether the modes of a pad's object go through its filter.
    fn takes_modes(&self, pad: u8) -> bool;

    /// Whether a pad has filters.
    fn has(&self, pad: u8) -> bool;

    /// A strike of a pad at a frame of the tick; `level` is its peak force over the reference force.
    fn strike(&mut self, pad: u8, level: f32, frame: usize);

    /// A hand that comes to a pad, and leaves so much of the amplitude after a frame, or goes.
    fn set_choked(&mut self, pad: u8, per_frame: Option<f64>);

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

    /// Nominal cycles that the filters of a pad take in a tick in which they sound, and whether they sound.
    fn cycles(&self, pad: u8) -> (u32, bool);
}

/// No room: no memory and no code. A kit's dynamic filters and biquads are then not heard.
#[derive(Clone, Copy, Debug)]
pub struct NoFilters;

impl FilterRoom for NoFilters {
    const EMPTY: Self = Self;

    #[inline(always)]
    fn load(&mut self, _: &Kit<'_>, _: SampleRate) -> Result<(), LoadError> {
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
    fn strike(&mut self, _: u8, _: f32, _: usize) {}

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
    fn cycles(&self, _: u8) -> (u32, bool) {
        (0, false)
    }
}

/// Room for the filters of so many pads: dynamic filters of at most `POINTS` breakpoints with at most `LOOPS` loops whose delays fit `FRAMES` frames, and biquads
/// in at most `PAIRS` pairs each (a pair for each biquad suffices).
#[derive(Clone, Debug)]
pub struct Filters<const COUNT: usize, const POINTS: usize, const LOOPS: usize, const FRAMES: usize, const PAIRS: usize>
{
    places: [Place<POINTS, LOOPS, FRAMES, PAIRS>; COUNT],
}

/// The filters of one pad.
#[derive(Clone, Debug)]
struct Place<const POINTS: usize, const LOOPS: usize, const FRAMES: usize, const PAIRS: usize> {
    pad: Option<u8>,
    filters: PadFilters<POINTS, LOOPS, FRAMES, PAIRS>,
}

impl<const COUNT: usize, const POINTS: usize, const LOOPS: usize, const FRAMES: usize, const PAIRS: usize>
    Filters<COUNT, POINTS, LOOPS, FRAMES, PAIRS>
{
    fn of(&self, pad: u8) -> Option<&PadFilters<POINTS, LOOPS, FRAMES, PAIRS>> {
        self.places.iter().find(|place| place.pad == Some(pad)).map(|place| &place.filters)
    }

    fn of_mut(&mut self, pad: u8) -> Option<&mut PadFilters<POINTS, LOOPS, FRAMES, PAIRS>> {
        self.places.iter_mut().find(|place| place.pad == Some(pad)).map(|place| &mut place.filters)
    }

    fn derive(&mut self, kit: &Kit<'_>, rate: SampleRate) -> Result<(), LoadError> {
        let mut free = self.places.iter_mut();
        for (pad, number) in kit.pads().zip(0u8..) {
            let object = pad.object_index();
            let filter = kit.dynamic_filter_of(object).map_err(LoadError::FilterTable)?;
            let biquads = kit.biquads_of(object).map_err(LoadError::FilterTable)?;
            if filter.is_none() && biquads.is_none() {
                continue;
            }
            let Some(place) = free.next() else { return Err(LoadError::TooManyFilters { capacity: COUNT }) };
            place.pad = Some(number);
            let reference_force = kit.object_of(pad).map_or(1.0, |object| object.reference_force());
            if let Some(filter) = filter {
                let hardest = kit.strikers_of(pad).map(|striker| striker.contact().peak_force()).fold(0.0, f32::max);
                let loaded = place.filters.load_dynamic(&filter, rate, u32::from(number), hardest / reference_force);
                loaded.map_err(|error| LoadError::DynamicFilter { pad: number, error })?;
            }
            if let Some(biquads) = biquads {
                let loaded = place.filters.load_biquads(&biquads, rate, reference_force);
                loaded.map_err(|error| LoadError::Biquads { pad: number, error })?;
            }
        }
        Ok(())
    }

    fn unload(&mut self) {
        for place in &mut self.places {
            place.pad = None;
            place.filters.unload();
        }
    }
}

impl<const COUNT: usize, const POINTS: usize, const LOOPS: usize, const FRAMES: usize, const PAIRS: usize> FilterRoom
    for Filters<COUNT, POINTS, LOOPS, FRAMES, PAIRS>
{
    const EMPTY: Self = Self { places: [const { Place { pad: None, filters: PadFilters::EMPTY } }; COUNT] };

    fn load(&mut self, kit: &Kit<'_>, rate: SampleRate) -> Result<(), LoadError> {
        self.unload();
        let result = self.derive(kit, rate);
        if result.is_err() {
            self.unload();
        }
        result
    }

    fn join_in(&self, pad: u8, has_force: bool, banks: &[Bank]) -> bool {
        self.of(pad).is_some_and(|filters| {
            filters.is_ringing()
                || has_force && filters.takes_force()
                || filters.takes_modes() && (has_force || is_ringing(banks))
        })
    }

    fn takes_force(&self, pad: u8) -> bool {
        self.of(pad).is_some_and(PadFilters::takes_force)
    }

    fn takes_modes(&self, pad: u8) -> bool {
        self.of(pad).is_some_and(PadFilters::takes_modes)
    }

    fn has(&self, pad: u8) -> bool {
        self.of(pad).is_some()
    }

    fn strike(&mut self, pad: u8, level: f32, frame: usize) {
        if let Some(filters) = self.of_mut(pad) {
            filters.strike(level, frame);
        }
    }

    fn set_choked(&mut self, pad: u8, per_frame: Option<f64>) {
        if let Some(filters) = self.of_mut(pad) {
            filters.set_choked(per_frame);
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
        self.of_mut(pad).map_or(FilterWork::default(), |filters| filters.render(frame, force, modes, out))
    }

    fn ringing(&self) -> u32 {
        self.places.iter().filter(|place| place.pad.is_some() && place.filters.is_ringing()).count() as u32
    }

    fn cycles(&self, pad: u8) -> (u32, bool) {
        self.of(pad).map_or((0, false), |filters| (filters.cycles_a_tick(), filters.is_ringing()))
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
    #[inline(always)]
    pub(super) fn strike_filters(&mut self, pad: u8, peak: i32) {
        let frame = (self.now % TICK_FRAMES as u64) as usize;
        self.filters.strike(pad, peak as f32 / crate::fixed::ONE_Q27 as f32, frame);
    }

    /// A hand that comes to a pad or goes; `t60_s` is what it imposes, 0 where it imposes nothing.
    #[inline(always)]
    pub(super) fn choke_filters(&mut self, pad: u8, action: Action, t60_s: f32) {
        if !self.filters.has(pad) {
            return;
        }
        let per_frame = libm::exp(-core::f64::consts::LN_10 * 3.0 / (f64::from(t60_s) * self.rate().hz()));
        self.filters.set_choked(pad, (action == Action::Choke && t60_s > 0.0).then_some(per_frame));
    }

    /// Cycles of the filters that sound, in this tick.
    #[inline(always)]
    pub(super) fn filter_cycles(&self) -> u32 {
        let pads = 0..self.pad_count as u8; // events count pads in a byte
        pads.map(|pad| self.filters.cycles(pad)).filter(|(_, sounds)| *sounds).map(|(cycles, _)| cycles).sum()
    }

    /// Cycles of the filters that a strike begins, in its tick.
    #[inline(always)]
    pub(super) fn filter_strike_cycles(&self, event: &Event) -> u32 {
        match self.filters.cycles(event.pad) {
            (cycles, false) if event.action == Action::Strike => cycles,
            _ => 0,
        }
    }
}
