//! What a pad has beside its banks: a dynamic filter with its loops, and biquads.
//!
//! ```text
//! F ──► biquads ────────────────────────────────────────────────────────┐
//!  └──► object bank ─┬─ "beside" ───────────────────────────────────────┤
//!                    └─ "through" ─► dynamic filter ─► loops ─► hand ───┴─► the pad's bus
//! strike ──────────────► its noise ──────┘
//! ```
//!
//! A hand on the pad lets the sound of each fall by the pad's T60 where it falls slower by itself: the biquads' chains by poles of their own
//! ([`biquad::Bank::set_choked`]), the dynamic filter by a gain ([`Hand`]) for which its path says how it falls ([`Levels`]). The object's bank damps its modes by itself.

use super::hand::Hand;
use crate::SampleRate;
use crate::biquad::{self, Biquad, BiquadError, Root, TickKind};
use crate::dynamic_filter::level::Levels;
use crate::dynamic_filter::{Breakpoint, DynamicFilter, DynamicFilterError, Exciter, FilterSize, Settings};
use crate::fixed;
use crate::memory::{Lender, OutOfMemory, Region};
use crate::table;
use crate::table::layout::{BiquadRecord, BreakpointRecord, LoopRecord};
use crate::time::TICK_FRAMES;
use crate::waveguide::Loop;

/// Size of the filters of a voice.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct FiltersSize {
    /// Size of the dynamic filter, if there is one.
    pub dynamic: Option<FilterSize>,
    /// Number of biquads; 0 if there are none.
    pub biquads: usize,
}

/// The filters of one voice: a dynamic filter with its loops, and biquads.
#[derive(Debug)]
pub struct Filters<'m> {
    dynamic: DynamicFilter<'m>,
    biquads: biquad::Bank<'m>,
    /// Worst cycles of a tick in which the dynamic filter sounds, and of one in which the biquads do.
    pub(crate) cycles: [u32; 2],
    has_dynamic: bool,
    loop_count: u32,
    /// The filter runs louder by so many bits, its noise, modes and loops softer: [`louder_bits`].
    louder: u32,
    hand: Hand,
    /// How the dynamic filter's sound falls by itself, and frames since its path began.
    levels: Levels<'m>,
    since: u32,
    /// Whether the biquads do not hear the force of the last strike, and whether they have not rung since they did.
    deaf: bool,
    struck: bool,
    /// The frame within the tick that both are at.
    frame: usize,
}

/// What the filters of a pad did over a run.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct FilterWork {
    /// Frames of the dynamic filter.
    pub filter_frames: u32,
    /// Frames times loops.
    pub loop_frames: u32,
    /// Frames times biquads.
    pub biquad_frames: u32,
}

impl<'m> Filters<'m> {
    /// Neither a dynamic filter nor biquads: silent, at no cost.
    pub const fn empty() -> Self {
        Self {
            dynamic: DynamicFilter::empty(),
            biquads: biquad::Bank::empty(),
            cycles: [0; 2],
            has_dynamic: false,
            loop_count: 0,
            louder: 0,
            hand: Hand::AWAY,
            levels: Levels::none(),
            since: PAST,
            deaf: false,
            struck: false,
            frame: 0,
        }
    }

    /// Size of a dynamic filter at a rate.
    ///
    /// # Errors
    /// [`DynamicFilterError`] for loops that cannot be.
    pub fn size_of_dynamic(
        filter: &table::DynamicFilter<'_>,
        rate: SampleRate,
    ) -> Result<FilterSize, DynamicFilterError> {
        DynamicFilter::size(&settings(filter, 0), rate)
    }

    /// Takes the memory of filters, which are silent until they are loaded; `None` from an account.
    ///
    /// # Errors
    /// [`OutOfMemory`].
    pub fn place(lender: &mut impl Lender<'m>, size: FiltersSize) -> Result<Option<&'m mut Self>, OutOfMemory> {
        let mut filters = Self::empty();
        if let Some(size) = size.dynamic {
            filters.dynamic = DynamicFilter::take(lender, size)?;
            filters.levels = Levels::take(lender, size.breakpoints)?;
        }
        filters.biquads = biquad::Bank::take(lender, size.biquads)?;
        let place = lender.take(Region::Bulk, 1, Self::empty)?.first_mut();
        Ok(place.map(|place| {
            *place = filters;
            place
        }))
    }

    /// Derives the dynamic filter for a rate. `stream` tells noises of one seed apart, `peak` is the pad's hardest strike: peak force over the
    /// reference force, at velocity 1. `is_known` says that the filter has been loaded without memory, so that its loops are stable.
    ///
    /// # Errors
    /// [`DynamicFilterError`].
    #[inline(never)] // only on load: its stack is not the caller's
    pub fn load_dynamic(
        &mut self,
        filter: &table::DynamicFilter<'_>,
        rate: SampleRate,
        stream: u32,
        peak: f32,
        is_known: bool,
    ) -> Result<(), DynamicFilterError> {
        self.louder = louder_bits(peak);
        let settings = settings(filter, self.louder);
        let path = settings.path.clone();
        match is_known {
            true => self.dynamic.load_again(settings, rate, stream)?,
            false => self.dynamic.load(settings, rate, stream)?,
        }
        let at = (rate, rate.hz() / f64::from(filter.rate_hz()));
        self.levels.load(filter.order(), path, at, !filter.loops().is_empty());
        (self.has_dynamic, self.loop_count) = (true, filter.loops().len() as u32); // at most 16
        Ok(())
    }

    /// Checks a biquad bank without any memory for it.
    ///
    /// # Errors
    /// [`BiquadError`].
    pub fn check_biquads(bank: &table::Biquads<'_>, rate: SampleRate, reference_force: f32) -> Result<(), BiquadError> {
        carried(bank, rate, reference_force).enumerate().try_for_each(|(index, biquad)| biquad?.check(index))
    }

    /// Derives the biquads for a rate; `reference_force` is what 1.0 of force stands for, in newtons, `choke_t60_s` what a hand imposes, 0 where none can.
    ///
    /// # Errors
    /// [`BiquadError`].
    #[inline(never)] // likewise
    pub fn load_biquads(
        &mut self,
        bank: &table::Biquads<'_>,
        rate: SampleRate,
        reference_force: f32,
        choke_t60_s: f32,
    ) -> Result<(), BiquadError> {
        let (depth, biquads) = (bank.depth().max(1), carried(bank, rate, reference_force));
        let hand = if choke_t60_s > 0.0 { libm::exp(-nepers(choke_t60_s, rate)) } else { 1.0 };
        self.biquads.load_each(biquads, depth, hand)
    }

    /// Unloads the biquad bank.
    pub(crate) fn unload_biquads(&mut self) {
        self.biquads.unload();
        (self.deaf, self.struck) = (false, false);
    }

    fn has_biquads(&self) -> bool {
        self.biquads.size().0 > 0
    }

    /// Whether a force makes it sound.
    #[inline(always)]
    pub fn takes_force(&self) -> bool {
        self.has_biquads() && !self.deaf
    }

    /// Whether the object's modes go through it instead of to the output.
    #[inline(always)]
    pub fn takes_modes(&self) -> bool {
        self.has_dynamic && self.dynamic.takes_modes()
    }

    /// Whether anything sounds: otherwise it need not be rendered without force and modes.
    #[inline(always)]
    pub fn is_ringing(&self) -> bool {
        self.dynamic.is_ringing() || self.biquads.is_ringing()
    }

    /// Begins a strike at a frame of the tick; `level` is its peak force over the reference force.
    ///
    /// Parts that are not admitted, in the order of [`parts`](Self::parts), go without the strike: what rings rings on.
    pub fn strike(&mut self, level: f32, frame: usize, [dynamic, biquads]: [bool; 2]) {
        self.align(frame);
        self.lift();
        if self.has_dynamic && dynamic {
            self.dynamic.strike(level / (1u32 << self.louder) as f32);
            self.since = 0;
        }
        (self.deaf, self.struck) = (!biquads, biquads);
    }

    /// Whether there is a dynamic filter, and whether there are biquads.
    pub fn parts(&self) -> [bool; 2] {
        [self.has_dynamic, self.has_biquads()]
    }

    /// Whether the dynamic filter sounds, and whether the biquads do, or will by the strike that has just begun.
    pub fn sounding(&self) -> [bool; 2] {
        [self.dynamic.is_ringing(), self.biquads.is_ringing() || self.struck]
    }

    /// A hand that comes, to let the sound fall by so many nepers a frame, or goes, on a tick.
    pub fn set_choked(&mut self, nepers: Option<f64>) {
        self.align(0);
        if nepers.is_none() {
            self.lift();
        }
        self.hand.set(nepers);
        self.biquads.set_choked(nepers.is_some());
    }

    /// What rings is what the hand has left of it, and the hand begins anew.
    fn lift(&mut self) {
        if let Some(left) = self.hand.lift() {
            self.dynamic.attenuate(left);
        }
    }

    /// Adds a run, at most a tick long and within it, to the pad's bus. `force` is the force in the run, where there is one; `modes` are the
    /// object's, where they go through.
    pub fn render(
        &mut self,
        frame: usize,
        force: Option<&[i32]>,
        modes: Option<&mut [i32]>,
        out: &mut [i32],
    ) -> FilterWork {
        self.align(frame);
        let (mut work, frames) = (FilterWork::default(), out.len() as u32);
        if self.has_biquads() {
            let force = force.filter(|_| !self.deaf);
            if force.is_some() || self.biquads.is_ringing() {
                work.biquad_frames = frames * self.biquads.size().0 as u32;
            }
            self.biquads.render(force, out);
            self.struck &= !self.biquads.is_ringing();
        }
        let modes = modes.filter(|_| self.takes_modes());
        if modes.is_some() || self.dynamic.is_ringing() {
            (work.filter_frames, work.loop_frames) = (frames, frames * self.loop_count);
        }
        let mut modes = modes;
        if let Some(modes) = &mut modes {
            let half = (1 << self.louder) >> 1;
            modes.iter_mut().for_each(|mode| *mode = mode.saturating_add(half) >> self.louder);
        }
        if self.hand.is_away() {
            self.add_dynamic(modes.as_deref(), out);
        } else {
            self.add_under_hand(modes, out);
        }
        self.since = self.since.saturating_add(frames).min(PAST);
        self.frame = (self.frame + out.len()) % TICK_FRAMES;
        if self.frame == 0 && self.hand.settle() {
            self.dynamic.rest();
            self.since = PAST;
        }
        work
    }

    fn add_dynamic(&mut self, modes: Option<&[i32]>, out: &mut [i32]) {
        if modes.is_some() || self.dynamic.is_ringing() {
            self.dynamic.render(modes, out);
        } else {
            self.dynamic.pass(out.len());
        }
    }

    /// From tick to tick, strike to strike and breakpoint to breakpoint the hand takes one share a frame: a caller's blocks change nothing.
    #[inline(never)]
    fn add_under_hand(&mut self, mut modes: Option<&mut [i32]>, out: &mut [i32]) {
        let (mut sound, mut since, mut frame) = ([0; TICK_FRAMES], self.since, self.frame);
        let Some(mut rest) = sound.get_mut(..out.len()) else { return };
        while !rest.is_empty() {
            let mut frames = rest.len();
            // Silence, up to the first mode that sounds.
            let given = modes.as_deref().unwrap_or(&[]);
            let waits = if self.dynamic.is_ringing() {
                0
            } else {
                given.iter().position(|&mode| mode != 0).unwrap_or(frames).min(frames)
            };
            if waits > 0 {
                self.hand.rest();
                frames = waits;
            } else {
                if self.hand.frames() == 0 {
                    let (frames, falls) = self.levels.falls(since, (TICK_FRAMES - frame) as u32);
                    self.hand.expect(frames, falls);
                }
                frames = frames.min(self.hand.frames() as usize);
            }
            let Some((now, later)) = core::mem::take(&mut rest).split_at_mut_checked(frames) else { return };
            let given = modes.take().and_then(|given| given.split_at_mut_checked(frames)).map(|(given, more)| {
                modes = Some(more);
                if waits == 0 {
                    self.hand.raise(given);
                }
                &*given
            });
            self.add_dynamic(given, now);
            if waits == 0 {
                self.hand.fade(now);
            }
            (rest, since, frame) =
                (later, since.saturating_add(frames as u32).min(PAST), (frame + frames) % TICK_FRAMES);
        }
        out.iter_mut().zip(&sound).for_each(|(out, &x)| *out = fixed::qadd(*out, x));
    }

    /// Both count ticks, and are not asked while they are silent.
    fn align(&mut self, frame: usize) {
        let passed = (TICK_FRAMES + frame - self.frame) % TICK_FRAMES;
        if passed > 0 {
            self.dynamic.pass(passed);
            self.biquads.render(None, [0; TICK_FRAMES].get_mut(..passed).unwrap_or(&mut []));
        }
        self.frame = frame;
    }

    /// Nominal cycles that a hand's coming or going adds to its tick: all sections that ring are scaled anew, as by a strike.
    pub fn cycles_of_hand(&self) -> u32 {
        if self.biquads.is_ringing() {
            self.biquads.cycles(TickKind::Struck).saturating_sub(self.biquads.cycles(TickKind::Driven))
        } else {
            0
        }
    }

    /// Nominal cycles of a tick in which it sounds, or of one in which it is struck.
    pub fn cycles_a_tick(&self, struck: bool) -> u32 {
        let kind = if struck { TickKind::Struck } else { TickKind::Driven };
        self.dynamic.cycles_a_tick() + self.biquads.cycles(kind)
    }

    /// The same of the dynamic filter alone.
    pub fn dearest_of_dynamic(&self) -> u32 {
        self.dynamic.cycles_a_tick()
    }

    /// Nominal cycles of a tick in which so many biquads, in chains of `depth`, are struck: at most, where alike ones go in twos.
    pub(crate) fn dearest_of_biquads(biquads: usize, depth: usize) -> u32 {
        let each = if depth > 1 { 3000 } else { 2400 };
        biquads.div_ceil(2) as u32 * each + 1500
    }
}

/// What a table says of a dynamic filter that runs louder by so many bits.
fn settings<'a>(
    filter: &table::DynamicFilter<'a>,
    louder_bits: u32,
) -> Settings<impl Iterator<Item = Breakpoint> + Clone + use<'a>, impl Iterator<Item = Loop> + Clone + use<'a>> {
    let louder = libm::scalbn(1.0, louder_bits as i32);
    let exciter = filter.exciter().map(|band| {
        // The filter is told levels that are smaller by 1/louder.
        let exponent = f64::from(band.exponent);
        let factor = libm::pow(louder, exponent);
        Exciter { low_hz: f64::from(band.low_hz) * factor, high_hz: f64::from(band.high_hz) * factor, exponent }
    });
    Settings {
        seed: filter.seed(),
        rate_hz: f64::from(filter.rate_hz()),
        order: filter.order(),
        modes_through: filter.takes_modes(),
        exciter,
        path: filter.path().iter().zip(filter.levels()).map(move |(record, noise)| breakpoint(record, noise, louder)),
        loops: filter.loops().iter().map(move |record| band(record, louder)),
    }
}

/// Frames long after any path.
const PAST: u32 = u32::MAX / 2;

/// What a hand of a T60 wants the sound to fall by in a frame, in nepers.
pub(crate) fn nepers(t60_s: f32, rate: SampleRate) -> f64 {
    core::f64::consts::LN_10 * 3.0 / (f64::from(t60_s) * rate.hz())
}

/// The filter's noise is at most 1.0. Where a strike may be harder than the reference force, the filter is made louder by a power of two and what goes in softer.
fn louder_bits(peak: f32) -> u32 {
    (0..MOST_LOUDER).find(|&bits| peak <= (1u32 << bits) as f32).unwrap_or(MOST_LOUDER)
}

/// Forces are below 16 times the reference force.
const MOST_LOUDER: u32 = 4;

fn breakpoint(record: &BreakpointRecord, noise: f32, louder: f64) -> Breakpoint {
    Breakpoint {
        time_s: f64::from(record.time_s.get()),
        a1: f64::from(record.a1.get()),
        a2: f64::from(record.a2.get()),
        b0: f64::from(record.b0.get()) * louder,
        b1: f64::from(record.b1.get()) * louder,
        b2: f64::from(record.b2.get()) * louder,
        noise: f64::from(noise),
    }
}

fn band(record: &LoopRecord, louder: f64) -> Loop {
    Loop {
        frequency_hz: f64::from(record.frequency_hz.get()),
        bandwidth_hz: f64::from(record.bandwidth_hz.get()),
        gain: f64::from(record.gain.get()) / louder,
        delay_s: f64::from(record.delay_s.get()),
    }
}

/// The biquads of a table, carried to a rate.
fn carried<'a>(
    bank: &table::Biquads<'a>,
    rate: SampleRate,
    reference_force: f32,
) -> impl Iterator<Item = Result<Biquad, BiquadError>> + use<'a> {
    let (depth, rate_hz) = (bank.depth().max(1), f64::from(bank.rate_hz()));
    bank.records().iter().enumerate().map(move |(index, record)| {
        // The force in newtons goes into the first of each chain.
        let newtons = if index.is_multiple_of(depth) { f64::from(reference_force) } else { 1.0 };
        Biquad::from_roots_at(index, roots(record, newtons), rate_hz, rate)
    })
}

/// A record's pole, zero, and gain times another one.
fn roots(record: &BiquadRecord, gain: f64) -> (Root, Root, f64) {
    let root = |real: f32, imaginary: f32| Root { real: f64::from(real), imaginary: f64::from(imaginary) };
    let pole = root(record.pole_re.get(), record.pole_im.get());
    let zero = root(record.zero_re.get(), record.zero_im.get());
    (pole, zero, f64::from(record.gain.get()) * gain)
}
