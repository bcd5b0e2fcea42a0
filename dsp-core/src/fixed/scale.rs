//! A real gain as a mantissa and a number of doublings.

use super::high_word::smmulr;

/// A real gain as a Q32 mantissa and a number of doublings.
///
/// It is applied as a high word and a shift: 2 cycles on a Cortex-M4 and a clip. A result is exact
/// to one step for gains below 1/2, and to two steps of the value times the gain for larger ones.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Scale {
    mantissa: i32,
    doublings: u32,
}

impl Scale {
    /// The gain 0.
    pub const ZERO: Self = Self { mantissa: 0, doublings: 0 };

    /// Gives the nearest scale to a real gain; NaN becomes 0, gains beyond ±2^28 are clipped to
    /// that.
    pub fn new(gain: f64) -> Self {
        const LARGEST: f64 = (1u32 << 28) as f64;
        let gain = if gain.is_nan() { 0.0 } else { gain.clamp(-LARGEST, LARGEST) };
        let doublings = (libm::frexp(gain).1 + 1).clamp(0, 30);
        // |gain| < 2^(doublings - 1): below 2^31, which rounding may reach and `as` saturates.
        Self { mantissa: libm::rint(libm::scalbn(gain, 32 - doublings)) as i32, doublings: doublings as u32 }
    }

    /// True for the gain 0, so that its stage can be skipped.
    pub const fn is_zero(self) -> bool {
        self.mantissa == 0
    }

    /// Number of bits by which [`Scale::undoubled`] is to be shifted left, at most 30.
    pub const fn doublings(self) -> u32 {
        self.doublings
    }

    /// `gain · value` before its doublings.
    #[inline(always)]
    pub const fn undoubled(self, value: i32) -> i32 {
        smmulr(self.mantissa, value)
    }

    /// `gain · value`, at most 2^60: for sums that are saturated once, at their end.
    #[inline(always)]
    pub const fn apply(self, value: i32) -> i64 {
        (self.undoubled(value) as i64) << self.doublings
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn a_scaled_value_is_the_product_within_two_steps_of_the_value(
            value: i32,
            log2 in -60.0f64..28.0,
            negative: bool,
        ) {
            let gain = if negative { -log2.exp2() } else { log2.exp2() };
            let exact = gain * f64::from(value);
            let got = Scale::new(gain).apply(value) as f64;
            // Rounding of the product, and of a mantissa of few bits.
            let error = 1.0f64.max(2.001 * gain.abs()) + exact.abs() * 1e-9;
            prop_assert!((got - exact).abs() <= error, "{gain} x {value}: {got}, not {exact}");
        }
    }

    #[test]
    fn unit_gain_passes_every_value_within_two_steps_and_zero_gives_silence() {
        for value in [i32::MIN, -1, 0, 1, 77, i32::MAX] {
            assert!((Scale::new(1.0).apply(value) - i64::from(value)).abs() <= 2);
            assert_eq!(Scale::ZERO.apply(value), 0);
        }
        assert!(Scale::new(f64::NAN).is_zero());
    }
}
