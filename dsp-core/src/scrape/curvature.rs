//! Limited curvature, read from the surface frame by frame.

use zerocopy::byteorder::little_endian::I16;

use super::ramp::{Ramp, fixed_from};
use super::spline;
use super::tanh::{ARGUMENT_BITS, tanh};
use super::walk::Walk;
use crate::fixed;
use crate::table::Surface;

/// Limits and rises of a tick.
#[derive(Clone, Debug)]
pub(super) struct Limited {
    /// From the spline's value to the argument of tanh.
    factor: Ramp,
    /// From tanh to the rise of a frame, Q32 of its unit: at most a quarter.
    rise: Ramp,
    /// Mean rise, which is left out, Q31.
    mean: i32,
}

impl Limited {
    /// Prepares a tick with limits α in metres, and with the largest rise of a frame at its ends
    /// and the mean one, in units.
    pub(super) fn new(surface: &Surface<'_>, alpha_m: [f32; 2], rise: [f32; 2], mean: f32) -> Self {
        let unit = surface.curvature_unit_per_m() * (1.0 / spline::ONE as f32);
        // The product's high word has the argument's bits. A larger factor than 2^30 stands for
        // arguments of which all but the smallest are beyond the end of tanh.
        let factor = alpha_m.map(|alpha_m| fixed_from(alpha_m * unit, ARGUMENT_BITS as i32 + 32));
        Self {
            factor: Ramp::new(factor),
            rise: Ramp::new(rise.map(|rise| fixed_from(rise, 32))),
            mean: fixed_from(mean, 31),
        }
    }

    /// Rises of the next frames, Q31 of the unit, where the walk goes.
    pub(super) fn render(&mut self, surface: &Surface<'_>, walk: &Walk, rises: &mut [i32]) {
        read(surface.curvature(), walk, rises);
        self.limit(rises);
    }

    #[inline(never)]
    fn limit(&mut self, rises: &mut [i32]) {
        let Self { mut factor, mut rise, mean } = *self;
        for out in rises {
            let limited = tanh(fixed::smmulr(*out, factor.next()));
            *out = fixed::smmulr(limited, rise.next()) - mean;
        }
        (self.factor, self.rise) = (factor, rise);
    }
}

/// Values of a table's spline where a walk goes.
#[inline(never)]
fn read(table: &[I16], walk: &Walk, values: &mut [i32]) {
    for (value, &(point, fraction)) in values.iter_mut().zip(&walk.points) {
        let four = table.get(point as usize..).and_then(<[_]>::first_chunk::<4>);
        *value = four.map_or(0, |c| spline::value(c.map(|c| i32::from(c.get())), fraction));
    }
}
