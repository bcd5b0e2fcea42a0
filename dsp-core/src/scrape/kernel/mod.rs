//! The hot loops of a slow contact: the curvature, its limit, and the smoothing.

#[cfg(cortex_m4f)]
mod cortex_m4;
#[cfg(not(cortex_m4f))]
mod portable;

use super::ramp::Ramp;

#[cfg(cortex_m4f)]
pub(super) use cortex_m4::{filter, limit, read};
#[cfg(not(cortex_m4f))]
pub(super) use portable::{filter, limit, read};

/// Taps come in whole steps of so many; the last ones may be 0.
pub(super) const TAPS: usize = 4;
/// Outputs that are computed at once.
const OUTPUTS: usize = 4;

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
