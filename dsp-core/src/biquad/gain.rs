//! A gain with an exponent of its own, from which multipliers of any scale are made.

/// A gain as `mantissa · 2^(exponent - 31)` with a normalised mantissa.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub(super) struct Gain {
    mantissa: i32,
    exponent: i32,
}

impl Gain {
    pub(super) const ZERO: Self = Self { mantissa: 0, exponent: -1000 };

    pub(super) fn new(value: f64) -> Self {
        let (fraction, exponent) = libm::frexp(value);
        match value == 0.0 {
            true => Self::ZERO,
            false => Self { mantissa: libm::rint(fraction * 2_147_483_648.0) as i32, exponent },
        }
    }

    /// Exponent of a power of two that is larger than the gain.
    pub(super) fn exponent(self) -> i32 {
        self.exponent
    }

    /// Multiplies a word by the gain, to the nearest; the product is below 2^62.
    pub(super) fn times(self, word: i32) -> i64 {
        let right = (31 - self.exponent).clamp(1, 63);
        (i64::from(self.mantissa) * i64::from(word) + (1 << (right - 1))) >> right
    }

    /// Gives the multiplier `gain · 2^shift` as Q32; the caller must keep it below 1/2.
    pub(super) fn q32(self, shift: i32) -> i32 {
        crate::fixed::rounding_shift_right(self.mantissa, (-1 - shift - self.exponent).clamp(0, 40) as u32)
    }
}
