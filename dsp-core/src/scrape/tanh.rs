//! Hyperbolic tangent in fixed point: the limit of the path's curvature (scraping-rolling eq. 4).

#[cfg(not(cortex_m4f))]
use crate::fixed;

/// Fraction bits of the argument.
pub(super) const ARGUMENT_BITS: u32 = 19;

/// Number of pieces from 0 to 8, each an eighth wide.
const PIECES: usize = 64;
/// Bits of the argument within a piece.
#[cfg(not(cortex_m4f))]
const WITHIN_BITS: u32 = ARGUMENT_BITS - 3;

/// Hyperbolic tangent as Q31 of an argument in Q19. The error is at most 2.6e-6; beyond ±8 the
/// value stays.
///
/// Each piece is the cubic that has the function's values and slopes at its ends. The kernels of
/// the Cortex-M4 have the same steps within their loops.
#[cfg(not(cortex_m4f))]
#[inline(always)]
pub(super) fn tanh(argument: i32) -> i32 {
    let sign = argument >> 31;
    let size = ((argument ^ sign) - sign).min(LARGEST);
    let terms = &PIECE_TERMS[(size >> WITHIN_BITS) as usize % PIECES];
    let t = (size & ((1 << WITHIN_BITS) - 1)) << (31 - WITHIN_BITS);
    let sum = fixed::smmlar(terms[2], terms[3], t);
    let sum = fixed::smmlar(terms[1], sum, t);
    let value = fixed::smmlar(terms[0], sum, t) << 3;
    (value ^ sign) - sign
}

/// Argument below 8 that stands for all beyond it.
#[cfg(not(cortex_m4f))]
const LARGEST: i32 = (8 << ARGUMENT_BITS) - 1;

/// Terms of 1, t, t² and t³ of each piece, Q28, Q29, Q30 and Q31, t from 0 to 1: each step of a
/// product's high word halves the sum.
pub(super) static PIECE_TERMS: [[i32; 4]; PIECES] = {
    let mut pieces = [[0; 4]; PIECES];
    let mut piece = 0;
    while piece < PIECES {
        let width = 8.0 / PIECES as f64;
        let (from, to) = (tanh_of(piece as f64 * width), tanh_of((piece + 1) as f64 * width));
        // Slopes over a piece: tanh' = 1 - tanh².
        let (begin, end) = (width * (1.0 - from * from), width * (1.0 - to * to));
        let rise = to - from;
        let (square, cube) = (3.0 * rise - 2.0 * begin - end, begin + end - 2.0 * rise);
        pieces[piece] = [q31(from / 8.0), q31(begin / 4.0), q31(square / 2.0), q31(cube)];
        piece += 1;
    }
    pieces
};

const fn q31(value: f64) -> i32 {
    let scaled = value * 2_147_483_648.0;
    (if scaled < 0.0 { scaled - 0.5 } else { scaled + 0.5 }) as i32
}

/// Hyperbolic tangent of a number from 0 to 8, to the last bits of `f64`.
const fn tanh_of(x: f64) -> f64 {
    // e^(-2x) by its series at x/64, squared six times.
    let y = -2.0 * x / 64.0;
    let (mut sum, mut term, mut n) = (1.0, 1.0, 1);
    while n < 24 {
        term *= y / n as f64;
        sum += term;
        n += 1;
    }
    let mut square = 0;
    while square < 6 {
        sum *= sum;
        square += 1;
    }
    (1.0 - sum) / (1.0 + sum)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tanh_is_exact_to_3e_6_and_odd() {
        let mut worst = 0.0_f64;
        for step in -40_000_i32..=40_000 {
            let argument = step * 200;
            let exact = (f64::from(argument) / f64::from(1 << ARGUMENT_BITS)).tanh();
            let value = f64::from(tanh(argument)) / 2_147_483_648.0;
            worst =
                worst.max((value - exact).abs() - 2.3e-7 * f64::from(u8::from(argument.abs() > 8 << ARGUMENT_BITS)));
            assert_eq!(tanh(-argument), -tanh(argument));
        }
        assert!(worst < 3e-6, "{worst:e}");
    }
}
