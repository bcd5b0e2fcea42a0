//! Retirement: inaudible modes stop costing time.

use super::group::Group;
use super::mode::Mode;
use crate::time::TICK_FRAMES;

/// Rule by which modes retire: a group retires when each of its modes is below -110 dBFS, and only
/// while the sum of all retired amplitudes stays below -100 dBFS. So the output differs from the
/// unskipped one by less than -100 dBFS at any time.
#[derive(Clone, Copy, Debug)]
pub struct Retirement {
    /// Amplitude that may still retire, in output units.
    left: f32,
    /// Output units a bus step of this pad: level and pan of its louder side.
    unit: f32,
    retired_modes: u32,
}

impl Retirement {
    /// Amplitude below which a mode may retire: -110 dBFS.
    pub const THRESHOLD: f32 = 3.162_277_7e-6;
    /// Largest sum of the retired amplitudes: -100 dBFS.
    pub const SUM: f32 = 1e-5;

    /// A rule for a tick in which amplitudes of `already` are missing; `unit` is the output (1.0 =
    /// full scale) that a bus step of the pad makes.
    pub fn new(already: f32, unit: f32) -> Self {
        Self { left: Self::SUM - already, unit, retired_modes: 0 }
    }

    /// Number of modes that have retired under this rule.
    pub fn retired_modes(&self) -> u32 {
        self.retired_modes
    }

    /// True if an amplitude in bus steps is below the threshold.
    pub(super) fn is_below(&self, amplitude: f32) -> bool {
        amplitude * self.unit <= Self::THRESHOLD
    }

    /// Retires a group if the rule allows.
    #[cold]
    #[inline(never)]
    pub(super) fn consider(&mut self, group: &mut Group, modes: &mut [Mode], retired: &mut Retired) {
        if !group.ringing() || self.left <= 0.0 {
            return;
        }
        let Some(sum) = group.amplitudes_below(modes, Self::THRESHOLD / self.unit) else { return };
        let sum = sum * self.unit;
        if sum < self.left {
            self.left -= sum;
            self.retired_modes += modes.len() as u32;
            retired.add(sum, slowest_decay_per_tick(modes));
            group.silence(modes);
        }
    }
}

/// Sound of a bank that has retired and may still be missing: a bound that decays with its slowest
/// mode, from tick to tick, or in frames from block to block.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Retired {
    amplitude: f32,
    decay_per_step: f32,
}

impl Retired {
    pub(crate) const NOTHING: Self = Self { amplitude: 0.0, decay_per_step: 0.0 };
    /// Bound below which nothing counts as missing: -200 dBFS.
    const NEGLIGIBLE: f32 = 1e-10;

    #[inline(always)]
    pub(crate) fn amplitude(&self) -> f32 {
        self.amplitude
    }

    pub(crate) fn add(&mut self, amplitude: f32, decay_per_step: f32) {
        self.amplitude += amplitude;
        self.decay_per_step = self.decay_per_step.max(decay_per_step);
    }

    #[inline(always)]
    pub(crate) fn decay(&mut self) {
        if self.amplitude == 0.0 {
            return;
        }
        self.amplitude *= self.decay_per_step;
        if self.amplitude < Self::NEGLIGIBLE {
            *self = Self::NOTHING;
        }
    }
}

/// r^32 of the slowest mode, from r² = 1 - δ.
fn slowest_decay_per_tick(modes: &[Mode]) -> f32 {
    let delta = modes.iter().map(|mode| mode.coefficients.delta).min().unwrap_or(0);
    let mut power = 1.0 - delta as f32 / 4_294_967_296.0;
    // (r²)^16 by squaring four times; a tick is 32 samples.
    const { assert!(TICK_FRAMES == 32) };
    for _ in 0..4 {
        power *= power;
    }
    power
}
