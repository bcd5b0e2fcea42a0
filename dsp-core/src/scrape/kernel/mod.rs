//! The hot loops of a slow contact: the curvature, its limit, and the smoothing.

#[cfg(cortex_m4f)]
mod cortex_m4;
#[cfg(not(cortex_m4f))]
mod portable;

use super::ramp::Ramp;
use crate::table::layout::CURVATURES;

#[cfg(cortex_m4f)]
pub(super) use cortex_m4::{filter, limit, read, read_map};
#[cfg(not(cortex_m4f))]
pub(super) use portable::{filter, limit, read, read_map};

/// Taps come in whole steps of so many; the last ones may be 0.
pub(super) const TAPS: usize = 4;
/// Outputs that are computed at once.
const OUTPUTS: usize = 4;

/// Weights of a map's curvatures over a tick, Q30: c², c s and s² in the direction (c, s).
pub(super) type Directions = [Ramp; CURVATURES];

/// Value that [`read_map`] gives for a curvature of 1 unit: 36 for the splines of both directions.
pub(super) const MAP_ONE: i32 = 36 << 9;

/// Begin of a column's sum in [`read_map`]: 2 for the shift by 2 bits, and 4 for what the products
/// lose, on average 2 in an axis's direction and 6 in others. Left out, it would be a slope of the
/// surface, and pile up in that of the path.
const MAP_ROUNDING: i32 = 6;

/// Limits and rises of a tick.
#[derive(Clone, Debug)]
#[repr(C)]
pub(super) struct Limited {
    /// From the spline's value to the argument of tanh.
    pub(super) factor: Ramp,
    /// From tanh to the rise of a frame, Q32 of its unit: at most a quarter.
    pub(super) rise: Ramp,
    /// Mean rise, which is left out, Q31.
    pub(super) mean: i32,
}
