//! Mix of the path's rises at two limits between which those of a tick lie.

use super::kernel::slope::{Mix, ONE};
use super::ramp::{Normal, Ramp};
use crate::table::Surface;

/// Largest rise of a frame, Q31 of the unit: 1.375 times what the limit allows, since waves cut
/// off in an octave leave overshoots. Where two segments fade it grows by 1.38, to below 2^30.
const LARGEST: i32 = 11 << 26;

impl Mix {
    /// Prepares a tick: rises at the limits `column` and `column + 1`, with the weights of both at
    /// the tick's ends. One unit of the result is a rise by `unit`.
    pub(super) fn new(surface: &Surface<'_>, column: usize, weights: [[f32; 2]; 2], unit: f32) -> Self {
        let slope = |column: usize| surface.slope_unit().get(column).copied().unwrap_or(0.0);
        let scaled = |which: usize| {
            let scale = slope(column + which) * (1.0 / (ONE as f32 * unit));
            weights.get(which).copied().unwrap_or([0.0; 2]).map(|weight| weight * scale)
        };
        let (first, second) = (scaled(0), scaled(1));
        // Both with the fewer bits of the two.
        let most = Normal::new(first, 90).bits.min(Normal::new(second, 90).bits);
        let weights = [first, second].map(|numbers| Ramp::new(Normal::new(numbers, most).values));
        // The high word has `most - 32` bits.
        let shift = 31 - (most - 32);
        Self {
            weights,
            largest: LARGEST >> shift.clamp(0, 30),
            left: shift.clamp(0, 30) as u32,
            right: (-shift).clamp(0, 31) as u32,
        }
    }
}
