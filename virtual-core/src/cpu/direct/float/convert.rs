//! Conversions from and to integers, fixed point and halves (DDI 0403 A7.7, VCVT).

use rsemu::cpu::arm::v7m::fp;
use rsemu::float::Round;

use super::Direct;

/// Exponents and fractions of halves and singles, in bits and biases.
const HALF_EXPONENT_MAX: u32 = 0x1f;
const HALF_FRACTION_BITS: u32 = 10;
const SINGLE_FRACTION_BITS: u32 = 23;
const BIAS_DIFFERENCE: u32 = 127 - 15;

/// Returns 2 to the power of -32 to 32.
fn power_of_two(exponent: i32) -> f32 {
    f32::from_bits(((127 + exponent) as u32) << SINGLE_FRACTION_BITS)
}

/// Form of a fixed-point number in a register of the FPU.
#[derive(Clone, Copy)]
pub(super) struct FixedPoint {
    /// Number of bits, 16 or 32.
    pub(super) bits: u32,
    /// True if the number has no sign.
    pub(super) unsigned: bool,
    /// Number of bits behind the point.
    pub(super) fraction_bits: u8,
}

impl FixedPoint {
    /// Form of an integer of a word.
    pub(super) fn integer(signed: bool) -> FixedPoint {
        FixedPoint { bits: 32, unsigned: !signed, fraction_bits: 0 }
    }
}

impl Direct {
    /// Converts the single of register m to an integer in register d.
    ///
    /// The result is rounded as FPSCR says, or towards 0 if `rounds_to_zero`.
    #[inline]
    pub(super) fn convert_to_integer(&mut self, [d, m]: [u8; 2], signed: bool, rounds_to_zero: bool) -> Option<()> {
        if rounds_to_zero {
            return self.convert_to_fixed([d, m], FixedPoint::integer(signed));
        }
        let result = fp::to_fixed(self.floats.get(m), 32, !signed, 0, self.float_modes());
        self.floats.finish(d, result);
        Some(())
    }

    /// Converts the single of register m to a fixed-point number in register d, rounded towards 0.
    #[inline]
    pub(super) fn convert_to_fixed(&mut self, [d, m]: [u8; 2], form: FixedPoint) -> Option<()> {
        let FixedPoint { bits, unsigned, fraction_bits } = form;
        let single = self.floats.get(m);
        let scaled = f64::from(f32::from_bits(single)) * f64::from(power_of_two(i32::from(fraction_bits)));
        // Numbers beyond the range are clamped, and NaNs become 0. Neither is in a range.
        let whole = scaled as i64;
        let range = if unsigned { 0..1 << bits } else { -1 << (bits - 1)..1 << (bits - 1) };
        if self.floats.has_reset_modes() && range.contains(&whole) && !scaled.is_nan() {
            let result = whole as u64 & ((1 << bits) - 1);
            self.floats.set(d, result as u32);
            if whole as f64 != scaled {
                self.floats.status |= fp::fpscr::IXC;
            }
            return Some(());
        }
        let modes = self.float_modes().round(Round::TowardZero);
        self.floats.finish(d, fp::to_fixed(single, bits, unsigned, u32::from(fraction_bits), modes));
        Some(())
    }

    /// Converts a fixed-point number in register m to a single in register d.
    #[inline]
    pub(super) fn convert_from_fixed(&mut self, [d, m]: [u8; 2], form: FixedPoint) -> Option<()> {
        let FixedPoint { bits, unsigned, fraction_bits } = form;
        let fixed = self.floats.get(m);
        if self.floats.has_reset_modes() {
            let integer = match (bits, unsigned) {
                (32, true) => i64::from(fixed),
                (32, false) => i64::from(fixed.cast_signed()),
                (_, true) => i64::from(fixed as u16),
                (_, false) => i64::from(fixed as i16),
            };
            let rounded = integer as f32;
            // Scaling is exact: no result is a subnormal.
            let result = rounded * power_of_two(-i32::from(fraction_bits));
            self.floats.finish_rounded(d, result, rounded as i64 != integer);
            return Some(());
        }
        let result = fp::from_fixed(fixed, bits, unsigned, u32::from(fraction_bits), self.float_modes());
        self.floats.finish(d, result);
        Some(())
    }

    /// Converts the single of register m to a half in the upper half of register d if `top`, else
    /// in the lower one.
    pub(super) fn convert_to_half(&mut self, d: u8, m: u8, top: bool) -> Option<()> {
        let (half, flags) = fp::single_to_half(self.floats.get(m), self.float_modes());
        let (half, other) = (u32::from(half), self.floats.get(d));
        let bits = if top { other & 0xffff | half << 16 } else { other & 0xffff_0000 | half };
        self.floats.finish(d, (bits, flags));
        Some(())
    }

    /// Converts the half in the upper half of register m if `top`, else in the lower one, to a
    /// single in register d.
    #[inline]
    pub(super) fn convert_from_half(&mut self, d: u8, m: u8, top: bool) -> Option<()> {
        let half = (self.floats.get(m) >> if top { 16 } else { 0 }) as u16;
        let exponent = u32::from(half) >> HALF_FRACTION_BITS & HALF_EXPONENT_MAX;
        if (1..HALF_EXPONENT_MAX).contains(&exponent) {
            // The fraction goes to the upper bits, and the exponent changes its bias.
            let magnitude = (u32::from(half) & 0x7fff) << (SINGLE_FRACTION_BITS - HALF_FRACTION_BITS);
            let sign = (u32::from(half) & 0x8000) << 16;
            self.floats.set(d, sign | (magnitude + (BIAS_DIFFERENCE << SINGLE_FRACTION_BITS)));
        } else {
            self.floats.finish(d, fp::half_to_single(half, self.float_modes()));
        }
        Some(())
    }
}
