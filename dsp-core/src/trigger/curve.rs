//! From a peak to a velocity.

use super::FULL_COUNTS;

/// `velocity = (peak / full_scale)^exponent`, at most 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Curve {
    per_unit: f32,
    exponent: f32,
}

impl Curve {
    /// The curve of a pad: `full_scale` is the peak of velocity 1 as a fraction of half the ADC's range.
    pub fn new(full_scale: f32, exponent: f32) -> Self {
        Self { per_unit: 1.0 / (full_scale * FULL_COUNTS), exponent }
    }

    /// The velocity of a peak in counts, 0 to 1. A peak at the ADC's rail is velocity 1: how much louder it was, nobody knows.
    ///
    /// Cost: a division's worth for exponent 1, else a soft-float power (about a thousand cycles, once a strike).
    pub fn velocity(&self, peak_counts: f32, saturated: bool) -> f32 {
        if saturated {
            return 1.0;
        }
        let linear = (peak_counts * self.per_unit).clamp(0.0, 1.0);
        if self.exponent == 1.0 { linear } else { libm::powf(linear, self.exponent).clamp(0.0, 1.0) }
    }
}
