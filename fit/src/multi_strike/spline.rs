//! Gains along an object as splines: uniform B-splines of degree 3, or less with few coefficients.
//!
//! Cubic splines follow curving gains to the fourth power of their intervals, and have smooth
//! derivatives, so that Gauss-Newton steps pass their knots. Straight lines between as many places
//! leave 10 % of a gain that curves by one wave along seven intervals, cubic ones 1 %.

use std::iter::Sum;
use std::ops::Mul;

use nalgebra::{Complex, DMatrix};

/// Highest degree.
const DEGREE: usize = 3;

/// Weights of the coefficients at a position, and their derivatives by the position.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Weights {
    /// Index of the first coefficient.
    pub(crate) first: usize,
    /// Number of coefficients.
    pub(crate) count: usize,
    values: [f64; DEGREE + 1],
    slopes: [f64; DEGREE + 1],
}

impl Weights {
    /// Weights at a position from 0 to 1 of a spline of `coefficients`, at least one.
    pub(crate) fn at(position: f64, coefficients: usize) -> Self {
        let degree = DEGREE.min(coefficients.saturating_sub(1));
        let intervals = coefficients.max(1) - degree;
        let along = position.clamp(0.0, 1.0) * intervals as f64;
        let first = (along as usize).min(intervals - 1);
        let u = along - first as f64;
        let v = 1.0 - u;
        let (values, slopes) = match degree {
            0 => ([1.0, 0.0, 0.0, 0.0], [0.0; 4]),
            1 => ([v, u, 0.0, 0.0], [-1.0, 1.0, 0.0, 0.0]),
            2 => ([0.5 * v * v, 0.5 + u * v, 0.5 * u * u, 0.0], [-v, v - u, u, 0.0]),
            _ => (
                [v * v * v, 4.0 - 3.0 * u * u * (2.0 - u), 4.0 - 3.0 * v * v * (2.0 - v), u * u * u].map(|x| x / 6.0),
                [-0.5 * v * v, u * (1.5 * u - 2.0), v * (2.0 - 1.5 * v), 0.5 * u * u],
            ),
        };
        Self { first, count: degree + 1, values, slopes: slopes.map(|slope| slope * intervals as f64) }
    }

    /// Weights of the coefficients from `first` on.
    pub(crate) fn values(&self) -> &[f64] {
        &self.values[..self.count]
    }

    /// Value of the spline.
    pub(crate) fn sum<T: Copy + Mul<f64, Output = T> + Sum>(&self, coefficients: &[T]) -> T {
        self.values().iter().zip(&coefficients[self.first..]).map(|(weight, gain)| *gain * *weight).sum()
    }

    /// Derivative of the spline by the position.
    pub(crate) fn slope(&self, coefficients: &[Complex<f64>]) -> Complex<f64> {
        self.slopes[..self.count].iter().zip(&coefficients[self.first..]).map(|(weight, gain)| gain * weight).sum()
    }
}

/// Coefficients of the spline nearest to values at evenly spaced positions from 0 to 1.
///
/// `None` if there are fewer values than coefficients need.
pub(crate) fn nearest(values: &[Complex<f64>], coefficients: usize) -> Option<Vec<Complex<f64>>> {
    let mut rows = DMatrix::zeros(values.len(), coefficients);
    for row in 0..values.len() {
        let weights = Weights::at(row as f64 / (values.len() - 1) as f64, coefficients);
        weights.values().iter().enumerate().for_each(|(index, weight)| rows[(row, weights.first + index)] = *weight);
    }
    let parts = DMatrix::from_fn(values.len(), 2, |row, part| [values[row].re, values[row].im][part]);
    let factor = rows.tr_mul(&rows).cholesky()?;
    let nearest = factor.solve(&rows.tr_mul(&parts));
    Some(nearest.row_iter().map(|parts| Complex::new(parts[0], parts[1])).collect())
}

/// Coefficients, at least four, of the same cubic spline with two intervals in place of each one.
pub(crate) fn halved(coefficients: &[Complex<f64>]) -> Vec<Complex<f64>> {
    let count = 2 * coefficients.len() - DEGREE;
    let of_index = |index: usize| {
        let near = &coefficients[index / 2..];
        if index.is_multiple_of(2) { (near[0] + near[1]) / 2.0 } else { (near[0] + near[1] * 6.0 + near[2]) / 8.0 }
    };
    (0..count).map(of_index).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::SplitMix64;

    #[test]
    fn weights_add_to_one_and_slopes_are_central_differences() {
        let mut random = SplitMix64(7);
        for _ in 0..400 {
            let coefficients = 1 + (9.0 * random.uniform()) as usize;
            let position = 0.001 + 0.998 * random.uniform();
            let gains: Vec<Complex<f64>> =
                (0..coefficients).map(|_| Complex::new(random.normal(), random.normal())).collect();
            let at = |position: f64| Weights::at(position, coefficients).sum(&gains);
            let weights = Weights::at(position, coefficients);
            assert!((weights.values().iter().sum::<f64>() - 1.0).abs() < 1e-12);
            let slope = (at(position + 1e-6) - at(position - 1e-6)) / 2e-6;
            assert!((weights.slope(&gains) - slope).norm() < 1e-6, "{coefficients} {position}");
        }
    }

    #[test]
    fn a_spline_stays_as_it_is_when_its_intervals_are_halved() {
        let mut random = SplitMix64(8);
        for count in 4..=9 {
            let coefficients: Vec<Complex<f64>> =
                (0..count).map(|_| Complex::new(random.normal(), random.normal())).collect();
            let halved = halved(&coefficients);
            assert_eq!(halved.len(), 2 * count - 3);
            for index in 0..=100 {
                let position = f64::from(index) / 100.0;
                let [before, after] = [&coefficients, &halved].map(|all| Weights::at(position, all.len()).sum(all));
                assert!((before - after).norm() < 1e-13, "{count} {position}: {before} {after}");
            }
        }
    }
}
