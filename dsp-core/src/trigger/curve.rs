//! The velocity curve: from a peak to a velocity.

use super::units::FULL_COUNTS;
use crate::fixed;

/// Velocity curve `velocity = (peak / full_scale)^exponent`, at most 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Curve {
    per_unit: f32,
    exponent: f32,
}

impl Curve {
    /// Makes the curve of a pad. `full_scale` is the peak of a strike of velocity 1, as a fraction
    /// of half the ADC's range.
    pub fn new(full_scale: f32, exponent: f32) -> Self {
        Self { per_unit: 1.0 / (full_scale * FULL_COUNTS), exponent }
    }

    /// Velocity of a peak in counts, 0 to 1. A saturated peak, at the ADC's rail, has velocity 1,
    /// since its true height is unknown.
    ///
    /// The power is computed in integers, once a strike ([`fixed::power`]).
    pub fn velocity(&self, peak_counts: f32, saturated: bool) -> f32 {
        if saturated {
            return 1.0;
        }
        fixed::power(peak_counts * self.per_unit, self.exponent)
    }
}
