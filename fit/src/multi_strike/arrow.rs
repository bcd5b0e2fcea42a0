//! Normal equations in the shape of an arrow: a band of strikes, and what all of them share.
//!
//! Two strikes have a common term only while the first still rings. So the parameters of the
//! strikes form a band, bordered by the shared parameters. Cholesky's factor keeps that shape, and
//! time and memory grow with the number of strikes alone.

use nalgebra::{Cholesky, DMatrix, DVector, Dyn};

/// Normal equations `[A B; Bᵀ C] x = r`, A a band.
#[derive(Clone, Debug)]
pub(crate) struct Arrow {
    /// Half bandwidth of A.
    reach: usize,
    /// Rows of A, each from column `row - reach` to its diagonal.
    band: Vec<f64>,
    /// B transposed: one column for each row of A.
    border: DMatrix<f64>,
    corner: DMatrix<f64>,
    right: DVector<f64>,
    right_shared: DVector<f64>,
    /// Directions in which the shared parameters may change, a column each; `None` for all.
    directions: Option<DMatrix<f64>>,
}

/// Cholesky's factor of an [`Arrow`].
pub(crate) struct Factor {
    reach: usize,
    /// Rows of the lower triangle of A's factor, as [`Arrow`] stores those of A.
    lower: Vec<f64>,
    /// `L⁻¹ B`, transposed.
    border: DMatrix<f64>,
    schur: Cholesky<f64, Dyn>,
}

impl Arrow {
    /// Equations of `count` parameters in a band of half width `reach`, and `shared` others.
    pub(crate) fn zeros(count: usize, reach: usize, shared: usize) -> Self {
        Self {
            reach,
            band: vec![0.0; count * (reach + 1)],
            border: DMatrix::zeros(shared, count),
            corner: DMatrix::zeros(shared, shared),
            right: DVector::zeros(count),
            right_shared: DVector::zeros(shared),
            directions: None,
        }
    }

    /// The equations with the shared parameters changing along the columns of a matrix only.
    pub(crate) fn along(mut self, directions: DMatrix<f64>) -> Self {
        self.border = directions.tr_mul(&self.border);
        self.corner = directions.tr_mul(&(&self.corner * &directions));
        self.right_shared = directions.tr_mul(&self.right_shared);
        self.directions = Some(directions);
        self
    }

    /// Covariance of all shared parameters, from that of the directions in which they change.
    pub(crate) fn of_all_shared(&self, covariance: DMatrix<f64>) -> DMatrix<f64> {
        match &self.directions {
            Some(directions) => directions * covariance * directions.transpose(),
            None => covariance,
        }
    }

    /// Adds equations of the band's parameters from `first` on and the shared ones behind them.
    pub(crate) fn add(&mut self, first: usize, normal: &DMatrix<f64>, right: &DVector<f64>) {
        let shared = self.right_shared.len();
        let count = right.len() - shared;
        for row in 0..count {
            for column in 0..=row {
                let place = (first + row) * (self.reach + 1) + self.reach - (row - column);
                self.band[place] += normal[(row, column)];
            }
            self.right[first + row] += right[row];
            for column in 0..shared {
                self.border[(column, first + row)] += normal[(count + column, row)];
            }
        }
        for row in 0..shared {
            self.right_shared[row] += right[count + row];
            for column in 0..shared {
                self.corner[(row, column)] += normal[(count + row, count + column)];
            }
        }
    }

    /// Holds a parameter of the band: its step is 0.
    pub(crate) fn hold(&mut self, index: usize) {
        let width = self.reach + 1;
        for back in 1..=self.reach.min(index) {
            self.band[index * width + self.reach - back] = 0.0;
        }
        for ahead in 1..=self.reach.min(self.right.len() - 1 - index) {
            self.band[(index + ahead) * width + self.reach - ahead] = 0.0;
        }
        self.band[index * width + self.reach] = 1.0;
        self.border.column_mut(index).fill(0.0);
        self.right[index] = 0.0;
    }

    /// Holds a shared parameter: its step is 0.
    pub(crate) fn hold_shared(&mut self, index: usize) {
        self.border.row_mut(index).fill(0.0);
        self.corner.row_mut(index).fill(0.0);
        self.corner.column_mut(index).fill(0.0);
        self.corner[(index, index)] = 1.0;
        self.right_shared[index] = 0.0;
    }

    /// Largest decrease that a solution promises, `x · r`.
    pub(crate) fn promise(&self, step: &(DVector<f64>, DVector<f64>)) -> f64 {
        self.right.dot(&step.0) + self.right_shared.dot(&step.1)
    }

    /// Step of all shared parameters, from that along the directions in which they change.
    pub(crate) fn step_of_all_shared(&self, step: &DVector<f64>) -> DVector<f64> {
        self.directions.as_ref().map_or_else(|| step.clone(), |directions| directions * step)
    }

    /// Right sides of the band's and of the shared parameters.
    #[cfg(test)]
    pub(crate) fn right_sides(&self) -> (&DVector<f64>, &DVector<f64>) {
        (&self.right, &self.right_shared)
    }

    /// Factor of the equations with each diagonal element grown by a share (Levenberg's damping).
    ///
    /// `None` if the equations are not definite.
    pub(crate) fn factor(&self, damping: f64) -> Option<Factor> {
        let (count, reach, width) = (self.right.len(), self.reach, self.reach + 1);
        let mut lower = self.band.clone();
        for row in 0..count {
            let from = row.saturating_sub(reach);
            let (before, rest) = lower.split_at_mut(row * width);
            let own = &mut rest[..width];
            own[reach] = own[reach] * (1.0 + damping) + f64::MIN_POSITIVE;
            for column in from..row {
                let other = &before[column * width..(column + 1) * width];
                let start = from.max(column.saturating_sub(reach));
                let (here, there) = (start + reach - row, start + reach - column);
                let common = column - start;
                let sum: f64 =
                    own[here..here + common].iter().zip(&other[there..there + common]).map(|(a, b)| a * b).sum();
                own[column + reach - row] = (own[column + reach - row] - sum) / other[reach];
            }
            let square: f64 = own[from + reach - row..reach].iter().map(|x| x * x).sum();
            let rest = own[reach] - square;
            if rest.is_nan() || rest <= 0.0 {
                return None;
            }
            own[reach] = rest.sqrt();
        }
        let mut border = self.border.clone();
        for row in 0..count {
            let own = &lower[row * width..(row + 1) * width];
            for column in row.saturating_sub(reach)..row {
                let factor = own[column + reach - row];
                if factor != 0.0 {
                    let (before, mut here) = border.columns_range_pair_mut(column, row);
                    here.axpy(-factor, &before, 1.0);
                }
            }
            border.column_mut(row).scale_mut(1.0 / own[reach]);
        }
        let mut schur = self.corner.clone();
        for index in 0..schur.nrows() {
            schur[(index, index)] = schur[(index, index)] * (1.0 + damping) + f64::MIN_POSITIVE;
        }
        schur -= &border * border.transpose();
        Some(Factor { reach, lower, border, schur: Cholesky::new(schur)? })
    }

    /// Covariance of the shared parameters with those of the band held, in units of the noise
    /// variance.
    ///
    /// Each diagonal element grows by the share `damping`. `None` if the shared equations alone are
    /// not definite then.
    pub(crate) fn held_shared_covariance(&self, damping: f64) -> Option<DMatrix<f64>> {
        let mut corner = self.corner.clone();
        (0..corner.nrows()).for_each(|index| corner[(index, index)] *= 1.0 + damping);
        Some(self.of_all_shared(Cholesky::new(corner)?.inverse()))
    }

    /// Covariance and right side of the shared parameters with those of the band held, if these
    /// change in all directions.
    ///
    /// As [`Self::held_shared_covariance`].
    pub(crate) fn held_shared(&self, damping: f64) -> Option<(DMatrix<f64>, DVector<f64>)> {
        Some((self.held_shared_covariance(damping)?, self.right_shared.clone()))
    }

    /// Solution with a factor of these equations: parameters of the band, then the shared ones, or
    /// the directions in which they change.
    pub(crate) fn solve(&self, factor: &Factor) -> (DVector<f64>, DVector<f64>) {
        let mut along = self.right.clone();
        factor.forward(&mut along, 0);
        let shared = factor.schur.solve(&(&self.right_shared - &factor.border * &along));
        along -= factor.border.tr_mul(&shared);
        factor.backward(&mut along);
        (along, shared)
    }
}

/// Number of half bandwidths after which a column of the inverse factor has faded.
const FADED: usize = 12;

impl Factor {
    fn forward(&self, values: &mut DVector<f64>, from: usize) {
        let width = self.reach + 1;
        for row in from..values.len() {
            let own = &self.lower[row * width..(row + 1) * width];
            let start = row.saturating_sub(self.reach).max(from);
            let sum: f64 = (start..row).map(|column| own[column + self.reach - row] * values[column]).sum();
            values[row] = (values[row] - sum) / own[self.reach];
        }
    }

    fn backward(&self, values: &mut DVector<f64>) {
        let width = self.reach + 1;
        for row in (0..values.len()).rev() {
            let own = &self.lower[row * width..(row + 1) * width];
            values[row] /= own[self.reach];
            let value = values[row];
            for column in row.saturating_sub(self.reach)..row {
                values[column] -= own[column + self.reach - row] * value;
            }
        }
    }

    /// Covariance of the shared parameters, in units of the noise variance.
    pub(crate) fn shared_covariance(&self) -> DMatrix<f64> {
        self.schur.inverse()
    }

    /// Variance of parameter `at` of each run of `size` parameters of the band, with the shared
    /// parameters held, in units of the noise variance.
    pub(crate) fn held_variances(&self, size: usize, at: usize) -> Vec<f64> {
        let count = self.border.ncols();
        let of_block = |block: usize| {
            let first = block * size + at;
            let mut unit = DVector::zeros(count.min(first + FADED * (self.reach + 1)));
            unit[first] = 1.0;
            self.forward(&mut unit, first);
            unit.norm_squared()
        };
        (0..count / size).map(of_block).collect()
    }

    /// Covariance of each run of `size` parameters of the band, in units of the noise variance.
    pub(crate) fn covariances(&self, size: usize) -> Vec<DMatrix<f64>> {
        let count = self.border.ncols();
        let inverse = self.schur.inverse();
        // A⁻¹ B = L⁻ᵀ (L⁻¹ B), row by row from the last.
        let width = self.reach + 1;
        let mut through = self.border.clone();
        for row in (0..count).rev() {
            let own = &self.lower[row * width..(row + 1) * width];
            through.column_mut(row).scale_mut(1.0 / own[self.reach]);
            for column in row.saturating_sub(self.reach)..row {
                let factor = own[column + self.reach - row];
                if factor != 0.0 {
                    let (mut before, here) = through.columns_range_pair_mut(column, row);
                    before.axpy(-factor, &here, 1.0);
                }
            }
        }
        let blocks = (0..count / size).map(|block| {
            let first = block * size;
            let last = count.min(first + FADED * width);
            let columns: Vec<DVector<f64>> = (0..size)
                .map(|index| {
                    let mut unit = DVector::zeros(last);
                    unit[first + index] = 1.0;
                    self.forward(&mut unit, first);
                    unit
                })
                .collect();
            DMatrix::from_fn(size, size, |a, b| {
                let shared = (&inverse * through.column(first + b)).dot(&through.column(first + a));
                columns[a].dot(&columns[b]) + shared
            })
        });
        blocks.collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::SplitMix64;

    /// Random definite equations, as an arrow and as a plain matrix.
    fn equations(count: usize, reach: usize, shared: usize) -> (Arrow, DMatrix<f64>, DVector<f64>) {
        let mut random = SplitMix64(11);
        let size = count + shared;
        let (mut arrow, mut plain) = (Arrow::zeros(count, reach, shared), DMatrix::zeros(size, size));
        let mut right = DVector::zeros(size);
        for first in 0..count - reach {
            let local = reach + 1 + shared;
            let rows = DMatrix::from_fn(2 * local, local, |_, _| random.normal());
            let (normal, along) = (rows.tr_mul(&rows), DVector::from_fn(local, |_, _| random.normal()));
            arrow.add(first, &normal, &along);
            let place = |index: usize| if index <= reach { first + index } else { count + index - reach - 1 };
            for a in 0..local {
                right[place(a)] += along[a];
                for b in 0..local {
                    plain[(place(a), place(b))] += normal[(a, b)];
                }
            }
        }
        (arrow, plain, right)
    }

    #[test]
    fn solution_and_covariance_are_those_of_the_plain_matrix() {
        let (arrow, plain, right) = equations(18, 5, 4);
        let inverse = plain.clone().try_inverse().expect("the equations are definite");
        let expected = &inverse * right;
        let factor = arrow.factor(0.0).expect("the equations are definite");
        let (along, shared) = arrow.solve(&factor);
        for index in 0..18 {
            assert!((along[index] - expected[index]).abs() < 1e-10);
        }
        let covariance = factor.shared_covariance();
        for index in 0..4 {
            assert!((shared[index] - expected[18 + index]).abs() < 1e-10);
            assert!((covariance[(index, index)] - inverse[(18 + index, 18 + index)]).abs() < 1e-10);
        }
        let corner = plain.view((18, 18), (4, 4)).into_owned().try_inverse().expect("the equations are definite");
        let held = arrow.held_shared_covariance(0.0).expect("the equations are definite");
        assert!((held - corner).amax() < 1e-10);
        let held = plain.view((0, 0), (18, 18)).into_owned().try_inverse().expect("the equations are definite");
        for (block, variance) in factor.held_variances(3, 1).into_iter().enumerate() {
            assert!((variance - held[(3 * block + 1, 3 * block + 1)]).abs() < 1e-10);
        }
        for (block, covariance) in factor.covariances(3).into_iter().enumerate() {
            for a in 0..3 {
                for b in 0..3 {
                    assert!((covariance[(a, b)] - inverse[(3 * block + a, 3 * block + b)]).abs() < 1e-10);
                }
            }
        }
    }

    #[test]
    fn held_parameter_does_not_move_and_leaves_the_others_solved() {
        let (mut arrow, mut plain, mut right) = equations(18, 5, 4);
        arrow.hold(7);
        plain.row_mut(7).fill(0.0);
        plain.column_mut(7).fill(0.0);
        plain[(7, 7)] = 1.0;
        right[7] = 0.0;
        let expected = plain.try_inverse().expect("the equations are definite") * right;
        let factor = arrow.factor(0.0).expect("the equations are definite");
        let (along, _) = arrow.solve(&factor);
        assert!(along[7] == 0.0 && (0..18).all(|index| (along[index] - expected[index]).abs() < 1e-10));
    }
}
