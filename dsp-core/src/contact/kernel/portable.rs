//! The loop of a Hertz pulse in Rust, with the bits of the assembly.

use super::super::shape::SHAPE_BITS;
use super::Turning;
use crate::fixed;

/// Adds a mean to each frame of a force and turns the angle.
pub(in super::super) fn add_means(force: &mut [i32], turning: &mut Turning) {
    let Turning { angle, rotation, means, peak } = turning;
    for force in force {
        // A mean is below 1: the product is smaller than the peak.
        let more = (i64::from(means.at(*angle)) * i64::from(*peak)) >> SHAPE_BITS;
        *force = fixed::qadd(*force, more as i32);
        *angle = angle.turned(*rotation);
    }
}
