//! Expected error in dB of one cell of a spectrogram that holds modes, noise and a floor.
//!
//! The modes have a fixed power m in the cell, the noise has the mean power n and is drawn at
//! random. The sum of both has the mean `p = m + n` and the relative variance
//! `r = (n² + 2mn)/(c p²)` with c independent complex values in the cell. A gamma distribution
//! with these moments has `E ln P = ln p + ψ(1/r) + ln r` and `Var ln P = ψ'(1/r)`. For r from 0
//! to 1 they are `ln p - r/2 - r²/12` and `r + r²/2 + r³/6`, within 0.03 dB and 0.5 dB². The gamma
//! distribution itself is within 15 % of the expected square over all draws.

/// Decibels in a neper of power.
pub(super) const DECIBELS: f32 = 4.342_944_8;

/// A cell's expected squared error, and its derivatives by the powers of modes and noise.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Cell {
    pub(super) square: f32,
    pub(super) by_modes: f32,
    pub(super) by_noise: f32,
}

/// Mean power, relative variance, and the derivatives of both by the powers of modes and noise.
#[derive(Clone, Copy, Debug)]
pub(super) struct Moments {
    pub(super) mean: f32,
    one_over: f32,
    pub(super) variance: f32,
    pub(super) by_modes: f32,
    pub(super) by_noise: f32,
}

impl Moments {
    /// Moments of a cell with `freedom` = 1/c; the floor counts as modes that do not vary.
    #[inline(always)]
    pub(super) fn new(modes: f32, noise: f32, floor: f32, freedom: f32) -> Self {
        let mean = modes + noise + floor;
        let one_over = 1.0 / mean;
        let scale = freedom * one_over * one_over;
        let variance = (noise + 2.0 * modes) * noise * scale;
        Self {
            mean,
            one_over,
            variance,
            by_modes: 2.0 * (noise * scale - variance * one_over),
            by_noise: 2.0 * ((noise + modes) * scale - variance * one_over),
        }
    }

    /// Expected squared error in dB from a wanted power, given by how far the natural logarithm of
    /// the mean lies over its own.
    #[inline(always)]
    pub(super) fn cell(&self, over_ln: f32) -> Cell {
        let Self { one_over, variance: r, by_modes, by_noise, .. } = *self;
        let error = DECIBELS * (over_ln - r * (0.5 + r * (1.0 / 12.0)));
        let scatter = DECIBELS * DECIBELS * r * (1.0 + r * (0.5 + r * (1.0 / 6.0)));
        let bend = DECIBELS * (0.5 + r * (1.0 / 6.0));
        let spread = DECIBELS * DECIBELS * (1.0 + r * (1.0 + 0.5 * r));
        let slope = |by: f32| 2.0 * error * (DECIBELS * one_over - bend * by) + spread * by;
        Cell { square: error * error + scatter, by_modes: slope(by_modes), by_noise: slope(by_noise) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::SplitMix64;

    fn expected(modes: f32, noise: f32, floor: f32, freedom: f32, wanted: f32) -> Cell {
        let moments = Moments::new(modes, noise, floor, freedom);
        moments.cell(moments.mean.ln() - wanted.ln())
    }

    #[test]
    fn expected_error_is_that_of_many_draws() {
        let mut random = SplitMix64(5);
        for (modes, noise) in [(0.0f32, 1.0f32), (1.0, 0.2), (0.3, 1.0), (10.0, 0.01)] {
            let wanted = 0.7f32;
            let draws = 200_000;
            let mut sum = 0.0;
            for _ in 0..draws {
                let half = f64::from(noise / 2.0).sqrt();
                let (re, im) = (f64::from(modes).sqrt() + half * random.normal(), half * random.normal());
                sum += (10.0 * ((re * re + im * im) / f64::from(wanted)).log10()).powi(2);
            }
            let drawn = sum / f64::from(draws);
            let expected = f64::from(expected(modes, noise, 0.0, 1.0, wanted).square);
            assert!((expected / drawn - 1.0).abs() < 0.2, "{modes} {noise}: {expected} {drawn}");
        }
    }

    #[test]
    fn slopes_are_the_numeric_derivatives() {
        let square = |modes: f32, noise: f32| expected(modes, noise, 0.05, 0.4, 0.3).square;
        for (modes, noise) in [(0.4f32, 0.8f32), (2.0, 0.3), (0.02, 0.5)] {
            let cell = expected(modes, noise, 0.05, 0.4, 0.3);
            let step = 1e-2;
            let numeric = |up: f32, down: f32| (up - down) / (2.0 * step);
            let by_modes = numeric(square(modes + step, noise), square(modes - step, noise));
            let by_noise = numeric(square(modes, noise + step), square(modes, noise - step));
            assert!((cell.by_modes - by_modes).abs() < 0.03 * by_modes.abs() + 0.1, "{cell:?} {by_modes}");
            assert!((cell.by_noise - by_noise).abs() < 0.03 * by_noise.abs() + 0.1, "{cell:?} {by_noise}");
        }
    }
}
