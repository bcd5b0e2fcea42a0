//! Poles of a complex signal by ESPRIT: the shift invariance of its signal subspace.

use nalgebra::{Complex, DMatrix, DVector, Schur, SymmetricEigen};

type C64 = Complex<f64>;

/// Maximum number of rows of the covariance matrix.
const MOST_ROWS: usize = 64;
/// Eigenvalue relative to the largest below which rounding decides: 80 dB.
const LEAST_RELATIVE: f64 = 1e-8;
/// Eigenvalue relative to the median, which is noise, above which a dimension is signal.
const OVER_NOISE: f64 = 4.0;
/// Maximum number of steps of the Schur decomposition.
const MOST_STEPS: usize = 2_000;

/// Poles z of the damped exponentials `Σ a zⁿ` in the samples, at most `most`.
pub(super) fn poles(samples: &[C64], most: usize) -> Vec<C64> {
    let rows = (samples.len() / 3).min(MOST_ROWS);
    if rows < 4 {
        return Vec::new();
    }
    let eigen = SymmetricEigen::new(covariance(samples, rows));
    let mut order: Vec<usize> = (0..rows).collect();
    order.sort_by(|&a, &b| eigen.eigenvalues[b].total_cmp(&eigen.eigenvalues[a]));
    let value = |place: usize| eigen.eigenvalues[order[place]];
    let least = (value(0) * LEAST_RELATIVE).max(value(rows / 2 + rows / 4) * OVER_NOISE).max(f64::MIN_POSITIVE);
    let count = (0..most.min(rows / 2)).take_while(|&place| value(place) > least).count();
    if count == 0 {
        return Vec::new();
    }
    let subspace = DMatrix::from_fn(rows, count, |row, column| eigen.eigenvectors[(row, order[column])]);
    let (upper, lower) = (subspace.rows(0, rows - 1), subspace.rows(1, rows - 1));
    let last: DVector<C64> = subspace.row(rows - 1).adjoint();
    let product = upper.adjoint() * lower;
    // The columns are orthonormal, so the inverse of the upper part's Gram matrix is known.
    let rest = (1.0 - last.norm_squared()).max(1e-9);
    let along = last.adjoint() * &product;
    let shift = product + last * along / C64::new(rest, 0.0);
    let Some(schur) = Schur::try_new(shift, 1e-12, MOST_STEPS) else { return Vec::new() };
    let (_, triangle) = schur.unpack();
    triangle.diagonal().iter().copied().collect()
}

/// Covariance `Σ x[t+i] x*[t+j]` over all whole columns of the Hankel matrix.
fn covariance(samples: &[C64], rows: usize) -> DMatrix<C64> {
    let columns = samples.len() - rows + 1;
    let mut matrix = DMatrix::zeros(rows, rows);
    for row in 0..rows {
        let first: C64 = (0..columns).map(|t| samples[t + row] * samples[t].conj()).sum();
        matrix[(row, 0)] = first;
    }
    for column in 1..rows {
        for row in column..rows {
            let (i, j) = (row - 1, column - 1);
            matrix[(row, column)] =
                matrix[(i, j)] - samples[i] * samples[j].conj() + samples[i + columns] * samples[j + columns].conj();
        }
    }
    for column in 0..rows {
        for row in 0..column {
            matrix[(row, column)] = matrix[(column, row)].conj();
        }
    }
    matrix
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn poles_of_close_damped_exponentials_are_found() {
        let truth = [C64::new(-0.01, 0.3), C64::new(-0.02, 0.36), C64::new(-0.002, -1.2)];
        let at = |n: usize| truth.iter().map(|pole| (pole * n as f64).exp()).sum::<C64>();
        let samples: Vec<C64> = (0..300).map(at).collect();
        let found = poles(&samples, 12);
        assert_eq!(found.len(), 3, "{found:?}");
        for pole in truth {
            let nearest = found.iter().map(|z| (z.ln() - pole).norm()).fold(f64::INFINITY, f64::min);
            assert!(nearest < 1e-6, "{pole}: {nearest}");
        }
    }
}
