//! The baseline of a piezo's channel: the bias' offset, its drift, and mains hum.
//!
//! The baseline is an observer. A model of the disturbance (a constant and one oscillator for each
//! mains frequency) runs freely and is pulled towards the mean of every 32 frames:
//!
//! ```text
//! e = clip(mean - o - h50 - h60)    o += e/32    h += e/16, then h turns by 2πf·T
//! ```
//!
//! Seen from the input, the observer is a notch at 0, 50 and 60 Hz. Hum of 10 counts, 0.1 Hz off
//! its nominal frequency, is down to 0.6 counts after 0.3 s (the tests below).
//!
//! Two things make the observer fit for percussion, and a plain high-pass unfit. `e` is clipped, so
//! that a loud ring hardly moves the model. During a scan the model is not pulled but runs on, so
//! that a strike's peak is measured from the disturbance's expected course. The observer is cheap
//! because it works on means.

use super::units::{COUNT, LAST_COUNT};
use crate::SampleRate;
use crate::fixed::{smmla, smmls};
use crate::sine;
use crate::time::TICK_FRAMES;

/// Mains frequencies of the world, in Hz. Both are always followed, so that there is no setting to
/// get wrong.
const MAINS_HZ: [f64; 2] = [50.0, 60.0];
/// Bits that the observer's states have below a signal unit, so that small errors still move them.
const FINE: u32 = 8;
/// Largest error that pulls the observer, in signal units. Quiet hum and drift stay below it; rings
/// do not.
const CLIP: i32 = 16 * COUNT;
/// Shift by which the offset follows the error.
const OFFSET_SHIFT: u32 = 5;
/// Shift by which an oscillator follows the error.
const HUM_SHIFT: u32 = 4;

/// Turn of the mains' oscillators in a tick.
#[derive(Clone, Copy, Debug)]
pub(super) struct MainsTurn {
    /// `2 sin(πf·T)` of each oscillator in Q32, T a tick; below 0.5 for all rates that a trigger
    /// takes.
    coefficient: [i32; MAINS_HZ.len()],
}

impl MainsTurn {
    pub(super) fn new(rate: SampleRate) -> Self {
        let tick_s = TICK_FRAMES as f64 / rate.hz();
        let coefficient =
            MAINS_HZ.map(|hz| (2.0 * sine::sin(core::f64::consts::PI * hz * tick_s) * 4_294_967_296.0) as i32);
        Self { coefficient }
    }
}

/// Oscillator in coupled form: `v` is the hum at a tick's middle, `u` its quadrature half a tick
/// later. Both are Q16 counts.
#[derive(Clone, Copy, Debug)]
struct Oscillator {
    u: i32,
    v: i32,
}

impl Oscillator {
    fn turned(self, coefficient: i32) -> Self {
        let u = smmls(self.u, coefficient, self.v);
        Self { u, v: smmla(self.v, coefficient, u) }
    }
}

/// State of the observer of one channel.
#[derive(Clone, Copy, Debug)]
pub(super) struct Baseline {
    offset: i32,
    hum: [Oscillator; MAINS_HZ.len()],
    /// Baseline at the next frame, in signal units.
    pub(super) level: i32,
    /// Slope of the baseline, in signal units a frame.
    pub(super) slope: i32,
    started: bool,
}

impl Baseline {
    pub(super) const UNSET: Self =
        Self { offset: 0, hum: [Oscillator { u: 0, v: 0 }; MAINS_HZ.len()], level: 0, slope: 0, started: false };

    /// Starts the baseline at the first sample; does nothing after that.
    pub(super) fn start(&mut self, raw: u16) {
        if !self.started {
            self.started = true;
            let counts = i32::from(raw.min(LAST_COUNT));
            self.offset = counts << (8 + FINE);
            self.level = counts << 8;
        }
    }

    /// Takes the sum of a tick's 32 samples in counts at its end; `listening` is false while a
    /// strike is scanned.
    pub(super) fn tick(&mut self, sum: i32, listening: bool, turn: &MainsTurn) {
        if listening {
            // A sum of 32 samples is their mean in Q5 counts.
            let mean = sum << 3;
            let [first, second] = &mut self.hum;
            let expected = self.offset.wrapping_add(first.v).wrapping_add(second.v) >> FINE;
            let error = mean.wrapping_sub(expected).clamp(-CLIP, CLIP) << FINE;
            // Bounded by the input: the offset follows the mean, an oscillator takes at most
            // CLIP/16 a tick and leaks through the error.
            self.offset = self.offset.wrapping_add(error >> OFFSET_SHIFT).clamp(0, i32::from(LAST_COUNT) << (8 + FINE));
            let pulled = |v: i32| v.wrapping_add(error >> HUM_SHIFT).clamp(-HUM_LIMIT, HUM_LIMIT);
            (first.v, second.v) = (pulled(first.v), pulled(second.v));
        }
        // The end of a tick lies halfway between its middle and the next tick's middle.
        let turned_twice = |hum: &mut Oscillator, coefficient: i32| {
            *hum = hum.turned(coefficient);
            hum.v.wrapping_add(hum.turned(coefficient).v)
        };
        let ([first, second], [of_first, of_second]) = (&mut self.hum, turn.coefficient);
        let hum_twice = turned_twice(first, of_first).wrapping_add(turned_twice(second, of_second));
        let end_twice = self.offset.wrapping_mul(2).wrapping_add(hum_twice);
        // The ramp leads to the baseline that is expected at the end of the next tick. The next
        // ramp makes up for what the shift cuts off.
        let target = end_twice >> (FINE + 1);
        self.slope = target.wrapping_sub(self.level) >> 5;
    }
}

/// Largest hum of a channel: 256 counts. More than that is a fault of the wiring.
const HUM_LIMIT: i32 = 256 << (8 + FINE);

#[cfg(test)]
mod tests {
    use super::*;

    /// Largest residue, in counts, that a disturbance leaves from 0.3 s to 1 s. The disturbance is
    /// in counts and rounded as by the ADC. From 0.6 s on the baseline does not listen for
    /// `deaf_ticks`.
    fn residue(disturbance: impl Fn(f64) -> f64, deaf_ticks: usize) -> f64 {
        let turn = MainsTurn::new(SampleRate::HZ_48000);
        let mut baseline = Baseline::UNSET;
        let mut worst = 0.0f64;
        for tick in 0..1500usize {
            let mut sum = 0;
            for n in 0..TICK_FRAMES {
                let t = (tick * TICK_FRAMES + n) as f64 / 48_000.0;
                let exact = 2048.0 + disturbance(t);
                let raw = libm::round(exact) as u16;
                baseline.start(raw);
                if t > 0.3 {
                    worst = worst.max((exact - f64::from(baseline.level) / f64::from(COUNT)).abs());
                }
                baseline.level += baseline.slope;
                sum += i32::from(raw);
            }
            baseline.tick(sum, !(900..900 + deaf_ticks).contains(&tick), &turn);
        }
        worst
    }

    fn hum(hz: f64) -> impl Fn(f64) -> f64 {
        move |t| 10.0 * libm::sin(core::f64::consts::TAU * hz * t)
    }

    #[test]
    fn mains_hum_of_10_counts_is_down_to_three_fifths_of_a_count_after_0_3_s() {
        for hz in [49.9, 50.0, 50.1, 59.9, 60.0, 60.1] {
            assert!(residue(hum(hz), 0) < 0.6, "{hz} Hz: {}", residue(hum(hz), 0));
        }
    }

    #[test]
    fn hum_of_10_counts_is_predicted_to_one_count_while_a_strike_is_scanned() {
        // 20 ms, a whole period.
        assert!(residue(hum(50.05), 30) < 1.0, "{}", residue(hum(50.05), 30));
    }

    #[test]
    fn baseline_finds_an_offset_to_an_eighth_of_a_count_and_follows_drift_to_one_count() {
        assert!(residue(|_| -123.0, 0) < 0.125);
        assert!(residue(|t| 20.0 * libm::sin(t), 0) < 1.0);
    }
}
