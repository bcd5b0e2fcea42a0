//! Gaussian smoothing of the path (scraping-rolling §2.2), over a width that moves with the limit.
//!
//! The filter looks as far ahead as it looks back, so that its output comes a tick late. Taps
//! beyond [`DEVIATIONS`] are left out, and the rest sum up to 1.

use super::kernel::{TAPS, filter};
use super::ramp::power_of_two;
use crate::SampleRate;
use crate::time::TICK_FRAMES;

/// Most taps to either side of the middle one.
const MAX_REACH: usize = TICK_FRAMES - 1;
/// Standard deviations that the taps reach. Where they end at 3, the third octave that lies 39 dB
/// below the loudest is 4.8 dB off at the largest limit.
const DEVIATIONS: f32 = 3.5;
/// Least variance that is smoothed, in square frames: less changes 16 kHz by 0.1 dB at 48 kHz.
const LEAST_VARIANCE: f32 = 0.005;
/// Frames that the filter sees: the tick before that of the output, that one, and the next.
const SEEN: usize = 3 * TICK_FRAMES;
/// Most taps with those of 0 at their end.
const MAX_TAPS: usize = (2 * MAX_REACH + 1).next_multiple_of(TAPS);

/// Smoothing filter with its history.
#[derive(Clone, Debug)]
pub(super) struct Smoothing {
    /// Frames of three ticks, each twice, so that any three lie one behind the other; behind them
    /// room for taps of 0.
    history: [i32; 2 * SEEN + 4],
    /// Begin of the next tick in the history's first half.
    next: usize,
    /// True if there is no smoothing, and no delay.
    is_off: bool,
    deviation: f32,
    less: f32,
    /// Taps, Q31, in whole steps of [`TAPS`]; the middle one stands at `reach`.
    taps: [i32; MAX_TAPS],
    reach: usize,
    /// Number of ticks since the last one that was not all 0.
    quiet_ticks: u32,
    /// Number of times that the unit of the frames has been halved.
    halvings: u32,
    /// Taps that the last tick derived, and those that it filtered with.
    work: [u32; 2],
}

/// Widest standard deviation that is rendered, in frames.
const MAX_DEVIATION: f32 = MAX_REACH as f32 / 3.0;

/// Number of taps to either side for a variance in square frames.
fn reach_of(variance: f32) -> usize {
    let deviation = crate::square_root::rounded_root(variance);
    if variance < LEAST_VARIANCE { 0 } else { ((deviation * DEVIATIONS) as usize + 1).min(MAX_REACH) }
}

impl Smoothing {
    /// No smoothing.
    pub(super) const fn off() -> Self {
        Self {
            history: [0; 2 * SEEN + 4],
            next: 0,
            is_off: true,
            deviation: -1.0,
            less: 0.0,
            taps: [0; MAX_TAPS],
            reach: 0,
            quiet_ticks: 3,
            halvings: 0,
            work: [0; 2],
        }
    }

    /// Begins with silence, for deviations of up to `widest` frames.
    pub(super) fn begin(&mut self, widest: f32) {
        self.history.fill(0);
        (self.next, self.is_off) = (0, widest * widest < LEAST_VARIANCE);
        (self.deviation, self.less) = (-1.0, 0.0);
        self.taps.fill(0);
        (self.reach, self.quiet_ticks, self.halvings, self.work) = (0, 3, 0, [0; 2]);
    }

    /// Delay of the output in frames: none, or a tick.
    pub(super) const fn delay(&self) -> usize {
        if self.is_off { 0 } else { TICK_FRAMES }
    }

    /// Forgets what has gone in.
    pub(super) fn stop(&mut self) {
        self.history.fill(0);
        self.quiet_ticks = 3;
    }

    /// Sets the standard deviation in frames, less the variance that the input has been smoothed by
    /// already, in square frames.
    pub(super) fn set(&mut self, deviation: f32, less: f32) {
        self.work = [0; 2];
        if self.is_off || (deviation == self.deviation && less == self.less) {
            return;
        }
        (self.deviation, self.less) = (deviation, less);
        let variance = deviation * deviation - less;
        let before = self.reach;
        self.reach = reach_of(variance);
        self.work[0] = 1 + self.reach as u32;
        // e^(-1/2σ²) = 2^-(1/(2 ln 2 σ²)), whose exponent is at most 15.
        let exponent = (1.0 / (2.0 * core::f32::consts::LN_2))
            / (if variance > LEAST_VARIANCE { variance } else { LEAST_VARIANCE });
        let first = power_of_half(if exponent < 15.0 { exponent } else { 15.0 });
        // The tap k is first^(k²): each is the one before times first^(2k + 1).
        let square = first * first;
        let (mut weight, mut ratio, mut sum) = (1.0, first, 1.0);
        for _ in 0..self.reach {
            weight *= ratio;
            ratio *= square;
            sum += 2.0 * weight;
        }
        let scale = power_of_two(31) / sum;
        let Some((left, [middle, right @ ..])) = self.taps.split_at_mut_checked(self.reach) else { return };
        // `as` saturates where the middle tap is 1.
        *middle = scale as i32;
        (weight, ratio) = (1.0, first);
        for (before, behind) in left.iter_mut().rev().zip(right) {
            weight *= ratio;
            ratio *= square;
            *before = (weight * scale) as i32;
            *behind = *before;
        }
        self.taps.iter_mut().take(2 * before + 1).skip(2 * self.reach + 1).for_each(|tap| *tap = 0);
    }

    /// Gives frames to come, and those of the history, a unit that is so many times halved.
    pub(super) fn set_unit(&mut self, halvings: u32) {
        let (less, more) = (self.halvings.saturating_sub(halvings), halvings.saturating_sub(self.halvings));
        self.halvings = halvings;
        if (less, more) != (0, 0) {
            self.history.iter_mut().for_each(|frame| *frame = (*frame >> (less & 31)) << (more & 31));
        }
    }

    /// Takes a tick of frames, each at most 2^30 in size, and gives those of the tick before,
    /// smoothed.
    pub(super) fn render(&mut self, frames: &mut [i32; TICK_FRAMES]) {
        self.quiet_ticks = if frames.iter().all(|&x| x == 0) { (self.quiet_ticks + 1).min(3) } else { 0 };
        if self.is_off {
            return;
        }
        for half in [0, SEEN] {
            if let Some(place) = self.history.get_mut(self.next + half..).and_then(<[i32]>::first_chunk_mut) {
                *place = *frames;
            }
        }
        self.next = if self.next + TICK_FRAMES == SEEN { 0 } else { self.next + TICK_FRAMES };
        let count = (2 * self.reach + 1).next_multiple_of(TAPS);
        self.work[1] = count as u32;
        let taps = self.taps.get(..count).unwrap_or(&[]);
        // The oldest tick lies where the next one will be written.
        let first = self.next + TICK_FRAMES - self.reach;
        filter(self.history.get(first..).unwrap_or(&[]), taps, frames);
    }

    /// Taps that the last tick derived, 0 if none, and those that it filtered with.
    pub(super) const fn work(&self) -> [u32; 2] {
        self.work
    }

    /// True if nothing but zeros has gone in for as long as the filter remembers.
    pub(super) const fn is_silent(&self) -> bool {
        self.quiet_ticks >= if self.is_off { 1 } else { 3 }
    }
}

/// Power of one half, exact to 2e-7, for exponents from 0 to 15.
fn power_of_half(exponent: f32) -> f32 {
    let whole = exponent as i32;
    // e^-y about the middle of an octave.
    let y = core::f32::consts::LN_2 * (exponent - whole as f32 - 0.5);
    let series = [-1.0 / 5040.0, 1.0 / 720.0, -1.0 / 120.0, 1.0 / 24.0, -1.0 / 6.0, 0.5, -1.0, 1.0];
    let power = series.into_iter().fold(0.0, |sum, term| sum * y + term);
    core::f32::consts::FRAC_1_SQRT_2 * power * power_of_two(-whole)
}

/// Standard deviation in frames of a time in seconds.
///
/// It is rounded to one of 128 steps in an octave, so that the taps of a tick are often those of
/// the one before.
pub(super) fn deviation_of(seconds: f32, rate: SampleRate) -> f32 {
    let deviation = seconds * rate.hz_f32();
    let deviation = if deviation < MAX_DEVIATION { deviation } else { MAX_DEVIATION };
    f32::from_bits((deviation.to_bits() + (1 << 15)) & !((1 << 16) - 1))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn constant_comes_out_as_it_went_in_a_tick_later() {
        for deviation in [0.1, 0.5, 1.0, 3.0, MAX_DEVIATION] {
            let mut smoothing = Smoothing::off();
            smoothing.begin(deviation);
            smoothing.set(deviation, 0.0);
            let mut frames = [0; TICK_FRAMES];
            for _ in 0..4 {
                frames = [1 << 29; TICK_FRAMES];
                smoothing.render(&mut frames);
            }
            assert!(frames.iter().all(|&x| (x - (1 << 29)).abs() < 200), "{deviation}: {frames:?}");
        }
    }
}
