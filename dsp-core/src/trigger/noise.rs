//! The noise floor of a channel, and the levels that follow from it.

use super::units::{COUNT, scale_q8};

/// Mean of the envelope while nothing is struck, in signal units.
///
/// The floor rises only if no strike has begun for 0.15 s: a roll is not noise. In a roll it falls
/// only where the envelope is below half of the floor. A floor that followed every dip of steady
/// noise, and no rise, would sink until noise is taken for strikes.
#[derive(Clone, Copy, Debug)]
pub(super) struct NoiseFloor {
    mean_q12: i32,
    quiet_ticks: u16,
}

/// Ticks without an onset after which the floor may rise: about 0.15 s.
const QUIET_TICKS: u16 = 225;
/// Shift by which the floor follows the envelope: a time constant of 2^6 ticks or 43 ms.
const SHIFT: u32 = 6;
/// Shift by which the floor follows the envelope while a channel warms up.
const FAST_SHIFT: u32 = 3;
/// Envelope that noise does not reach, in 1/256 of the noise's mean: 2.4, which is 6 standard
/// deviations of the envelope of white noise.
const ONSET_Q8: i32 = 614;
/// Envelope to which an onset is dated back, in 1/256 of the noise's mean: 1.5.
const FOOT_Q8: i32 = 384;
/// Magnitude that the samples of a resting channel may reach, in 1/256 of the noise's mean: 4.5.
const REST_Q8: i32 = 1152;

impl NoiseFloor {
    pub(super) const UNSET: Self = Self { mean_q12: 0, quiet_ticks: QUIET_TICKS };

    /// Mean envelope in signal units.
    pub(super) fn mean(&self) -> i32 {
        self.mean_q12 >> 4
    }

    /// Envelope above which noise does not go.
    pub(super) fn onset_level(&self) -> i32 {
        scale_q8(self.mean(), ONSET_Q8)
    }

    /// Envelope to which an onset is dated back.
    pub(super) fn foot_level(&self) -> i32 {
        scale_q8(self.mean(), FOOT_Q8) + COUNT / 2
    }

    /// Magnitude that the samples of a channel at rest may reach.
    pub(super) fn rest_level(&self) -> i32 {
        scale_q8(self.mean(), REST_Q8) + COUNT / 2
    }

    /// Keeps the floor from rising, because a strike begins.
    pub(super) fn struck(&mut self) {
        self.quiet_ticks = 0;
    }

    /// Takes the mean magnitude of a tick's samples at its end, at rest: as nothing rings, the
    /// floor follows it up and down.
    pub(super) fn rest(&mut self, magnitude: i32) {
        self.quiet_ticks = self.quiet_ticks.saturating_add(1);
        self.mean_q12 = self.mean_q12.wrapping_add((magnitude << 4).wrapping_sub(self.mean_q12) >> SHIFT);
    }

    /// Takes the envelope at the end of a tick that is not at rest, in signal units.
    pub(super) fn tick(&mut self, envelope: i32, warming_up: bool) {
        self.quiet_ticks = self.quiet_ticks.saturating_add(1);
        let error = (envelope << 4).wrapping_sub(self.mean_q12);
        if error < -(self.mean_q12 >> 1) || self.quiet_ticks > QUIET_TICKS {
            let shift = if warming_up { FAST_SHIFT } else { SHIFT };
            self.mean_q12 = self.mean_q12.wrapping_add(error >> shift);
        }
    }
}
