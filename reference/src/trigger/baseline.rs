//! Baseline of a piezo channel (offset, drift, mains hum), by an observer that each tick's mean
//! corrects.

use std::f64::consts::PI;

use super::adc::TICK_FRAMES;

const MAINS_HZ: [f64; 2] = [50.0, 60.0];
/// Largest error in counts that corrects the observer: beyond it the signal is a strike, not hum.
const CLIP_COUNTS: f64 = 16.0;
const OFFSET_GAIN: f64 = 1.0 / 32.0;
const HUM_GAIN: f64 = 1.0 / 16.0;

pub(super) struct Baseline {
    offset: f64,
    /// Hum at each mains frequency: (in-phase part at the middle of a tick, quadrature half a tick
    /// later).
    hum: [(f64, f64); 2],
    turn: [f64; 2],
    /// Baseline at the next frame, in counts.
    pub(super) level: f64,
    /// Change of the baseline from frame to frame, in counts.
    slope: f64,
}

impl Baseline {
    pub(super) fn new(first_count: f64, rate_hz: f64) -> Self {
        let tick_s = TICK_FRAMES as f64 / rate_hz;
        Self {
            offset: first_count,
            hum: [(0.0, 0.0); 2],
            turn: MAINS_HZ.map(|hz| 2.0 * (PI * hz * tick_s).sin()),
            level: first_count,
            slope: 0.0,
        }
    }

    pub(super) fn step(&mut self) {
        self.level += self.slope;
    }

    /// Change of the baseline from the beginning of a tick to its middle, in counts.
    pub(super) fn half_tick_ramp(&self) -> f64 {
        self.slope * TICK_FRAMES as f64 / 2.0
    }

    pub(super) fn tick(&mut self, mean: f64, listening: bool) {
        if listening {
            let expected = self.offset + self.hum.iter().map(|hum| hum.0).sum::<f64>();
            let error = (mean - expected).clamp(-CLIP_COUNTS, CLIP_COUNTS);
            self.offset += OFFSET_GAIN * error;
            self.hum.iter_mut().for_each(|hum| hum.0 += HUM_GAIN * error);
        }
        let mut end = self.offset;
        for (hum, turn) in self.hum.iter_mut().zip(self.turn) {
            *hum = turned(*hum, turn);
            end += (hum.0 + turned(*hum, turn).0) / 2.0;
        }
        self.slope = (end - self.level) / TICK_FRAMES as f64;
    }
}

/// One rotation step of the coupled form, which keeps the amplitude.
fn turned((in_phase, quadrature): (f64, f64), turn: f64) -> (f64, f64) {
    let quadrature = quadrature - turn * in_phase;
    (in_phase + turn * quadrature, quadrature)
}
