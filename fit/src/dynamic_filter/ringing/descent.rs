//! Descent: the free numbers whose band levels come nearest to the law.

use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;

use super::circle::Circle;
use super::numbers::{Decoded, Ringing};
use crate::dynamic_filter::objective::Objective;
use crate::dynamic_filter::stability::MOST_LOOP_GAIN;

/// Error in all levels of a band, in dB, at which the band's weight is halved.
const HOPELESS_DB: f64 = 4.0;
/// Error that halves a band's weight at first, in dB: a band may be followed later.
const HOPELESS_AT_FIRST_DB: f64 = 30.0;
/// Factor from step to step on [`HOPELESS_AT_FIRST_DB`].
const HOPE_LEFT: f64 = 0.9;
/// Number of steps after which the bands' weights are computed anew.
const WEIGHED: usize = 5;
/// Price of an offset of a band's level at all times, in dB a dB: decay comes before colour.
const OFFSET_PRICE: f64 = 0.15;
/// Price of a change of the filter's shape from knot to knot, in dB a unit.
///
/// Between knots that differ much, the interpolated filter's level is not the interpolated level.
const MOTION_PRICE: f64 = 0.3;
/// Price of a loop gain beyond [`DEAR_GAIN`], in dB a unit.
const GAIN_PRICE: f64 = 200.0;
/// Loop gain from which [`GAIN_PRICE`] applies.
const DEAR_GAIN: f64 = MOST_LOOP_GAIN - 0.013;
/// Largest loop gain to which a step may lead.
const LARGEST_GAIN: f64 = 1.01;
/// Number of times between two at which the loop gain is computed.
const TIMES_A_GAIN: usize = 2;
/// Maximum number of steps of a descent from a first guess.
const STEPS: usize = 80;
/// Minimum number of steps of a descent from a first guess.
const LEAST_STEPS: usize = 25;
/// Maximum number of steps of a descent that follows another.
const STEPS_TO_FOLLOW: usize = 20;
/// Relative gain in the sum of squares below which a step is idle.
const IDLE: f64 = 1e-3;
/// Number of idle steps in a row that end a descent.
const IDLE_STEPS: usize = 5;
/// Largest damping.
const STIFFEST: f64 = 1e8;

/// Weighted errors in dB, and the largest loop gain.
struct Errors {
    all: DVector<f64>,
    largest_gain: f64,
}

impl Ringing {
    /// Descends from a first guess to the numbers whose band levels come nearest to the law.
    pub(crate) fn descend(&self, objective: &Objective) -> Self {
        self.search(objective, vec![1.0; objective.rates.len()], STEPS, LEAST_STEPS, HOPELESS_AT_FIRST_DB)
    }

    /// Descends from numbers that were found for a slightly different law.
    pub(crate) fn follow(&self, objective: &Objective) -> Self {
        self.search(objective, self.trust(objective, HOPELESS_DB), STEPS_TO_FOLLOW, 0, HOPELESS_DB)
    }

    fn search(
        &self,
        objective: &Objective,
        mut trust: Vec<f64>,
        steps: usize,
        least_steps: usize,
        hopeless_db: f64,
    ) -> Self {
        let mut now = self.clone();
        now.bound();
        let mut errors = now.errors(objective, &trust);
        let (mut damping, mut idle) = (1e-2, 0);
        for step in 0..steps {
            if step % WEIGHED == WEIGHED - 1 {
                let hope_db = hopeless_db * HOPE_LEFT.powf(step as f64);
                trust = now.trust(objective, HOPELESS_DB.max(hope_db));
                errors = now.errors(objective, &trust);
            }
            let slopes = now.slopes(objective, &trust, &errors.all);
            let Some((moved, after)) = now.step(objective, &trust, &errors, &slopes, &mut damping) else { break };
            let (before, left) = (errors.all.norm_squared(), after.all.norm_squared());
            idle = if before - left < IDLE * (1.0 + left) { idle + 1 } else { 0 };
            (now, errors) = (moved, after);
            if idle >= IDLE_STEPS && step >= least_steps {
                break;
            }
        }
        now
    }

    /// Derivatives of all errors by each free number.
    fn slopes(&self, objective: &Objective, trust: &[f64], errors: &DVector<f64>) -> DMatrix<f64> {
        const NUDGE: f64 = 1e-4;
        let column = |index: usize| {
            let mut nudged = self.clone();
            if let Some(number) = nudged.free.get_mut(index) {
                *number += NUDGE;
            }
            (nudged.errors(objective, trust).all - errors) / NUDGE
        };
        let columns: Vec<DVector<f64>> = (0..self.free.len()).into_par_iter().map(column).collect();
        DMatrix::from_columns(&columns)
    }

    /// Gauss-Newton step with Levenberg's damping, which rises until the errors fall and the loops
    /// stay stable.
    ///
    /// `None` if no damping helps.
    fn step(
        &self,
        objective: &Objective,
        trust: &[f64],
        errors: &Errors,
        slopes: &DMatrix<f64>,
        damping: &mut f64,
    ) -> Option<(Self, Errors)> {
        let (gradient, curvature) = (slopes.tr_mul(&errors.all), slopes.tr_mul(slopes));
        while *damping <= STIFFEST {
            let mut damped = curvature.clone();
            for index in 0..self.free.len() {
                damped[(index, index)] += *damping * (damped[(index, index)] + 1e-3);
            }
            let step = damped.cholesky()?.solve(&gradient);
            let mut tried = self.clone();
            tried.free.iter_mut().zip(step.iter()).for_each(|(number, step)| *number -= step.clamp(-1.0, 1.0));
            tried.bound();
            let after = tried.errors(objective, trust);
            let stable = after.largest_gain <= errors.largest_gain.max(LARGEST_GAIN);
            if stable && after.all.norm_squared() < errors.all.norm_squared() {
                *damping = (0.2 * *damping).max(1e-9);
                return Some((tried, after));
            }
            *damping *= 10.0;
        }
        None
    }

    /// Weight of each band, from 1 for a band without error down to 0.
    fn trust(&self, objective: &Objective, hopeless_db: f64) -> Vec<f64> {
        let powers = self.powers(objective, &self.decoded(&objective.times_s));
        let mut sums = vec![(0.0, 1e-9); objective.rates.len()];
        for (row, error) in objective.rows.iter().zip(self.row_errors(objective, &powers)) {
            if let Some((sum, weight)) = sums.get_mut(row.band) {
                *sum += row.weight * error * error;
                *weight += row.weight;
            }
        }
        sums.into_iter().map(|(sum, weight)| (1.0 + sum / weight / hopeless_db.powi(2)).recip()).collect()
    }

    fn row_errors(&self, objective: &Objective, powers: &[Vec<f64>]) -> Vec<f64> {
        let offsets = self.first_of_offsets();
        let of_row = |row: &crate::dynamic_filter::objective::Row| {
            let offset_db = self.free.get(offsets + row.band).copied().unwrap_or(0.0);
            row.error_db(powers, offset_db)
        };
        objective.rows.iter().map(of_row).collect()
    }

    fn errors(&self, objective: &Objective, trust: &[f64]) -> Errors {
        let decoded = self.decoded(&objective.times_s);
        let powers = self.powers(objective, &decoded);
        let rows = objective.rows.iter().zip(self.row_errors(objective, &powers)).map(|(row, error)| {
            let trust = trust.get(row.band).copied().unwrap_or(1.0);
            (trust * row.weight).sqrt() * error
        });
        let (a_knot, shapes) = (self.a_knot(), self.free.iter().take(self.first_of_loops()));
        let motion = shapes.clone().skip(a_knot).zip(shapes).enumerate().map(|(index, (now, before))| {
            // Gain and level are free to move.
            if index % a_knot < 2 { 0.0 } else { MOTION_PRICE * (now - before) }
        });
        let offsets = self.free.iter().skip(self.first_of_offsets()).map(|offset| OFFSET_PRICE * offset);
        let gains = self.largest_gains(&decoded);
        let largest_gain = gains.iter().copied().fold(0.0, f64::max);
        let dear = gains.into_iter().map(|gain| GAIN_PRICE * (gain - DEAR_GAIN).max(0.0));
        let all: Vec<f64> = rows.chain(motion).chain(offsets).chain(dear).collect();
        Errors { all: DVector::from_vec(all), largest_gain }
    }

    /// Largest loop gain over time, at each sample point of the circle.
    fn largest_gains(&self, decoded: &Decoded) -> Vec<f64> {
        if self.loops.is_empty() {
            return Vec::new();
        }
        let centres_hz: Vec<f64> = self.loops.iter().map(|(hz, _)| *hz).collect();
        let circle = Circle::new(&decoded.bands, &decoded.gains, &centres_hz, &decoded.widths_hz);
        let looked_at = decoded.filters.iter().take(self.end()).step_by(TIMES_A_GAIN);
        let last = decoded.filters.get(self.end());
        let mut largest: Vec<f64> = Vec::new();
        for filter in looked_at.chain(last) {
            let gains = circle.gains_round(filter);
            largest.resize(gains.len(), 0.0);
            largest.iter_mut().zip(gains).for_each(|(largest, gain)| *largest = largest.max(gain));
        }
        largest
    }
}
