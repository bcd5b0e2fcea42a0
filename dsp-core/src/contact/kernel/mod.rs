//! The hot loop of a Hertz pulse: means of its intervals, along an angle that turns.

#[cfg(cortex_m4f)]
mod cortex_m4;
#[cfg(not(cortex_m4f))]
mod portable;

use super::angle::{Angle, Rotation};
use super::pulse::Means;

#[cfg(cortex_m4f)]
pub(super) use cortex_m4::add_means;
#[cfg(not(cortex_m4f))]
pub(super) use portable::add_means;

/// Values that the loop reads, and the angle that it turns.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub(super) struct Turning {
    pub(super) angle: Angle,
    pub(super) rotation: Rotation,
    pub(super) means: Means,
    /// Peak force, Q4.27.
    pub(super) peak: i32,
}
