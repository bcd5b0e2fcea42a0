//! The seven numbers of a mode and the window that goes with them, derived by the compiler.
//!
//! Over a block, ν = -N/2 to N/2, a mode near line l is `e^{2πi ξν/2N}` times the line, ξ its
//! complex distance from the line in lines: Re ξ from -1/2 to 1/2, Im ξ its damping. It is to be
//! `w(ν) Σ_k c_k(ξ) e^{2πi kν/2N}`, k = -3 to 3. The window is the inverse of the transform of a
//! Kaiser-Bessel kernel of seven lines (β = 16, for twice as many lines as frames): Fessler and
//! Sutton, "Nonuniform fast Fourier transforms using min-max interpolation", IEEE Trans. Signal
//! Processing 51(2), 2003. The numbers are the least-squares ones, which suit damped modes better
//! than the kernel's closed form: by 13 dB at Im ξ = 0.64 (model in f64).
//!
//! A least-squares number is a linear function of `e^{2πi ξν/2N}`, hence a power series in ξ. Its
//! coefficients are real, and those of line -k are those of k with alternating signs.

use super::{BLOCK_FRAMES, POINTS, WIDTH};
use crate::fourier::{self, Complex, TURN};

/// Distance from the middle line to the last.
const REACH: usize = WIDTH / 2;

/// Half a block.
pub(super) const HALF: usize = BLOCK_FRAMES / 2;

/// Number of coefficients of the power series.
///
/// With ξ up to 1.3 the rest is below 1e-6 of the largest number.
const TERMS: usize = 15;

/// Shape of the window. With 16.25, the rule for the closed form (Beatty, Nishimura and Pauly,
/// IEEE Trans. Medical Imaging 24(6), 2005), the errors at the ends of a block are 6 dB larger.
const BETA: f64 = 16.0;

/// Window by the distance ν from the middle of a block, 1 there.
pub(super) static WINDOW: [f32; HALF + 1] = {
    let mut table = [0.0; HALF + 1];
    let mut index = 0;
    while index < table.len() {
        table[index] = window(index as f64) as f32;
        index += 1;
    }
    table
};

/// Window at a frame of a block.
#[inline(always)]
pub(super) fn window_at(frame: usize) -> f32 {
    WINDOW.get(frame.abs_diff(HALF)).copied().unwrap_or(0.0)
}

/// Coefficients of the power series of lines 0 to 3.
static SERIES: [[f32; TERMS]; REACH + 1] = series();

/// Numbers of the lines 0 to 3 for an undamped mode at its line, which are real.
pub(super) static NUMBERS_AT_LINE: [f32; REACH + 1] = [SERIES[0][0], SERIES[1][0], SERIES[2][0], SERIES[3][0]];

/// Numbers of a mode at a complex distance ξ from its line, of the lines -3 to 3.
///
/// Re ξ is from -1/2 to 1/2, Im ξ from 0 to 4.2. Error of the sum of the lines against the mode,
/// rms over a block (`cargo test -p dsp-core frames -- --nocapture`):
///
/// | Im ξ | 0 | 0.25 | 0.64 | 1.3 | 2.6 |
/// | --- | --- | --- | --- | --- | --- |
/// | T60 at 44.1 kHz, ms | | 51 | 20 | 10 | 5 |
/// | error, dB | -127 | -117 | -95 | -71 | -44 |
///
/// The head answers for fast modes until little of them is left. Cost: about 500 floating-point
/// operations, on load.
pub fn numbers([re, im]: Complex) -> [Complex; WIDTH] {
    let mut numbers = [[0.0; 2]; WIDTH];
    let square = [re * re - im * im, 2.0 * re * im];
    let (low, high) = numbers.split_at_mut(REACH);
    for (distance, series) in SERIES.iter().enumerate() {
        let mut sums = [[0.0f32; 2]; 2];
        for (index, &coefficient) in series.iter().enumerate().rev() {
            // Even and odd powers apart, both by Horner's rule in ξ².
            let sum = if index % 2 == 0 { &mut sums[0] } else { &mut sums[1] };
            let [x, y] = *sum;
            *sum = [x * square[0] - y * square[1] + coefficient, x * square[1] + y * square[0]];
        }
        let [even, odd] = sums;
        let odd = [odd[0] * re - odd[1] * im, odd[0] * im + odd[1] * re];
        if let Some(number) = high.get_mut(distance) {
            *number = [even[0] + odd[0], even[1] + odd[1]];
        }
        if let Some(number) = REACH.checked_sub(distance).and_then(|at| low.get_mut(at)) {
            *number = [even[0] - odd[0], even[1] - odd[1]];
        }
    }
    numbers
}

/// Window at a distance from the middle: the inverse of `sinh(a)/a`, `a² = β² - (7πν/2N)²`.
const fn window(distance: f64) -> f64 {
    let slope = core::f64::consts::PI * WIDTH as f64 / POINTS as f64 * distance;
    let argument = square_root(BETA * BETA - slope * slope);
    (argument / sinh(argument)) / (BETA / sinh(BETA))
}

/// Weight of the squared error at a distance from the middle.
///
/// Ends count more: a contact that lasts beyond its block is cut there, and the errors of both
/// parts do not cancel. Without weights the largest error is 6 dB larger and the mean error 2 dB
/// smaller (model in f64).
const fn weight(distance: usize) -> f64 {
    let square = (distance * distance) as f64 / (HALF * HALF) as f64;
    let weight = 1.0 + 4.0 * square * square * square * square;
    weight * weight
}

const fn sinh(x: f64) -> f64 {
    // e^(x/64) by its series, then six squarings.
    let (mut term, mut sum, mut n) = (1.0, 1.0, 1.0);
    while n < 20.0 {
        term *= x / 64.0 / n;
        sum += term;
        n += 1.0;
    }
    let mut squarings = 0;
    while squarings < 6 {
        sum *= sum;
        squarings += 1;
    }
    (sum - 1.0 / sum) / 2.0
}

/// Square root by Newton's rule, of a number from 1 to 1000.
const fn square_root(x: f64) -> f64 {
    let (mut root, mut steps) = (x, 0);
    while steps < 20 {
        root = (root + x / root) / 2.0;
        steps += 1;
    }
    root
}

/// `cos(2π n/2N)`.
const fn cosine(n: usize) -> f64 {
    fourier::cosine(n * (TURN / POINTS))
}

/// Power series of the least-squares numbers: the normal equations of the windowed lines, solved
/// for each power of ξ in the series of `e^{2πi ξν/2N}`.
const fn series() -> [[f32; TERMS]; REACH + 1] {
    // Sums over ν of w² cos(2π kν/2N), and of w times each line times each power.
    let mut products = [0.0; WIDTH];
    let mut targets = [[0.0; TERMS]; WIDTH];
    let mut distance = 0;
    while distance <= HALF {
        let w = window(distance as f64);
        // Both ν and -ν, which have equal terms.
        let count = if distance == 0 { 1.0 } else { 2.0 } * weight(distance);
        let mut line = 0;
        while line < WIDTH {
            products[line] += count * w * w * cosine(line * distance);
            // Lines -3 to 3; a quarter turn later a cosine is minus a sine.
            let turn = (line + POINTS - REACH) * distance;
            let (cos, sin) = (cosine(turn), -cosine(turn + POINTS / 4));
            let angle = 2.0 * core::f64::consts::PI * distance as f64 / POINTS as f64;
            let (mut power, mut term) = (0, count * w);
            while power < TERMS {
                if power > 0 {
                    term *= angle / power as f64;
                }
                // Real part of e^{-i line} i^power.
                targets[line][power] += match power % 4 {
                    0 => term * cos,
                    1 => term * sin,
                    2 => -term * cos,
                    _ => -term * sin,
                };
                power += 1;
            }
            line += 1;
        }
        distance += 1;
    }
    solve(products, targets)
}

/// Solves `Σ_m products[|l - m|] x_m = targets_l` for all powers by elimination, and gives x of
/// lines 0 to 3.
const fn solve(products: [f64; WIDTH], mut x: [[f64; TERMS]; WIDTH]) -> [[f32; TERMS]; REACH + 1] {
    let mut matrix = [[0.0; WIDTH]; WIDTH];
    let mut row = 0;
    while row < WIDTH {
        let mut column = 0;
        while column < WIDTH {
            matrix[row][column] = products[row.abs_diff(column)];
            column += 1;
        }
        row += 1;
    }
    // The matrix is positive definite, so that no pivot is 0.
    let mut pivot = 0;
    while pivot < WIDTH {
        let mut row = 0;
        while row < WIDTH {
            if row != pivot {
                let factor = matrix[row][pivot] / matrix[pivot][pivot];
                let mut column = pivot;
                while column < WIDTH {
                    matrix[row][column] -= factor * matrix[pivot][column];
                    column += 1;
                }
                let mut power = 0;
                while power < TERMS {
                    x[row][power] -= factor * x[pivot][power];
                    power += 1;
                }
            }
            row += 1;
        }
        pivot += 1;
    }
    let mut series = [[0.0; TERMS]; REACH + 1];
    let mut line = 0;
    while line <= REACH {
        let mut power = 0;
        while power < TERMS {
            series[line][power] = (x[line + REACH][power] / matrix[line + REACH][line + REACH]) as f32;
            power += 1;
        }
        line += 1;
    }
    series
}

#[cfg(test)]
mod tests {
    use super::*;
    use core::f64::consts::PI;

    /// Error of the lines' sum over a block in dB, rms, for the worst of 41 distances from the
    /// line.
    fn error_db(damping: f64) -> f64 {
        let worst = (0..=40).map(|step| f64::from(step) / 40.0 - 0.5).map(|re| {
            let numbers = numbers([re as f32, damping as f32]);
            let (mut error, mut signal) = (0.0, 0.0);
            for frame in 0..BLOCK_FRAMES {
                let nu = frame as f64 - HALF as f64;
                let angle = |x: f64| 2.0 * PI * x * nu / POINTS as f64;
                let size = (-angle(damping)).exp();
                let exact = [size * angle(re).cos(), size * angle(re).sin()];
                let mut sum = [0.0; 2];
                for (number, line) in numbers.iter().zip(-3i32..) {
                    let ([x, y], a) = (number.map(f64::from), angle(f64::from(line)));
                    sum[0] += x * a.cos() - y * a.sin();
                    sum[1] += x * a.sin() + y * a.cos();
                }
                let sum = sum.map(|x| x * f64::from(window_at(frame)));
                error += (sum[0] - exact[0]).powi(2) + (sum[1] - exact[1]).powi(2);
                signal += size * size;
            }
            10.0 * (error / signal).log10()
        });
        worst.fold(f64::NEG_INFINITY, f64::max)
    }

    #[test]
    fn seven_lines_follow_a_mode_as_stated() {
        for (damping, at_most_db) in [(0.0, -126.0), (0.25, -116.0), (0.64, -94.0), (1.3, -70.0), (2.6, -43.0)] {
            let error_db = error_db(damping);
            std::println!("damping of {damping} lines: {error_db:.1} dB");
            assert!((at_most_db - 3.0..at_most_db).contains(&error_db), "{damping}: {error_db:.1} dB");
        }
    }
}
