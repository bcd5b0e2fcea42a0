//! Readings of the path's slope for fast contacts.
//!
//! The coefficients of two neighbouring limits are mixed to a strip, as far as the path of a block
//! goes. The rise of a frame is the difference of the strip's spline at both its ends.

#[cfg(cortex_m4f)]
mod cortex_m4;
#[cfg(not(cortex_m4f))]
mod portable;
mod rises;

use zerocopy::byteorder::little_endian::I16;

use super::super::path::Steps;
use crate::fixed;

#[cfg(cortex_m4f)]
pub(in super::super) use cortex_m4::{mix_row, read_strip};
#[cfg(not(cortex_m4f))]
pub(in super::super) use portable::{mix_row, read_strip};
pub(in super::super) use rises::read_rises;

/// Intervals of a strip, a power of two, and its coefficients.
const INTERVALS: usize = 32;
const STRIP: usize = INTERVALS + 4;
/// Coefficients of a strip come in whole steps of so many.
const STEP: usize = 4;

/// Mixed coefficients, each at most 2^24 in size.
pub(in super::super) type Strip = [i32; STRIP];

/// Octave of a table.
#[derive(Clone, Copy, Debug)]
pub(in super::super) struct Octave<'k> {
    /// Coefficients of all limits at each point, with their guard.
    pub(in super::super) table: &'k [I16],
    /// Number of points before the table goes on by its guard.
    pub(in super::super) points: usize,
    /// First of two neighbouring limits.
    pub(in super::super) column: usize,
}

/// Places in an octave; the way of each frame grows before it is gone.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub(in super::super) struct Strides {
    /// Place before the first one, Q32 points, from 0 to the table's end.
    pub(in super::super) place: Steps,
    /// Way of a frame.
    pub(in super::super) speed: Steps,
    /// Growth of the way, below half a point in size where it is read from a strip.
    pub(in super::super) step: Steps,
}

/// Mix of the rises at two limits.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub(in super::super) struct Mix {
    /// Weights of both, at most 2^24 in size.
    pub(in super::super) weights: [i32; 2],
    /// Largest rise before the shift.
    pub(in super::super) largest: i32,
    /// Shift of the rise to the left, 0 to 30.
    pub(in super::super) left: u32,
}

/// Value of a strip's spline for a coefficient of 1 everywhere.
pub(in super::super) const ONE: i32 = 48;
/// Bits that the product of weight and table has more than a coefficient of a strip.
pub(in super::super) const MIXED_BITS: i32 = 16;

/// Coefficient from those of two limits.
#[inline(always)]
fn mixed(at: &[I16], [first, second]: [i32; 2]) -> i32 {
    let Some([a, b]) = at.first_chunk().map(|pair: &[I16; 2]| pair.map(|c| i64::from(c.get()))) else { return 0 };
    // Each product is at most 2^23 in size.
    ((i64::from(first) * a) >> MIXED_BITS) as i32 + ((i64::from(second) * b) >> MIXED_BITS) as i32
}

/// Way of a place from the middle of its interval, Q32.
#[inline(always)]
const fn middle(place: Steps) -> i32 {
    (place as u32 ^ (1 << 31)) as i32
}

/// Value of a spline at a way from the interval's middle, -1/2 to 1/2. All sums with the way are
/// below 112 times 2^24, which is below 2^31.
#[inline(always)]
const fn value([a, b, c, d]: [i32; 4], within: i32) -> i32 {
    let (inner, outer, rise, far) = (b + c, a + d, c - b, d - a);
    let sum = fixed::smmlar(12 * (outer - inner), 8 * (far - 3 * rise), within);
    let sum = fixed::smmlar(6 * (far + 5 * rise), sum, within);
    fixed::smmlar(outer + 23 * inner, sum, within)
}

impl Mix {
    /// Rise from the difference of the values at a frame's ends, each at most 48 times 2^24.
    #[inline(always)]
    fn rise(&self, difference: i32) -> i32 {
        difference.min(self.largest).max(-self.largest) << self.left
    }
}
