//! Gains from products of 40 fraction bits to another number of bits.

use super::power::Power;

/// Fraction bits of the products for which a [`Gain`] is made.
const PRODUCT_BITS: i32 = 40;
/// Bits of a gain's mantissa.
const MANTISSA_BITS: i32 = 22;

/// Gain of a product of 40 fraction bits, exact to 3e-7.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Gain {
    mantissa: i64,
    /// Number of bits that the product with the mantissa has too many.
    right: u32,
}

impl Gain {
    /// Makes the gain `gain`, whose result has `bits` fraction bits. A gain too large for a 32-bit
    /// result of the smallest product is clamped, one too small is 0.
    pub(super) fn new(gain: f32, bits: i32) -> Self {
        let size = if gain > 0.0 { gain } else { 0.0 };
        let exponent = (size.to_bits() >> 23) as i32 - 127;
        let right = PRODUCT_BITS + MANTISSA_BITS - 1 - exponent - bits;
        if size == 0.0 || right > 62 {
            return Self::default();
        }
        let right = right.max(0);
        let mantissa = size * super::ramp::power_of_two(MANTISSA_BITS - 1 - exponent);
        Self { mantissa: (mantissa as i64).min((1 << MANTISSA_BITS) - 1), right: right as u32 }
    }

    /// Applies the gain to a power; the result is saturated.
    #[inline(always)]
    pub(super) fn apply_to(self, power: Power) -> i32 {
        // 2^31 · 2^22 < 2^63. A power has 30 bits and its halvings where a product has 40.
        let product = i64::from(power.mantissa) * self.mantissa;
        let right = self.right as i32 + power.halvings as i32 - (PRODUCT_BITS - 30);
        crate::fixed::saturate(if right < 0 { product << -right } else { product >> right.min(63) })
    }
}
