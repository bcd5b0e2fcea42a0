//! Saturating arithmetic: the bus clips, it never wraps.

use super::format::FULL_SCALE_24_BIT;
use super::high_word::rounding_shift_right;

/// `a + b`, saturated to 32 bits (QADD, one cycle).
#[inline(always)]
pub const fn qadd(a: i32, b: i32) -> i32 {
    a.saturating_add(b)
}

/// `a - b`, saturated to 32 bits (QSUB, one cycle).
#[inline(always)]
pub const fn qsub(a: i32, b: i32) -> i32 {
    a.saturating_sub(b)
}

/// A 64-bit sum, saturated to 32 bits.
#[inline(always)]
pub const fn saturate(wide: i64) -> i32 {
    if wide > i32::MAX as i64 {
        i32::MAX
    } else if wide < i32::MIN as i64 {
        i32::MIN
    } else {
        wide as i32
    }
}

/// Sum of the magnitudes of samples.
pub fn sum_of_magnitudes(samples: &[i32]) -> u64 {
    samples.iter().fold(0, |sum, x| sum + u64::from(x.unsigned_abs()))
}

/// `value · 2^shift`, saturated to 32 bits. Shifts of 32 and more saturate any value but 0.
#[inline(always)]
pub const fn saturating_shift_left(value: i32, shift: u32) -> i32 {
    let shift = if shift > 31 { 31 } else { shift };
    let shifted = value << shift;
    // A value that does not come back was too large. By a shift of 31 only 0 and -1 come back.
    if shifted >> shift == value { shifted } else { (value >> 31) ^ i32::MAX }
}

/// A bus sample (Q4.27) as a signed 24-bit sample: nearest, half up, clipped to ±full scale.
///
/// The one saturating step at the very end of the signal flow.
///
/// ```
/// use dsp_core::fixed::{ONE_Q27, to_24_bit};
/// assert_eq!(to_24_bit(ONE_Q27 / 2), 1 << 22);
/// assert_eq!(to_24_bit(ONE_Q27 * 4), (1 << 23) - 1);
/// ```
#[inline(always)]
pub const fn to_24_bit(bus: i32) -> i32 {
    let rounded = rounding_shift_right(bus, 4);
    // Written so that it becomes one SSAT.
    let clipped = if rounded < -FULL_SCALE_24_BIT { -FULL_SCALE_24_BIT } else { rounded };
    if clipped > FULL_SCALE_24_BIT - 1 { FULL_SCALE_24_BIT - 1 } else { clipped }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn a_saturating_shift_is_the_exact_product_clipped(value: i32, shift in 0u32..50) {
            let exact = (i128::from(value) << shift.min(60)).clamp(i128::from(i32::MIN), i128::from(i32::MAX));
            prop_assert_eq!(i128::from(saturating_shift_left(value, shift)), exact);
        }

        #[test]
        fn the_output_step_is_monotonic_and_within_half_a_step(a: i32) {
            let out = to_24_bit(a);
            prop_assert!((-(1 << 23)..(1 << 23)).contains(&out));
            if (-(1i64 << 27)..(1i64 << 27) - 16).contains(&i64::from(a)) {
                prop_assert!((i64::from(out) * 16 - i64::from(a)).abs() <= 8);
            }
        }
    }
}
