//! The descent: numbers that make what all bands hear decay by the law.

use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;

use super::super::joint::Joint;
use super::super::stability::MOST_LOOP_GAIN;
use super::circle::Circle;
use super::numbers::{Ringing, Spelled};

/// An error in every level of a band by so much counts half, dB; at first by more: what cannot be followed yet may be later.
const HOPELESS_DB: f64 = 4.0;
const HOPELESS_AT_FIRST_DB: f64 = 30.0;
/// What is left of the latter from step to step.
const HOPE_LEFT: f64 = 0.9;
/// Steps after which what bands count is weighed anew.
const WEIGHED: usize = 5;
/// Price of a band's level that is off at all times alike, dB a dB: decay comes before colour.
const OFFSET_PRICE: f64 = 0.15;
/// Price of change of the filter's shape from knot to knot, dB a unit: between knots that differ much, a filter is not what lies between their levels.
const MOTION_PRICE: f64 = 0.3;
/// Price of a gain round the loops beyond this bound, dB a unit ...
const GAIN_PRICE: f64 = 200.0;
const DEAR_GAIN: f64 = MOST_LOOP_GAIN - 0.013;
/// ... and the largest gain that a step may make.
const LARGEST_GAIN: f64 = 1.01;
/// Gains are looked at at every so many times.
const TIMES_A_GAIN: usize = 2;
/// Steps at most, at least, and at most of a descent that follows another; of the sum of squares, a step that gains less than this part is idle, and so many of them end it.
const STEPS: usize = 80;
const LEAST_STEPS: usize = 25;
const STEPS_TO_FOLLOW: usize = 20;
const IDLE: f64 = 1e-3;
const IDLE_STEPS: usize = 5;
/// Largest damping.
const STIFFEST: f64 = 1e8;

/// Errors, weighed, in dB, and the largest gain round the loops.
struct Errors {
    all: DVector<f64>,
    largest_gain: f64,
}

impl Ringing {
    /// The numbers that bring the levels of all bands nearest to the law, from a first guess.
    pub(crate) fn descend(&self, joint: &Joint) -> Self {
        self.search(joint, vec![1.0; joint.rates.len()], STEPS, LEAST_STEPS, HOPELESS_AT_FIRST_DB)
    }

    /// The same from what a descent has found for a law that was a little different.
    pub(crate) fn follow(&self, joint: &Joint) -> Self {
        self.search(joint, self.trust(joint, HOPELESS_DB), STEPS_TO_FOLLOW, 0, HOPELESS_DB)
    }

    fn search(&self, joint: &Joint, mut trust: Vec<f64>, steps: usize, least_steps: usize, hopeless_db: f64) -> Self {
        let mut now = self.clone();
        now.bound();
        let mut errors = now.errors(joint, &trust);
        let (mut damping, mut idle) = (1e-2, 0);
        for step in 0..steps {
            if step % WEIGHED == WEIGHED - 1 {
                let hope_db = hopeless_db * HOPE_LEFT.powf(step as f64);
                trust = now.trust(joint, HOPELESS_DB.max(hope_db));
                errors = now.errors(joint, &trust);
            }
            let slopes = now.slopes(joint, &trust, &errors.all);
            let Some((moved, after)) = now.step(joint, &trust, &errors, &slopes, &mut damping) else { break };
            let (before, left) = (errors.all.norm_squared(), after.all.norm_squared());
            idle = if before - left < IDLE * (1.0 + left) { idle + 1 } else { 0 };
            (now, errors) = (moved, after);
            if idle >= IDLE_STEPS && step >= least_steps {
                break;
            }
        }
        now
    }

    /// What a small change of each number changes.
    fn slopes(&self, joint: &Joint, trust: &[f64], errors: &DVector<f64>) -> DMatrix<f64> {
        const NUDGE: f64 = 1e-4;
        let column = |index: usize| {
            let mut nudged = self.clone();
            if let Some(number) = nudged.free.get_mut(index) {
                *number += NUDGE;
            }
            (nudged.errors(joint, trust).all - errors) / NUDGE
        };
        let columns: Vec<DVector<f64>> = (0..self.free.len()).into_par_iter().map(column).collect();
        DMatrix::from_columns(&columns)
    }

    /// Gauss and Newton's step with Levenberg's damping, which rises until something is gained and loops stay stable; none where nothing helps.
    fn step(
        &self,
        joint: &Joint,
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
            let after = tried.errors(joint, trust);
            let stable = after.largest_gain <= errors.largest_gain.max(LARGEST_GAIN);
            if stable && after.all.norm_squared() < errors.all.norm_squared() {
                *damping = (0.2 * *damping).max(1e-9);
                return Some((tried, after));
            }
            *damping *= 10.0;
        }
        None
    }

    /// What each band's errors count, by how large they are: 1 where there are none.
    fn trust(&self, joint: &Joint, hopeless_db: f64) -> Vec<f64> {
        let powers = self.powers(joint, &self.spelled(&joint.times_s));
        let mut sums = vec![(0.0, 1e-9); joint.rates.len()];
        for (row, error) in joint.rows.iter().zip(self.row_errors(joint, &powers)) {
            if let Some((sum, weight)) = sums.get_mut(row.band) {
                *sum += row.weight * error * error;
                *weight += row.weight;
            }
        }
        sums.into_iter().map(|(sum, weight)| (1.0 + sum / weight / hopeless_db.powi(2)).recip()).collect()
    }

    fn row_errors(&self, joint: &Joint, powers: &[Vec<f64>]) -> Vec<f64> {
        let offsets = self.first_of_offsets();
        let of_row = |row: &super::super::joint::Row| {
            let offset_db = self.free.get(offsets + row.band).copied().unwrap_or(0.0);
            row.error_db(powers, offset_db)
        };
        joint.rows.iter().map(of_row).collect()
    }

    fn errors(&self, joint: &Joint, trust: &[f64]) -> Errors {
        let spelled = self.spelled(&joint.times_s);
        let powers = self.powers(joint, &spelled);
        let rows = joint.rows.iter().zip(self.row_errors(joint, &powers)).map(|(row, error)| {
            let trust = trust.get(row.band).copied().unwrap_or(1.0);
            (trust * row.weight).sqrt() * error
        });
        let (a_knot, shapes) = (self.a_knot(), self.free.iter().take(self.first_of_loops()));
        let motion = shapes.clone().skip(a_knot).zip(shapes).enumerate().map(|(index, (now, before))| {
            // Gain and level may move as they like.
            if index % a_knot < 2 { 0.0 } else { MOTION_PRICE * (now - before) }
        });
        let offsets = self.free.iter().skip(self.first_of_offsets()).map(|offset| OFFSET_PRICE * offset);
        let gains = self.largest_gains(&spelled);
        let largest_gain = gains.iter().copied().fold(0.0, f64::max);
        let dear = gains.into_iter().map(|gain| GAIN_PRICE * (gain - DEAR_GAIN).max(0.0));
        let all: Vec<f64> = rows.chain(motion).chain(offsets).chain(dear).collect();
        Errors { all: DVector::from_vec(all), largest_gain }
    }

    /// The largest gains round the loops over time, at angles all over the circle.
    fn largest_gains(&self, spelled: &Spelled) -> Vec<f64> {
        if self.loops.is_empty() {
            return Vec::new();
        }
        let centres_hz: Vec<f64> = self.loops.iter().map(|(hz, _)| *hz).collect();
        let circle = Circle::new(&spelled.bands, &spelled.gains, &centres_hz, &spelled.widths_hz);
        let looked_at = spelled.filters.iter().take(self.end()).step_by(TIMES_A_GAIN);
        let last = spelled.filters.get(self.end());
        let mut largest: Vec<f64> = Vec::new();
        for filter in looked_at.chain(last) {
            let gains = circle.gains_round(filter);
            largest.resize(gains.len(), 0.0);
            largest.iter_mut().zip(gains).for_each(|(largest, gain)| *largest = largest.max(gain));
        }
        largest
    }
}
