//! Limited curvature, read from the surface frame by frame.

use super::kernel::Limited;
use super::ramp::{Ramp, fixed_from};
use super::tanh::ARGUMENT_BITS;

impl Limited {
    /// Prepares a tick with limits α in metres, and with the largest rise of a frame at its ends
    /// and the mean one, in units. `unit` is the curvature of one in a spline's value, 1/m.
    pub(super) fn new(unit: f32, alpha_m: [f32; 2], rise: [f32; 2], mean: f32) -> Self {
        // The product's high word has the argument's bits. A larger factor than 2^30 stands for
        // arguments of which all but the smallest are beyond the end of tanh.
        let factor = alpha_m.map(|alpha_m| fixed_from(alpha_m * unit, ARGUMENT_BITS as i32 + 32));
        Self {
            factor: Ramp::new(factor),
            rise: Ramp::new(rise.map(|rise| fixed_from(rise, 32))),
            less: fixed_from(-mean, 31),
        }
    }
}
