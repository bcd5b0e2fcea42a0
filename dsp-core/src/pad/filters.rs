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
use crate::dynamic_filter::{Breakpoint, DynamicFilter, DynamicFilterError, Exciter, Settings};
use crate::fixed;
use crate::resonator::TICK_FRAMES;
use crate::table;
use crate::table::layout::{BiquadRecord, BreakpointRecord, LoopRecord};
use crate::waveguide::Loop;

/// The filters of one pad: a dynamic filter of at most `POINTS` breakpoints with at most `LOOPS` loops whose delays fit `FRAMES` frames, and biquads
/// in at most `PAIRS` pairs (a pair for each suffices).
#[derive(Clone, Debug)]
pub struct PadFilters<const POINTS: usize, const LOOPS: usize, const FRAMES: usize, const PAIRS: usize> {
    dynamic: DynamicFilter<POINTS, LOOPS, FRAMES>,
    biquads: biquad::Bank<PAIRS>,
    has_dynamic: bool,
    loop_count: u32,
    /// The filter runs louder by so many bits, its noise, modes and loops softer: [`louder_bits`].
    louder: u32,
    hand: Hand,
    /// How the dynamic filter's sound falls by itself, and frames since its path began.
    levels: Levels<POINTS>,
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

impl<const POINTS: usize, const LOOPS: usize, const FRAMES: usize, const PAIRS: usize>
    PadFilters<POINTS, LOOPS, FRAMES, PAIRS>
{
    /// None of both: silent, at no cost.
    pub const EMPTY: Self = Self {
        dynamic: DynamicFilter::EMPTY,
        biquads: biquad::Bank::EMPTY,
        has_dynamic: false,
        loop_count: 0,
        louder: 0,
        hand: Hand::AWAY,
        levels: Levels::NONE,
        since: PAST,
        deaf: false,
        struck: false,
        frame: 0,
    };

    /// Makes it none of both.
    pub fn unload(&mut self) {
        self.unload_dynamic();
        self.unload_biquads();
        (self.hand, self.frame, self.since) = (Hand::AWAY, 0, PAST);
    }

    /// Derives the dynamic filter for a rate. `stream` tells noises of one seed apart, `peak` is the pad's hardest strike: peak force over the
    /// reference force, at velocity 1.
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
    ) -> Result<(), DynamicFilterError> {
        self.louder = louder_bits(peak);
        let louder = libm::scalbn(1.0, self.louder as i32);
        let exciter = filter.exciter().map(|band| {
            // The filter is told levels that are smaller by 1/louder.
            let exponent = f64::from(band.exponent);
            let factor = libm::pow(louder, exponent);
            Exciter { low_hz: f64::from(band.low_hz) * factor, high_hz: f64::from(band.high_hz) * factor, exponent }
        });
        let path = filter.path().iter().zip(filter.levels()).map(|(record, noise)| breakpoint(record, noise, louder));
        let settings = Settings {
            seed: filter.seed(),
            rate_hz: f64::from(filter.rate_hz()),
            order: filter.order(),
            modes_through: filter.takes_modes(),
            exciter,
            path: path.clone(),
            loops: filter.loops().iter().map(|record| band(record, louder)),
        };
        self.dynamic.load(settings, rate, stream)?;
        let at = (rate, rate.hz() / f64::from(filter.rate_hz()));
        self.levels.load(filter.order(), path, at, !filter.loops().is_empty());
        (self.has_dynamic, self.loop_count) = (true, filter.loops().len() as u32); // at most 16
        Ok(())
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
        let depth = bank.depth().max(1);
        let rate_hz = f64::from(bank.rate_hz());
        let biquads = bank.records().iter().enumerate().map(|(index, record)| {
            // The force in newtons goes into the first of each chain.
            let newtons = if index.is_multiple_of(depth) { f64::from(reference_force) } else { 1.0 };
            Biquad::from_roots_at(index, roots(record, newtons), rate_hz, rate)
        });
        let hand = if choke_t60_s > 0.0 { libm::exp(-nepers(choke_t60_s, rate)) } else { 1.0 };
        self.biquads.load_each(biquads, depth, hand)
    }

    /// Leaves the biquads alone.
    pub fn unload_dynamic(&mut self) {
        self.dynamic.unload();
        (self.has_dynamic, self.loop_count, self.louder) = (false, 0, 0);
    }

    /// Leaves the dynamic filter alone.
    pub fn unload_biquads(&mut self) {
        self.biquads.unload();
        (self.deaf, self.struck) = (false, false);
    }

    /// Whether there is anything.
    pub fn is_built(&self) -> bool {
        self.has_dynamic || self.has_biquads()
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

    /// The same of the biquads alone, struck.
    pub fn dearest_of_biquads(&self) -> u32 {
        self.biquads.cycles(TickKind::Struck)
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

/// A record's pole, zero, and gain times another one.
fn roots(record: &BiquadRecord, gain: f64) -> (Root, Root, f64) {
    let root = |real: f32, imaginary: f32| Root { real: f64::from(real), imaginary: f64::from(imaginary) };
    let pole = root(record.pole_re.get(), record.pole_im.get());
    let zero = root(record.zero_re.get(), record.zero_im.get());
    (pole, zero, f64::from(record.gain.get()) * gain)
}
