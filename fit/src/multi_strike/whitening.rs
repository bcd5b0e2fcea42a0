//! A short filter that makes the noise white: linear prediction of what the model leaves.

use std::ops::Range;

use nalgebra::{Complex, DMatrix, DMatrixViewMut};

use crate::modes::Pole;
use crate::vectors::vectorized;

/// Prediction error filter `w[0] = 1, w[1] ..`.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Whitening(Vec<f64>);

/// Order of the filter that makes what a model leaves white.
pub(crate) const ORDER: usize = 12;
/// Number of samples that are filtered by all weights before the next ones: so many stay near the
/// processor.
const BLOCK: usize = 1024;
/// Least ratio of the innovation to what it is computed from, so that the filter stays tame.
const LEAST_RATIO: f64 = 1e-6;

impl Whitening {
    /// No filter: the noise is taken for white.
    pub(crate) fn none() -> Self {
        Self(vec![1.0])
    }

    /// Filter of an order for a residual, by Levinson's and Durbin's recursion.
    pub(crate) fn of_residual(residual: &[f64], order: usize) -> Self {
        let lag = |lag: usize| residual.iter().zip(residual.get(lag..).unwrap_or(&[])).map(|(a, b)| a * b).sum::<f64>();
        let correlation: Vec<f64> = (0..=order).map(lag).collect();
        let mut filter = vec![1.0];
        let mut error = correlation[0];
        if error <= 0.0 {
            return Self::none();
        }
        for step in 1..=order {
            let along: f64 = filter.iter().enumerate().map(|(index, w)| w * correlation[step - index]).sum();
            let reflection = -along / error;
            filter.push(0.0);
            let turned: Vec<f64> = filter.iter().rev().copied().collect();
            filter.iter_mut().zip(turned).for_each(|(w, turned)| *w += reflection * turned);
            error *= 1.0 - reflection * reflection;
            if error < LEAST_RATIO * correlation[0] {
                break;
            }
        }
        Self(filter)
    }

    /// Number of earlier samples that a filtered one depends on.
    pub(crate) fn order(&self) -> usize {
        self.0.len() - 1
    }

    /// Filtered samples of a range; there is silence before the first sample.
    pub(crate) fn filtered(&self, samples: &[f64], range: Range<usize>) -> Vec<f64> {
        let mut filtered = vec![0.0; range.len()];
        let starts = range.step_by(BLOCK);
        vectorized(
            #[inline(always)]
            || starts.zip(filtered.chunks_mut(BLOCK)).for_each(|(start, block)| self.filter(samples, start, block)),
        );
        filtered
    }

    /// Filters the samples from `start` on into a block of zeros.
    #[inline(always)]
    fn filter(&self, samples: &[f64], start: usize, filtered: &mut [f64]) {
        for (back, w) in self.0.iter().enumerate() {
            let silent = back.saturating_sub(start).min(filtered.len());
            let delayed = &samples[(start + silent).saturating_sub(back)..];
            filtered[silent..].iter_mut().zip(delayed).for_each(|(sum, x)| *sum += w * x);
        }
    }

    /// Filtered rows without the first `history` ones; there is silence before the first row.
    pub(crate) fn of_rows(&self, rows: &DMatrix<f64>, history: usize) -> DMatrix<f64> {
        let mut filtered = DMatrix::zeros(rows.nrows() - history, rows.ncols());
        for (mut filtered, rows) in filtered.column_iter_mut().zip(rows.column_iter()) {
            for (index, x) in filtered.iter_mut().enumerate() {
                let n = index + history;
                *x = self.0.iter().enumerate().take(n + 1).map(|(back, w)| w * rows[n - back]).sum();
            }
        }
        filtered
    }

    /// Response `W(z) = Σ w[h] z^-h`, and its derivative by `ln z`.
    pub(crate) fn response(&self, pole: Pole) -> [Complex<f64>; 2] {
        let mut sums = [Complex::new(0.0, 0.0); 2];
        for (back, w) in self.0.iter().enumerate() {
            let power = pole.power(-(back as f64)) * *w;
            sums[0] += power;
            sums[1] -= power * back as f64;
        }
        sums
    }

    /// Columns of coefficients of `Re u, Re ju, Re v, Re jv` of each mode, filtered in place.
    pub(crate) fn filter_columns(&self, columns: &mut DMatrix<f64>, poles: &[Pole]) {
        for (mode, &pole) in poles.iter().enumerate() {
            self.filter_rows_of(pole, &mut columns.rows_mut(4 * mode, 4));
        }
    }

    /// The four rows of one mode, filtered in place.
    ///
    /// `zⁿ` becomes `W zⁿ`, and `n zⁿ` becomes `W n zⁿ + W' zⁿ`.
    pub(crate) fn filter_rows_of(&self, pole: Pole, rows: &mut DMatrixViewMut<'_, f64>) {
        let [plain, slope] = self.response(pole);
        for mut column in rows.column_iter_mut() {
            let (u, v) = (Complex::new(column[0], column[1]), Complex::new(column[2], column[3]));
            let (u, v) = (plain * u + slope * v, plain * v);
            for (row, value) in [u.re, u.im, v.re, v.im].into_iter().enumerate() {
                column[row] = value;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::SplitMix64;

    #[test]
    fn filter_of_noise_with_one_pole_is_that_pole() {
        let mut random = SplitMix64(2);
        let mut last = 0.0;
        let noise: Vec<f64> = (0..100_000)
            .map(|_| {
                last = 0.9 * last + random.normal();
                last
            })
            .collect();
        let filter = Whitening::of_residual(&noise, 4);
        assert!((filter.0[1] + 0.9).abs() < 0.01 && filter.0[2..].iter().all(|w| w.abs() < 0.02), "{filter:?}");
        let white = filter.filtered(&noise, 0..noise.len());
        let energy: f64 = white.iter().map(|x| x * x).sum::<f64>() / 1e5;
        assert!((energy - 1.0).abs() < 0.02, "{energy}");
    }
}
