//! Mix of the path's rises at two limits between which those of a tick lie.

use super::kernel::slope::{MIXED_BITS, Mix};
use super::ramp::{bits_for, fixed_from};

/// Largest rise of a frame, Q31 of the unit: 1.375 times what the limit allows, since waves cut
/// off in an octave leave overshoots. Where two segments fade it grows by 1.38, to below 2^30.
const LARGEST: i32 = 11 << 26;

/// Bits that the weights have less than [`bits_for`] allows.
const WEIGHT_BITS_LESS: i32 = 5;

impl Mix {
    /// No rise.
    pub(super) const NONE: Self = Self { weights: [0; 2], largest: 0, left: 0 };

    /// Prepares a tick with slopes of one in the splines' values at two limits, and with the
    /// weights of both. One unit of the result is a rise by `unit`.
    pub(super) fn new(slope_units: [f32; 2], weights: [f32; 2], unit: f32) -> Self {
        let per_unit = 1.0 / unit;
        let [first, second] = [weights[0] * slope_units[0] * per_unit, weights[1] * slope_units[1] * per_unit];
        // Weights of at most 2^24, and rises of at least 31 bits.
        let bits = (bits_for([first, second], 90) - WEIGHT_BITS_LESS).min(31 + MIXED_BITS);
        let left = (31 + MIXED_BITS - bits).min(30);
        Self {
            weights: [first, second].map(|weight| fixed_from(weight, bits)),
            largest: LARGEST >> left,
            left: left as u32,
        }
    }
}
