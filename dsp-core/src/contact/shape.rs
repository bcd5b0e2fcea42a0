//! Shapes of a contact's force as polynomials in fixed point.

use crate::fixed;

/// Bits of a pulse's fraction: 1.0 = 2^29.
pub(super) const SHAPE_BITS: u32 = 29;

/// Largest value of a shape: 1.0 less a step, so that a product with any peak force fits.
pub(super) const MAX_SHAPE: i32 = (1 << SHAPE_BITS) - 1;

/// Gaussian in Q2.29 at a fraction of its length (2^32 = 1). The error is at most 7e-9 of the peak.
#[inline(always)]
pub(super) fn gaussian(fraction: u32) -> i32 {
    gaussian_100_db(negated_square((fraction ^ 0x8000_0000) as i32))
}

/// Negated square, Q31 from -2^31 to 0, of a distance from the middle, Q31 from -1 to 1.
///
/// It is negated because LLVM makes an unsigned product of a factor that it knows to be positive:
/// four instructions instead of one SMMLAR.
#[inline(always)]
pub(super) fn negated_square(from_middle: i32) -> i32 {
    let square = ((i64::from(from_middle) * i64::from(from_middle)) >> 31) as u32;
    square.wrapping_neg() as i32
}

/// Evaluates a polynomial in Q29 by Horner's scheme, for z in 0 to 1 as Q31, given as -z.
///
/// Each term takes one SMMLAR. As a high word z counts half, for which the coefficients make up
/// ([`terms`]). The series' terms alternate and fall, so that partial sums alternate too and stay
/// within ±4 (Q29: ±2^31). Their sizes are carried, all negated: `-|c| + (-|sum|)(-z)`. So no
/// factor is known to be positive and each product is one instruction. With sums of both signs
/// every other product took four (ContactFrame: 104 cycles).
#[inline(always)]
fn polynomial<const N: usize>(minus_z: i32, terms: &[i32; N]) -> i32 {
    terms.iter().fold(0, |sum, &term| fixed::smmlar(term, sum, minus_z)).wrapping_neg()
}

/// Negated sizes of the coefficients c of z^k, highest first, as Q29 of `c 2^k`.
const fn terms<const N: usize>(coefficients: [f64; N]) -> [i32; N] {
    let mut terms = [0; N];
    let mut index = 0;
    while index < N {
        let power = N - 1 - index;
        let scaled = coefficients[index] * (1u64 << (SHAPE_BITS as usize + power)) as f64;
        assert!((scaled < 0.0) == (power % 2 == 1), "the coefficients alternate, c_0 is positive");
        terms[index] = -((if scaled < 0.0 { -scaled } else { scaled }) + 0.5) as i32;
        index += 1;
    }
    terms
}

/// Value of `cos(π/2 · sqrt(z))` for z in 0 to 1 as Q31, given as -z.
///
/// The polynomial is the one of least error, 2.2e-10.
#[inline(always)]
pub(super) fn cos_half_pi_sqrt(minus_z: i32) -> i32 {
    const TERMS: [i32; 6] = terms([
        -2.382_491_851_567_09e-5,
        9.177_248_395_580_06e-4,
        -2.086_268_838_535_58e-2,
        2.536_693_227_714_05e-1,
        -1.233_700_534_307_09,
        0.999_999_999_780_652,
    ]);
    six(minus_z, TERMS).max(0)
}

/// Value of `sin(π/2 · sqrt(z)) / sqrt(z)`, π/2 to 1, for z in 0 to 1 as Q31, given as -z.
///
/// The polynomial is the one of least error, 2.7e-11.
#[inline(always)]
pub(super) fn sinc_half_pi_sqrt(minus_z: i32) -> i32 {
    const TERMS: [i32; 6] = terms([
        -3.431_869_602_853_96e-6,
        1.602_547_918_133_15e-4,
        -4.681_657_883_710_75e-3,
        7.969_260_374_861_20e-2,
        -6.459_640_955_820_08e-1,
        1.570_796_326_768_22,
    ]);
    six(minus_z, TERMS)
}

/// Evaluates [`polynomial`] of six terms without a loop.
///
/// Built for size, a loop would load its terms and count them.
#[inline(always)]
fn six(minus_z: i32, [t5, t4, t3, t2, t1, t0]: [i32; 6]) -> i32 {
    let next = |sum: i32, term: i32| fixed::smmlar(term, sum, minus_z);
    next(next(next(next(next(t5, t4), t3), t2), t1), t0).wrapping_neg()
}

/// Value of `10^(-5 z)` for z in 0 to 1 as Q31, given as -z.
///
/// It is a power of two: the integer part is a shift, the fraction the Taylor series of `2^-f`.
#[inline(always)]
fn gaussian_100_db(minus_z: i32) -> i32 {
    // 5 log2(10) in Q27, so that the product is Q58: the exponent has five integer bits.
    const SLOPE: i64 = (16.609_640_474_436_812 * (1u64 << 27) as f64 + 0.5) as i64;
    let exponent = -i64::from(minus_z) * SLOPE;
    let whole = (exponent >> 58) as u32;
    let fraction = ((exponent >> 27) & 0x7FFF_FFFF) as i32; // Q31
    // (-ln 2)^k / k!, k from 10 to 0.
    const TERMS: [i32; 11] = terms([
        7.054_911_620_801_12e-9,
        -1.017_808_600_923_97e-7,
        1.321_548_679_014_43e-6,
        -1.525_273_380_405_98e-5,
        1.540_353_039_338_16e-4,
        -1.333_355_814_642_84e-3,
        9.618_129_107_628_48e-3,
        -5.550_410_866_482_16e-2,
        2.402_265_069_591_01e-1,
        -core::f64::consts::LN_2,
        1.0,
    ]);
    fixed::rounding_shift_right(polynomial(-fraction, &TERMS), whole)
}
