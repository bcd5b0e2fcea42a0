//! High-word multiplies: `(acc·2^32 ± a·b) / 2^32`, truncated or rounded to nearest (half up).
//!
//! Each function is the instruction of the same name (ARMv7-M Architecture Reference Manual, DSP
//! extension), bit for bit, and takes one cycle on a Cortex-M4. The sum is formed in 64 bits and
//! wraps there, as on the chip. The caller must keep it from wrapping; [`crate::resonator`] proves
//! it for its states.

const HALF: i64 = 1 << 31;

const fn product(a: i32, b: i32) -> i64 {
    // Two 32-bit factors always fit 64 bits.
    (a as i64) * (b as i64)
}

const fn high_half(acc: i32) -> i64 {
    (acc as i64) << 32
}

/// `a·b / 2^32`, rounded down.
///
/// ```
/// assert_eq!(dsp_core::fixed::smmul(1 << 30, -3), -1);
/// ```
#[inline(always)]
pub const fn smmul(a: i32, b: i32) -> i32 {
    (product(a, b) >> 32) as i32
}

/// `a·b / 2^32`, rounded to nearest, half up.
#[inline(always)]
pub const fn smmulr(a: i32, b: i32) -> i32 {
    (product(a, b).wrapping_add(HALF) >> 32) as i32
}

/// `acc + a·b / 2^32`, rounded down.
#[inline(always)]
pub const fn smmla(acc: i32, a: i32, b: i32) -> i32 {
    (high_half(acc).wrapping_add(product(a, b)) >> 32) as i32
}

/// `acc + a·b / 2^32`, rounded to nearest, half up.
///
/// ```
/// // A Q32 coefficient of 0.25 adds a quarter of the factor.
/// assert_eq!(dsp_core::fixed::smmlar(1000, 1 << 30, 400), 1100);
/// ```
#[inline(always)]
pub const fn smmlar(acc: i32, a: i32, b: i32) -> i32 {
    (high_half(acc).wrapping_add(product(a, b)).wrapping_add(HALF) >> 32) as i32
}

/// `acc - a·b / 2^32`, rounded down.
#[inline(always)]
pub const fn smmls(acc: i32, a: i32, b: i32) -> i32 {
    (high_half(acc).wrapping_sub(product(a, b)) >> 32) as i32
}

/// `acc - a·b / 2^32`, rounded to nearest, half up.
#[inline(always)]
pub const fn smmlsr(acc: i32, a: i32, b: i32) -> i32 {
    (high_half(acc).wrapping_sub(product(a, b)).wrapping_add(HALF) >> 32) as i32
}

/// `x` times a gain from 0 to below 1 as Q31, rounded to an even step.
///
/// The result is never larger than x; a single step becomes 0.
#[inline(always)]
pub const fn times_q31(x: i32, gain: i32) -> i32 {
    // At most 2^30 in size before the shift.
    smmulr(x, gain) << 1
}

/// `value / 2^shift`, rounded to nearest, half up; any shift of 32 or more gives 0.
#[inline(always)]
pub const fn rounding_shift_right(value: i32, shift: u32) -> i32 {
    match shift {
        0 => value,
        // Floor plus the bit below it: never more than 2^30, so that nothing wraps.
        1..=31 => (value >> shift) + ((value >> (shift - 1)) & 1),
        _ => 0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// The manual's pseudocode on 128 bits: exact, then wrapped to the 64 bits of the accumulator.
    fn exact(acc: i32, a: i32, b: i32, sign: i128, round: bool) -> i32 {
        let sum = (i128::from(acc) << 32) + sign * i128::from(a) * i128::from(b) + if round { 0x8000_0000 } else { 0 };
        ((sum as i64) >> 32) as i32
    }

    proptest! {
        #[test]
        fn every_operation_follows_the_manual_for_every_input(acc: i32, a: i32, b: i32) {
            prop_assert_eq!(smmul(a, b), exact(0, a, b, 1, false));
            prop_assert_eq!(smmulr(a, b), exact(0, a, b, 1, true));
            prop_assert_eq!(smmla(acc, a, b), exact(acc, a, b, 1, false));
            prop_assert_eq!(smmlar(acc, a, b), exact(acc, a, b, 1, true));
            prop_assert_eq!(smmls(acc, a, b), exact(acc, a, b, -1, false));
            prop_assert_eq!(smmlsr(acc, a, b), exact(acc, a, b, -1, true));
        }

        #[test]
        fn a_rounding_shift_is_the_nearest_integer(value: i32, shift in 0u32..40) {
            let exact = (f64::from(value) / 2f64.powi(shift as i32) + 0.5).floor();
            prop_assert_eq!(f64::from(rounding_shift_right(value, shift)), exact);
        }
    }

    #[test]
    fn the_extremes_wrap_as_the_chip_does() {
        assert_eq!(smmul(i32::MIN, i32::MIN), 1 << 30);
        assert_eq!(smmlar(i32::MAX, i32::MIN, i32::MIN), i32::MAX.wrapping_add(1 << 30));
        assert_eq!(smmlsr(i32::MIN, i32::MIN, i32::MIN), i32::MIN.wrapping_sub(1 << 30));
    }

    #[test]
    fn a_zero_factor_leaves_the_accumulator_alone() {
        for acc in [i32::MIN, -1, 0, 1, i32::MAX] {
            assert_eq!(smmlar(acc, 0, 12345), acc);
            assert_eq!(smmlsr(acc, 12345, 0), acc);
        }
    }
}
