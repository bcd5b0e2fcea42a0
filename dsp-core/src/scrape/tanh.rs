//! Hyperbolic tangent in fixed point: the limit of the path's curvature (scraping-rolling eq. 4).

/// Fraction bits of the argument.
pub(super) const ARGUMENT_BITS: u32 = 19;

/// Number of pieces from -8 to 8, each 1/32 wide.
pub(super) const PIECES: usize = 512;
/// Bits of the argument within a piece.
pub(super) const WITHIN_BITS: u32 = ARGUMENT_BITS - 5;

/// Hyperbolic tangent as Q31 of an argument in Q19. The error is at most 2.5e-6; beyond ±8 the
/// value stays.
///
/// Each piece is a parabola over the argument's low 16 bits with their sign, which count from the
/// nearest eighth. The kernels of the Cortex-M4 have the same steps within their loops.
#[cfg(not(cortex_m4f))]
#[inline(always)]
pub(super) fn tanh(argument: i32) -> i32 {
    const HALF: i32 = PIECES as i32 / 2;
    let piece = (argument >> WITHIN_BITS).clamp(-HALF, HALF - 1) + HALF;
    let Piece { value, slope } = PIECE_TERMS[piece as usize % PIECES];
    let within = i32::from(argument as i16);
    let slope = slope + i32::from(slope as i16) * within;
    value + ((i64::from(slope) * i64::from(within)) >> 16) as i32
}

/// Parabola over the low 16 bits of an argument.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub(super) struct Piece {
    /// Value at 0, Q31.
    value: i32,
    /// Slope at 0, Q31 over 2^16, as a multiple of 2^16; in its low half, with a sign, the growth
    /// of the slope for each step of the argument.
    slope: i32,
}

/// All pieces, from -8 on.
pub(super) static PIECE_TERMS: [Piece; PIECES] = {
    let mut pieces = [Piece { value: 0, slope: 0 }; PIECES];
    let mut piece = 0;
    while piece < PIECES / 2 {
        // tanh is odd: pieces on both sides of 0 mirror each other.
        pieces[PIECES / 2 + piece] = piece_from(piece, 1.0);
        let Piece { value, slope } = piece_from(piece, -1.0);
        pieces[PIECES / 2 - 1 - piece] = Piece { value: -value, slope: slope - 2 * (slope as i16 as i32) };
        piece += 1;
    }
    pieces
};

/// Piece so many pieces above 0; the sign is -1 for one that will be mirrored.
const fn piece_from(piece: usize, sign: f64) -> Piece {
    const WIDTH: f64 = 1.0 / 32.0;
    // The last one stands for all beyond it.
    if piece == PIECES / 2 - 1 {
        return Piece { value: (tanh_of(8.0) * 2_147_483_648.0) as i32, slope: 0 };
    }
    // Within counts from the nearest eighth, in eighths.
    let nearest = (piece + 2) / 4;
    let middle = (piece as f64 + 0.5) * WIDTH * 8.0 - nearest as f64;
    // The parabola through the middle and two places 0.866 of the way to the ends.
    let apart = 0.866_025_403_784 * 0.5 * WIDTH * 8.0;
    let low = tanh_of((nearest as f64 + middle - apart) / 8.0) * 32_768.0;
    let centre = tanh_of((nearest as f64 + middle) / 8.0) * 32_768.0;
    let high = tanh_of((nearest as f64 + middle + apart) / 8.0) * 32_768.0;
    let growth = rounded((high - 2.0 * centre + low) / (2.0 * apart * apart));
    // What rounding has left is taken up by the slope, and then by the value.
    let slope = rounded((high - low) / (2.0 * apart) - 2.0 * growth as f64 * middle);
    // The growth stands below the slope as well, as a 65536th of it.
    let below = slope as f64 + sign * growth as f64 / 65_536.0;
    let (at_middle, square) = ((below + growth as f64 * middle) * middle, growth as f64 * apart * apart);
    let rest = 0.25 * (low + high + 2.0 * centre) - at_middle - 0.5 * square;
    Piece { value: rounded(rest * 65_536.0), slope: (slope << 16) + growth }
}

const fn rounded(scaled: f64) -> i32 {
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
            let argument = step * 200 + 1;
            let exact = (f64::from(argument) / f64::from(1 << ARGUMENT_BITS)).tanh();
            let error = f64::from(tanh(argument)) / 2_147_483_648.0 - exact;
            let beyond = 2.3e-7 * f64::from(u8::from(argument.abs() > 8 << ARGUMENT_BITS));
            worst = worst.max(error.abs() - beyond);
            // Products are rounded down, and a slope's growth stands below it with its sign.
            assert!((tanh(-argument) + tanh(argument)).abs() <= 64, "{argument}");
        }
        assert!(worst < 3e-6, "{worst:e}");
    }
}
