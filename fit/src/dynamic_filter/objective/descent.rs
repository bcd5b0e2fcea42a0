//! Descent of a candidate towards the levels asked for.

use nalgebra::{DMatrix, DVector};

use super::candidate::Candidate;
use super::numbers::Numbers;
use super::rows::Row;
use super::targets::Objective;
use crate::dynamic_filter::guide::crowding;
use crate::dynamic_filter::stability::MOST_LOOP_GAIN;

/// Error in all levels of a band, in dB, at which the band's weight is halved.
///
/// A band that cannot be followed must not spoil those that can.
const HOPELESS_DB: f64 = 4.0;
/// Price of a loop gain beyond its bound, in dB a unit.
const UNSTABLE_PRICE: f64 = 300.0;
/// Maximum number of steps.
const STEPS: usize = 40;

impl Objective {
    /// The filters, modes and loops near `start` whose band levels come nearest to the law.
    pub(crate) fn descend(&self, start: &Candidate) -> Candidate {
        const NUDGE: f64 = 1e-4;
        let mut numbers = Numbers::of(start, self.lawful());
        let mut trust = vec![1.0; self.rates.len()];
        let mut errors = self.errors(&numbers, &trust);
        let mut damping = 1e-2;
        for step in 0..STEPS {
            if step % 5 == 4 {
                trust = self.trust(&numbers);
                errors = self.errors(&numbers, &trust);
            }
            let mut slopes = DMatrix::zeros(errors.len(), numbers.free.len());
            for index in 0..numbers.free.len() {
                let mut nudged = numbers.clone();
                nudged.free[index] += NUDGE;
                slopes.set_column(index, &((self.errors(&nudged, &trust) - &errors) / NUDGE));
            }
            let mut curvature = slopes.tr_mul(&slopes);
            for index in 0..numbers.free.len() {
                curvature[(index, index)] += damping * (curvature[(index, index)] + 1e-3);
            }
            let Some(step) = curvature.cholesky().map(|factors| factors.solve(&slopes.tr_mul(&errors))) else { break };
            let mut tried = numbers.clone();
            tried.free.iter_mut().zip(step.iter()).for_each(|(free, step)| *free -= step.clamp(-1.0, 1.0));
            tried.bound();
            let after = self.errors(&tried, &trust);
            let gained = errors.norm_squared() - after.norm_squared();
            if gained > 0.0 {
                let small = gained < 1e-4 * (1.0 + errors.norm_squared());
                (numbers, errors) = (tried, after);
                damping = (0.2 * damping).max(1e-9);
                if small {
                    break;
                }
            } else {
                damping *= 10.0;
                if damping > 1e8 {
                    break;
                }
            }
        }
        numbers.candidate()
    }

    /// Weight of each band, from 1 for a band without error down to 0.
    fn trust(&self, numbers: &Numbers) -> Vec<f64> {
        let mut sums = vec![(0.0, 1e-9); self.rates.len()];
        for (row, error) in self.rows.iter().zip(self.row_errors(numbers)) {
            if let Some((sum, weight)) = sums.get_mut(row.band) {
                *sum += row.weight * error * error;
                *weight += row.weight;
            }
        }
        sums.into_iter().map(|(sum, weight)| (1.0 + sum / weight / HOPELESS_DB.powi(2)).recip()).collect()
    }

    fn row_errors(&self, numbers: &Numbers) -> Vec<f64> {
        let powers = self.powers(&numbers.candidate());
        let error = |row: &Row| row.error_db(&powers, numbers.offset_db(row.band));
        self.rows.iter().map(error).collect()
    }

    fn errors(&self, numbers: &Numbers, trust: &[f64]) -> DVector<f64> {
        let rows = self.row_errors(numbers);
        let weighed = self.rows.iter().zip(rows).map(|(row, error)| {
            let trust = trust.get(row.band).copied().unwrap_or(1.0);
            (trust * row.weight).sqrt() * error
        });
        let guides = numbers.candidate().guides;
        let unstable: Vec<f64> =
            crowding(&guides).map(|gain| UNSTABLE_PRICE * (gain - MOST_LOOP_GAIN).max(0.0)).collect();
        let all: Vec<f64> = weighed.chain(numbers.prices()).chain(unstable).collect();
        DVector::from_vec(all)
    }
}
