//! The hot loops of a slow contact: the curvature, its limit, and the smoothing.

#[cfg(cortex_m4f)]
mod cortex_m4;
pub(super) mod map;
#[cfg(not(cortex_m4f))]
mod portable;
pub(super) mod roll;
pub(super) mod slope;

use super::ramp::Ramp;

#[cfg(cortex_m4f)]
pub(super) use cortex_m4::{add_up, add_up_alone, filter, limit, limit_halves, read};
#[cfg(not(cortex_m4f))]
pub(super) use portable::{add_up, add_up_alone, filter, limit, limit_halves, read};

/// Taps come in whole steps of so many; the last ones may be 0.
pub(super) const TAPS: usize = 4;
/// Outputs that are computed at once.
const OUTPUTS: usize = 4;

/// Result of [`read`] where all coefficients of a spline are 1: its weights sum to 6, and a
/// factor of 8 keeps the third power of 1/2 whole.
pub(super) const ONE: i32 = 48 << 9;

/// Places of less than half a point between one and the next.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Course {
    /// Place before the first one, Q32 points of the table, from 0 to its end.
    pub(super) place: i64,
    /// Way to each place, Q32: it grows by the step before it is gone. It may wrap before the first
    /// step.
    pub(super) speed: i32,
    pub(super) step: i32,
}

/// Gains and slope of a tick.
#[derive(Clone, Debug)]
#[repr(C)]
pub(super) struct Adding {
    /// Slope S' of the path, with 32 bits more than its own.
    pub(super) slope: i64,
    /// From rises to the slope.
    pub(super) gain: i32,
    /// Share of the slope that is lost in a frame, Q32, with its sign.
    pub(super) less: i32,
    /// From rises, and from slopes, to the force before its shift.
    pub(super) vertical: Ramp,
    pub(super) horizontal: Ramp,
    /// Shift of the force to the right, 0 to 31, or to the left; one of them is 0.
    pub(super) right: u32,
    pub(super) left: u32,
}

/// Limits and rises of a tick.
#[derive(Clone, Debug)]
#[repr(C)]
pub(super) struct Limited {
    /// From the spline's value to the argument of tanh.
    pub(super) factor: Ramp,
    /// From tanh to the rise of a frame, Q32 of its unit: at most a quarter.
    pub(super) rise: Ramp,
    /// Mean rise, which is left out, Q31, with its sign turned.
    pub(super) less: i32,
}
