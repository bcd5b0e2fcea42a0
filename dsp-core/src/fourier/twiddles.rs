//! Sines of the transform, computed by the compiler.

/// Complex number: real, imaginary.
pub(crate) type Complex = [f32; 2];

/// Product of two complex numbers.
#[inline(always)]
pub(super) fn times(x: Complex, w: Complex) -> Complex {
    [x[0] * w[0] - x[1] * w[1], x[0] * w[1] + x[1] * w[0]]
}

/// Largest number of points M of a complex transform; a wave has twice as many samples.
pub(crate) const MAX_POINTS: usize = 512;
/// Divisor of a turn: angles in the tables are multiples of that part.
pub(crate) const TURN: usize = 2 * MAX_POINTS;

/// `e^{2πi k/1024}` for half a turn.
pub(crate) static TWIDDLES: [Complex; TURN / 2] = {
    let mut table = [[0.0; 2]; TURN / 2];
    let mut index = 0;
    while index < table.len() {
        table[index] = twiddle(index);
        index += 1;
    }
    table
};

/// Factors w, w² and w³ of a radix-4 butterfly, in the order in which a block uses them.
pub(crate) type Factors = [Complex; 3];
pub(crate) static FACTORS_256: [Factors; 64] = factors();
pub(crate) static FACTORS_64: [Factors; 16] = factors();
pub(crate) static FACTORS_16: [Factors; 4] = factors();
/// Factors of radix-2 blocks.
pub(crate) static FACTORS_512: [Complex; 256] = single_factors();
pub(crate) static FACTORS_128: [Complex; 64] = single_factors();

const fn single_factors<const HALF: usize>() -> [Complex; HALF] {
    let mut table = [[0.0; 2]; HALF];
    let mut index = 0;
    while index < HALF {
        table[index] = twiddle(index * (TURN / (2 * HALF)));
        index += 1;
    }
    table
}

const fn factors<const QUARTER: usize>() -> [Factors; QUARTER] {
    let mut table = [[[0.0; 2]; 3]; QUARTER];
    let mut index = 0;
    while index < QUARTER {
        let angle = index * (TURN / (4 * QUARTER));
        table[index] = [twiddle(angle), twiddle(2 * angle), twiddle(3 * angle)];
        index += 1;
    }
    table
}

const fn twiddle(index: usize) -> Complex {
    [cosine(index) as f32, cosine(index + 3 * TURN / 4) as f32]
}

/// `cos(2π k/1024)`.
pub(crate) const fn cosine(index: usize) -> f64 {
    let index = index % TURN;
    let quarter = TURN / 4;
    let within = (index % quarter) as f64 / quarter as f64;
    match index / quarter {
        0 => quarter_sine(1.0 - within),
        1 => -quarter_sine(within),
        2 => -quarter_sine(1.0 - within),
        _ => quarter_sine(within),
    }
}

/// `sin(π/2 x)` for x from 0 to 1: its Taylor series to x^23, error below 1e-16.
pub(crate) const fn quarter_sine(x: f64) -> f64 {
    let angle = x * core::f64::consts::FRAC_PI_2;
    let (mut term, mut sum, mut n) = (angle, angle, 1.0);
    while n < 22.0 {
        term *= -angle * angle / ((n + 1.0) * (n + 2.0));
        sum += term;
        n += 2.0;
    }
    sum
}
