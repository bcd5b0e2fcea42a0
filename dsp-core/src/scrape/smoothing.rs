//! Gaussian smoothing of the path (scraping-rolling §2.2), over a width that moves with the limit.
//!
//! The filter looks as far ahead as it looks back, so that its output comes a tick late. Taps
//! beyond [`DEVIATIONS`] are left out, and the rest sum up to 1.

use super::kernel::{TAPS, filter};
use super::limit::power_of_half;
use super::ramp::power_of_two;
use crate::fixed;
use crate::time::TICK_FRAMES;

/// Most taps to either side of the middle one.
const MAX_REACH: usize = TICK_FRAMES - 1;
/// Standard deviations that the taps reach. Where they end at 3, the third octave that lies 39 dB
/// below the loudest is 4.8 dB off at the largest limit.
const DEVIATIONS: f32 = 3.5;
/// Least variance that is smoothed, in square frames: less changes 16 kHz by 0.1 dB at 48 kHz.
const LEAST_VARIANCE: f32 = 0.005;
/// Ticks before the newest that its filter sees: that of the output, and the one before.
const BEHIND: usize = 2;
/// Ticks that lie one behind the other, until the last two move back to the begin.
const ROOM: usize = 5;

/// Smoothing filter with its history.
#[derive(Clone, Debug)]
pub(super) struct Smoothing {
    /// Frames of the ticks; behind them a place for taps of 0.
    history: [[i32; TICK_FRAMES]; ROOM + 1],
    /// Number of the newest tick in the history.
    newest: usize,
    /// True if there is no smoothing, and no delay.
    is_off: bool,
    deviation: f32,
    less: f32,
    /// Taps, Q31: the middle one at [`MAX_REACH`], and 0 behind the last one.
    taps: [i32; 2 * MAX_REACH + 1 + TAPS],
    reach: usize,
    /// Number of ticks since the last one in which something moved.
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
            history: [[0; TICK_FRAMES]; ROOM + 1],
            newest: BEHIND,
            is_off: true,
            deviation: -1.0,
            less: 0.0,
            taps: [0; 2 * MAX_REACH + 1 + TAPS],
            reach: 0,
            quiet_ticks: 3,
            halvings: 0,
            work: [0; 2],
        }
    }

    /// Begins with silence, for deviations of up to `widest` frames.
    pub(super) fn begin(&mut self, widest: f32) {
        self.history.as_flattened_mut().fill(0);
        (self.newest, self.is_off) = (BEHIND, widest * widest < LEAST_VARIANCE);
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
        self.history.as_flattened_mut().fill(0);
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
        self.reach = reach_of(variance);
        self.work[0] = 1 + self.reach as u32;
        // e^(-1/2σ²) = 2^-(1/(2 ln 2 σ²)), whose exponent is at most 15.
        let exponent = (1.0 / (2.0 * core::f32::consts::LN_2))
            / (if variance > LEAST_VARIANCE { variance } else { LEAST_VARIANCE });
        let first = (power_of_half(if exponent < 15.0 { exponent } else { 15.0 }) * power_of_two(31)) as i32;
        // The tap k is first^(k²): each is the one before times first^(2k + 1). All are Q31.
        let square = fixed::times_q31(first, first);
        let Some((left, [middle, right @ ..])) = self.taps.split_at_mut_checked(MAX_REACH) else { return };
        let Some((right, rest)) = right.split_at_mut_checked(self.reach) else { return };
        let (mut weight, mut ratio, mut sum) = (i32::MAX, first, 1 << 24);
        for tap in right.iter_mut() {
            weight = fixed::times_q31(weight, ratio);
            ratio = fixed::times_q31(ratio, square);
            *tap = weight;
            // At most 2^30, since there are 31 at most.
            sum += weight >> 6;
        }
        // One of both sides has been added up, and half the middle one, Q25.
        let scale = power_of_two(31 + 24) / sum as f32;
        // `as` saturates where the middle tap is 1.
        let scale = scale as i32;
        *middle = scale;
        for (before, behind) in left.iter_mut().rev().zip(right) {
            *behind = fixed::times_q31(*behind, scale);
            *before = *behind;
        }
        rest.first_chunk_mut().into_iter().for_each(|taps: &mut [i32; TAPS]| *taps = [0; TAPS]);
    }

    /// Room for the frames of the next tick, each at most 2^30 in size, whose unit has been halved
    /// so many times; those of the history get the same unit.
    pub(super) fn room(&mut self, halvings: u32) -> &mut [i32; TICK_FRAMES] {
        self.newest += 1;
        if self.newest == ROOM {
            (self.history[0], self.history[1]) = (self.history[ROOM - 2], self.history[ROOM - 1]);
            self.newest = BEHIND;
        }
        let (less, more) = (self.halvings.saturating_sub(halvings), halvings.saturating_sub(self.halvings));
        self.halvings = halvings;
        if (less, more) != (0, 0) {
            let behind = self.history.get_mut(self.newest - BEHIND..self.newest).unwrap_or(&mut []);
            let frames = behind.as_flattened_mut().iter_mut();
            frames.for_each(|frame| *frame = (*frame >> (less & 31)) << (more & 31));
        }
        // Never the first one: that is for the compiler.
        let [first, others @ ..] = &mut self.history;
        others.get_mut(self.newest - 1).unwrap_or(first)
    }

    /// Gives the frames of the tick before that in the [`room`](Self::room), smoothed; or, without
    /// a delay, those of the tick itself. In a quiet one nothing has moved.
    pub(super) fn render(&mut self, is_quiet: bool, frames: &mut [i32; TICK_FRAMES]) {
        self.quiet_ticks = if is_quiet { (self.quiet_ticks + 1).min(3) } else { 0 };
        if self.is_off {
            self.history.get(self.newest).into_iter().for_each(|tick| *frames = *tick);
            return;
        }
        let count = (2 * self.reach + 1).next_multiple_of(TAPS);
        self.work[1] = count as u32;
        let taps = self.taps.get(MAX_REACH - self.reach..).and_then(|taps| taps.get(..count)).unwrap_or(&[]);
        let first = (self.newest - 1) * TICK_FRAMES - self.reach;
        filter(self.history.as_flattened().get(first..).unwrap_or(&[]), taps, frames);
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

/// Standard deviation in frames that is rendered for another.
///
/// It is rounded to one of 128 steps in an octave, so that the taps of a tick are often those of
/// the one before.
pub(super) fn deviation_of(deviation: f32) -> f32 {
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
            for _ in 0..9 {
                *smoothing.room(0) = [1 << 29; TICK_FRAMES];
                smoothing.render(false, &mut frames);
            }
            assert!(frames.iter().all(|&x| (x - (1 << 29)).abs() < 200), "{deviation}: {frames:?}");
        }
    }
}
