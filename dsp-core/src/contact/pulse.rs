//! The shapes of a contact: force over time, as a fraction of the peak.

use crate::fixed;

/// Bits of a pulse's fraction: 1.0 = 2^29.
pub const SHAPE_BITS: u32 = 29;

/// How the contact force rises and falls.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Pulse {
    /// Hertz half-sine, `sin(π t/τ)` for `0 <= t <= τ`: frictionless spheres in contact (diffimpact §3.2).
    #[default]
    HertzHalfSine,
    /// Gaussian, `exp(-6/τ² (t - t_i - τ/2)²)` (diffimpact eq. 2), cut where it is 100 dB down on either side; it begins there.
    Gaussian,
}

impl Pulse {
    /// Length of the pulse in contact times τ: 1, or `2 sqrt(ln(10^5)/6)` = 2.770 for the Gaussian.
    pub const fn length(self) -> f64 {
        match self {
            Self::HertzHalfSine => 1.0,
            Self::Gaussian => 2.770_430_227_115_183,
        }
    }

    /// Mean of the pulse over τ, relative to its peak: the impulse is `m τ` times this.
    pub const fn area(self) -> f64 {
        match self {
            Self::HertzHalfSine => core::f64::consts::FRAC_2_PI,
            // sqrt(π/6) erf(sqrt(ln(10^5))).
            Self::Gaussian => 0.723_600_097_971_158,
        }
    }

    /// The pulse in Q2.29 at a fraction of its length (2^32 = 1). Error at most 7e-9 of the peak. With its contact it costs
    /// [`crate::engine::Part::ContactFrame`].
    pub fn shape(self, fraction: u32) -> i32 {
        match self {
            Self::HertzHalfSine => half_sine(fraction),
            Self::Gaussian => gaussian(fraction),
        }
    }
}

#[inline(always)]
pub(super) fn half_sine(fraction: u32) -> i32 {
    cos_half_pi_sqrt(negated_square_from_middle(fraction))
}

#[inline(always)]
pub(super) fn gaussian(fraction: u32) -> i32 {
    gaussian_100_db(negated_square_from_middle(fraction))
}

/// Square of the distance from the middle, -1 to 1 as Q31: both shapes are functions of it. Q31, negated: -2^31 to 0.
///
/// Negated, because of a factor that it knows to be positive LLVM makes an unsigned product of four instructions instead of one SMMLSR.
#[inline(always)]
fn negated_square_from_middle(fraction: u32) -> i32 {
    let from_middle = (fraction ^ 0x8000_0000) as i32;
    let square = ((i64::from(from_middle) * i64::from(from_middle)) >> 31) as u32;
    square.wrapping_neg() as i32
}

/// Horner's scheme in Q29 on a Q31 argument z in 0 to 1, given as -z, one SMMLSR a term: as a high word z counts half, for which the
/// coefficients make up ([`terms`]). The partial sums of both series below stay within ±4 (Q29: ±2^31), since their terms alternate and fall.
#[inline(always)]
fn polynomial<const N: usize>(minus_z: i32, terms: &[i32; N]) -> i32 {
    terms.iter().fold(0, |sum, &term| fixed::smmlsr(term, sum, minus_z))
}

/// Coefficients of z^k, highest first, as Q29 of `c 2^k`.
const fn terms<const N: usize>(coefficients: [f64; N]) -> [i32; N] {
    let mut terms = [0; N];
    let mut index = 0;
    while index < N {
        let scaled = coefficients[index] * (1u64 << (SHAPE_BITS as usize + N - 1 - index)) as f64;
        terms[index] = (if scaled < 0.0 { scaled - 0.5 } else { scaled + 0.5 }) as i32;
        index += 1;
    }
    terms
}

/// `cos(π/2 · sqrt(z))`, z in 0 to 1 as Q31, given as -z: the Taylor series of the cosine, seven terms of (π/2)^2k / (2k)!.
#[inline(always)]
fn cos_half_pi_sqrt(minus_z: i32) -> i32 {
    const TERMS: [i32; 8] = terms([
        -6.386_603_083_791_84e-9,
        4.710_874_778_818_17e-7,
        -2.520_204_237_306_06e-5,
        9.192_602_748_394_26e-4,
        -2.086_348_076_335_30e-2,
        2.536_695_079_010_48e-1,
        -1.233_700_550_136_17,
        1.0,
    ]);
    // Written out: built for size, a loop would load its terms and count them.
    let next = |sum: i32, term: i32| fixed::smmlsr(term, sum, minus_z);
    let [t7, t6, t5, t4, t3, t2, t1, t0] = TERMS;
    next(next(next(next(next(next(next(t7, t6), t5), t4), t3), t2), t1), t0).max(0)
}

/// `10^(-5 z)`, z in 0 to 1 as Q31, given as -z, as a power of two: integer part by shift, fraction by the Taylor series of `2^-f`.
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

#[cfg(test)]
mod tests {
    use super::*;

    fn worst(pulse: Pulse, exact: impl Fn(f64) -> f64) -> f64 {
        (0..=1_000_000u64)
            .map(|step| {
                let fraction = (step * u64::from(u32::MAX) / 1_000_000) as u32;
                let got = f64::from(pulse.shape(fraction)) / f64::from(1 << SHAPE_BITS);
                (got - exact(f64::from(fraction) / 2f64.powi(32))).abs()
            })
            .fold(0.0, f64::max)
    }

    #[test]
    fn both_shapes_follow_their_law_to_7e_9_of_the_peak() {
        let half_sine = worst(Pulse::HertzHalfSine, |x| (core::f64::consts::PI * x).sin());
        let gaussian = worst(Pulse::Gaussian, |x| (-1e5f64.ln() * (2.0 * x - 1.0).powi(2)).exp());
        assert!(half_sine < 7e-9 && gaussian < 7e-9, "{half_sine} {gaussian}");
    }

    #[test]
    fn lengths_and_areas_are_those_of_the_laws() {
        assert!((Pulse::Gaussian.length() - 2.0 * (1e5f64.ln() / 6.0).sqrt()).abs() < 1e-12);
        for pulse in [Pulse::HertzHalfSine, Pulse::Gaussian] {
            let sum: f64 = (0..100_000u32).map(|step| f64::from(pulse.shape(step.wrapping_mul(42_950)))).sum::<f64>();
            let area = sum / 100_000.0 / f64::from(1 << SHAPE_BITS) * pulse.length();
            assert!((area - pulse.area()).abs() < 1e-4, "{pulse:?}: {area}");
        }
    }
}
