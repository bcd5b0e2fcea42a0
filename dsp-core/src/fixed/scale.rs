//! A real gain of any size as mantissa and exponent.

use super::saturate;

/// A gain `mantissa · 2^(exponent - 31)`: 31 bits of precision whatever its size, so that levels from -200 to +200 dB multiply equally well.
///
/// Applying it costs a 32 x 32 -> 64 multiply, a 64-bit shift and a clip (about 8 cycles on a Cortex-M4); the result is rounded to
/// nearest and saturated. Relative error of the gain at most 2^-31.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Scale {
    mantissa: i32,
    exponent: i32,
}

impl Scale {
    /// The gain 0: [`apply`](Self::apply) gives silence.
    pub const ZERO: Self = Self { mantissa: 0, exponent: 0 };

    /// The nearest [`Scale`] to a real gain; NaN and gains below 2^-200 become 0, gains above 2^200 the largest.
    pub fn new(gain: f64) -> Self {
        let (fraction, exponent) = libm::frexp(gain);
        if gain.is_nan() || fraction == 0.0 || exponent < -200 {
            return Self::ZERO;
        }
        // |fraction| < 1, and rounding may reach 2^31, which `as` saturates: an error of 2^-31.
        Self { mantissa: libm::rint(fraction * 2147483648.0) as i32, exponent: exponent.min(200) }
    }

    /// Whether this is the gain 0, so that its stage can be skipped.
    pub const fn is_zero(self) -> bool {
        self.mantissa == 0
    }

    /// `gain · value`, nearest, saturated to 32 bits.
    #[inline]
    pub const fn apply(self, value: i32) -> i32 {
        saturate(self.apply_wide(value))
    }

    /// `gain · value`, nearest, saturated to 62 bits: for sums that are saturated once, at their end.
    #[inline]
    pub const fn apply_wide(self, value: i32) -> i64 {
        const LARGEST: i64 = 1 << 61;
        let product = (self.mantissa as i64) * (value as i64);
        let right = 31 - self.exponent;
        match right {
            // |product| <= 2^62: the result is at most a half.
            63.. => 0,
            // Adding a half (at most 2^61) to |product| <= 2^62 cannot wrap.
            1..=62 => (product + (1i64 << (right - 1))) >> right,
            // Gains of 2^31 and more.
            _ => {
                let left = if right < -61 { 61 } else { -right as u32 };
                let limit = LARGEST >> left;
                let clipped = if product > limit {
                    limit
                } else if product < -limit {
                    -limit
                } else {
                    product
                };
                clipped << left
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn a_scaled_value_is_the_exact_product_rounded_and_clipped(value: i32, log2 in -60.0f64..60.0, negative: bool) {
            let gain = if negative { -log2.exp2() } else { log2.exp2() };
            let exact = (gain * f64::from(value)).clamp(f64::from(i32::MIN), f64::from(i32::MAX));
            let got = f64::from(Scale::new(gain).apply(value));
            prop_assert!((got - exact).abs() <= 0.5 + exact.abs() * 1e-9, "{gain} x {value}: {got}, not {exact}");
        }
    }

    #[test]
    fn unit_gain_passes_every_value_and_zero_gives_silence() {
        for value in [i32::MIN, -1, 0, 1, 77, i32::MAX] {
            assert_eq!(Scale::new(1.0).apply(value), value);
            assert_eq!(Scale::ZERO.apply(value), 0);
        }
        assert!(Scale::new(f64::NAN).is_zero());
    }
}
