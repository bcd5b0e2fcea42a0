//! Random lines of a wave, folded for the complex transform that makes the wave.
//!
//! A wave of `2 M` samples, `x[n] = Σ_{k=-M}^{M} X_k e^{2πi kn/2M}` with `X_{-k} = X_k*`, goes
//! through one complex transform of M points: its even samples are the real parts, its odd samples
//! the imaginary parts.
//!
//! Error at most 120 dB below the wave (`waves_agree_with_the_plain_sum`).

use crate::fourier::{self, Complex, MAX_POINTS, TWIDDLES};

/// Input of the complex transform at the places `k` and `M - k`, from the lines X_k and X_{M-k} of
/// the real wave.
#[inline(always)]
fn fold(low: Complex, high: Complex, [cos, sin]: Complex) -> (Complex, Complex) {
    let sum = [low[0] + high[0], low[1] - high[1]];
    let difference = [low[0] - high[0], low[1] + high[1]];
    let turned = [cos * difference[0] - sin * difference[1], cos * difference[1] + sin * difference[0]];
    ([sum[0] - turned[1], sum[1] + turned[0]], [sum[0] + turned[1], turned[0] - sum[1]])
}

/// Puts random lines into a spectrum, for a range of the pairs of lines k and M - k, k from 1 to
/// M/2 - 1. The spectrum holds of each line its amplitude A, and A c/2 with its tilt c. With `u_k`
/// random the line is `A (u_k - i c/2 (u_{k-1} - u_{k+1}))`: in time the noise of the u times
/// `1 + c sin 2πn/2M`. `draw` gives the real and imaginary parts of two `u`.
#[inline(always)]
pub(super) fn fill_pairs(spectrum: &mut [Complex], pairs: core::ops::Range<usize>, mut draw: impl FnMut() -> [f32; 4]) {
    let points = spectrum.len().max(1);
    let (step, half) = (MAX_POINTS / points, points / 2);
    let Some((low, high)) = spectrum.split_at_mut_checked(half) else { return };
    let mirrored = (half + 1).saturating_sub(pairs.end)..(half + 1).saturating_sub(pairs.start);
    let twiddles = TWIDDLES.get(pairs.start * step..).unwrap_or(&[]).iter();
    let (Some(low), Some(high)) = (low.get_mut(pairs), high.get_mut(mirrored)) else { return };
    let line = |[amplitude, tilted]: Complex, below: Complex, own: Complex, above: Complex| {
        [amplitude * own[0] + tilted * (below[1] - above[1]), amplitude * own[1] - tilted * (below[0] - above[0])]
    };
    // Low lines go up, high ones down; at the beginning of a range those before it are drawn anew.
    let ([mut a, mut b, mut c, mut d], mut own) = (draw(), draw());
    let mut fill = |low: &mut Complex, high: &mut Complex, twiddle: Complex| {
        let next = draw();
        let at_low = line(*low, [a, b], [own[0], own[1]], [next[0], next[1]]);
        let at_high = line(*high, [next[2], next[3]], [own[2], own[3]], [c, d]);
        (*low, *high) = fold(at_low, at_high, twiddle);
        ([a, b, c, d], own) = (own, next);
    };
    let lines = low.iter_mut().zip(high.iter_mut().rev());
    if step == 1 {
        lines.zip(twiddles).for_each(|((low, high), twiddle)| fill(low, high, *twiddle));
    } else {
        lines.zip(twiddles.step_by(step)).for_each(|((low, high), twiddle)| fill(low, high, *twiddle));
    }
}

/// Fills the lines that are in no pair: 0, which is real (there is none at Nyquist), and M/2.
pub(super) fn fill_middle(spectrum: &mut [Complex], draw: [f32; 4]) {
    let middle = spectrum.len() / 2;
    if let Some(line) = spectrum.first_mut() {
        // A line beside its mirror image has twice the power of one alone.
        let real = 2.0 * line[0] * draw[0];
        *line = [real, real];
    }
    if let Some(line) = spectrum.get_mut(middle) {
        *line = [2.0 * line[0] * draw[2], -2.0 * line[0] * draw[3]];
    }
}

/// Place of the samples `n` and `n + 1` of a wave, n even (modulo the wave's length).
#[inline(always)]
pub(super) fn place(n: u32, points_log2: u32) -> usize {
    fourier::place(n >> 1, points_log2)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fourier::Progress;
    use crate::noise::Sfc32;
    use std::vec::Vec;

    /// Wave of random lines, tilted or not, as computed in pieces, and their plain sum in `f64`.
    fn both(points: usize, piece: u32) -> (Vec<f64>, Vec<f64>) {
        let mut noise = Sfc32::new(points as u32, 1);
        let mut drawn: Vec<[Complex; 2]> = Vec::new();
        let amplitude = |k: usize| 1.0 / (1.0 + (k % 37) as f32);
        let tilted = |k: usize| amplitude(k) * ((k % 5) as f32 - 2.0) * 0.2;
        let mut spectrum: Vec<Complex> = (0..points).map(|k| [amplitude(k), tilted(k)]).collect();
        let mut draw = || {
            let four = noise.four().map(|x| x as f32 / 128.0);
            drawn.push([[four[0], four[1]], [four[2], four[3]]]);
            four
        };
        fill_middle(&mut spectrum, draw());
        fill_pairs(&mut spectrum, 1..5, &mut draw);
        fill_pairs(&mut spectrum, 5..points / 2, &mut draw);
        let mut progress = Progress::start(points);
        while !progress.is_over() {
            progress.advance(&mut spectrum, piece);
        }
        let wave =
            (0..2 * points as u32).map(|n| f64::from(spectrum[place(n, points.trailing_zeros())][n as usize % 2]));
        let mut exact = std::vec![[0.0; 2]; points];
        let middle = |k: usize, part: Complex| part.map(|x| f64::from(x) * f64::from(amplitude(k)));
        exact[0] = [middle(0, drawn[0][0])[0], 0.0];
        exact[points / 2] = middle(points / 2, drawn[0][1]);
        let line = |k: usize, [below, own, above]: [Complex; 3]| {
            let (amplitude, tilted) = (f64::from(amplitude(k)), f64::from(tilted(k)));
            // -i (x + iy) = y - ix.
            [
                amplitude * f64::from(own[0]) + tilted * f64::from(below[1] - above[1]),
                amplitude * f64::from(own[1]) - tilted * f64::from(below[0] - above[0]),
            ]
        };
        let mut first = 1;
        for range in [1..5, 5..points / 2] {
            for (k, three) in range.clone().zip(drawn[first..].windows(3)) {
                exact[k] = line(k, [three[0][0], three[1][0], three[2][0]]);
                exact[points - k] = line(points - k, [three[2][1], three[1][1], three[0][1]]);
            }
            first += range.len() + 2;
        }
        let sum = |n: usize| {
            let line = |k: usize| {
                let angle = core::f64::consts::PI * (k * n % (2 * points)) as f64 / points as f64;
                2.0 * (exact[k][0] * angle.cos() - exact[k][1] * angle.sin())
            };
            (0..points).map(line).sum::<f64>()
        };
        (wave.collect(), (0..2 * points).map(sum).collect())
    }

    #[test]
    fn waves_agree_with_the_plain_sum() {
        for points in [64, 128, 256, 512] {
            for piece in [1, 500, u32::MAX] {
                let (wave, exact) = both(points, piece);
                let power: f64 = exact.iter().map(|x| x * x).sum();
                let error: f64 = wave.iter().zip(&exact).map(|(x, y)| (x - y) * (x - y)).sum();
                let snr_db = 10.0 * (power / error).log10();
                assert!(snr_db > 120.0, "{points} points in pieces of {piece}: {snr_db:.1} dB");
            }
        }
    }
}
