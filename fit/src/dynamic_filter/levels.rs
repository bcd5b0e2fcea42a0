//! First path: at each time the filter whose band levels come nearest to the law.

use nalgebra::{DMatrix, DVector};

use super::lattice::{Lattice, WIDEST};
use super::model::Form;
use super::response::NoiseBand;

/// Fall of a band in dB after which its level no longer matters: its decay is read off the first 40
/// dB.
const HEARD_DB: f64 = 45.0;
/// Weight of a band that has faded; only levels above the law's count then.
const FADED_WEIGHT: f64 = 0.05;
/// Price of moving a free number away from its value at the time before, in dB a unit.
const INERTIA_DB: f64 = 0.3;
/// Maximum number of steps of a search.
const STEPS: usize = 40;

/// Level that the law asks of one band, over time.
#[derive(Clone, Debug)]
pub(crate) struct Target {
    /// Response of the band to the filter's noise.
    pub(crate) noise_band: NoiseBand,
    /// Level of the band's envelope at the strike, in dB.
    pub(crate) level_db: f64,
    /// Decay of that level in dB/s.
    pub(crate) decay_db_per_s: f64,
}

impl Target {
    fn level_db_at(&self, time_s: f64) -> f64 {
        self.level_db - self.decay_db_per_s * time_s
    }
}

/// Filters at `times_s`, each nearest to the targets by least squares of decibels.
///
/// Eq. 19 is this criterion for three bands, in amplitudes; in decibels a decay is a straight line.
/// The search at each time starts from the filter at the time before.
pub(crate) fn follow(form: Form, targets: &[Target], times_s: &[f64]) -> Vec<Lattice> {
    let mut path: Vec<Lattice> = Vec::with_capacity(times_s.len());
    for &time_s in times_s {
        let moment = Moment { targets, time_s, before: path.last() };
        let next = match path.last() {
            Some(before) => moment.descend(before.clone()).0,
            None => {
                let found = moment.starts(form).into_iter().map(|start| moment.descend(start));
                let best = found.min_by(|a, b| a.1.total_cmp(&b.1));
                best.map_or_else(|| Lattice::flat(form, 1.0), |(filter, _)| filter)
            }
        };
        path.push(next);
    }
    path
}

fn level_db(target: &Target, filter: &Lattice) -> f64 {
    10.0 * target.noise_band.power(filter.squared()).max(1e-30).log10()
}

/// Search for the filter at one time.
struct Moment<'a> {
    targets: &'a [Target],
    time_s: f64,
    before: Option<&'a Lattice>,
}

impl Moment<'_> {
    /// Starts of the first search: flat, low-passes, high-passes and humps at the bands' mean
    /// level.
    fn starts(&self, form: Form) -> Vec<Lattice> {
        let flat = Lattice::flat(form, 1.0);
        let above: Vec<f64> =
            self.targets.iter().map(|target| target.level_db_at(self.time_s) - level_db(target, &flat)).collect();
        let gain = 10f64.powf(above.iter().sum::<f64>() / above.len().max(1) as f64 / 20.0);
        let shapes: &[[f64; 4]] = match form {
            Form::FirstOrder | Form::OnePoleOneZero => &[[0.0; 4], [-1.5, 0.0, 0.0, 0.0], [1.0, 0.0, 0.0, 0.0]],
            Form::SecondOrder => &[
                [0.0; 4],
                [-1.5, 0.0, 0.0, 0.0],
                [-1.5, 1.0, 0.0, 0.0],
                [-2.0, 0.5, -1.0, 0.0],
                [-2.5, 1.0, -1.5, 0.5],
                [1.0, 0.5, 0.0, 0.0],
            ],
        };
        let start = |shape: &[f64; 4]| {
            let mut lattice = Lattice::flat(form, gain);
            lattice.free.iter_mut().skip(1).zip(shape).for_each(|(free, shape)| *free = *shape);
            lattice
        };
        shapes.iter().map(start).collect()
    }

    /// Weighted errors in dB.
    fn errors(&self, filter: &Lattice) -> DVector<f64> {
        let bands = self.targets.iter().map(|target| {
            let error = level_db(target, filter) - target.level_db_at(self.time_s);
            let heard = target.decay_db_per_s * self.time_s < HEARD_DB;
            if heard { error } else { FADED_WEIGHT.sqrt() * error.max(0.0) }
        });
        let inert = self.before.into_iter().flat_map(|before| {
            filter.free.iter().zip(&before.free).skip(1).map(|(now, before)| INERTIA_DB * (now - before))
        });
        let count = self.targets.len() + if self.before.is_some() { filter.free.len() - 1 } else { 0 };
        DVector::from_iterator(count, bands.chain(inert))
    }

    /// Gauss-Newton descent with Levenberg's damping; returns the filter and its sum of squared
    /// errors.
    fn descend(&self, start: Lattice) -> (Lattice, f64) {
        const NUDGE: f64 = 1e-4;
        let mut filter = start;
        let mut errors = self.errors(&filter);
        let mut damping = 1e-2;
        for _ in 0..STEPS {
            let mut slopes = DMatrix::zeros(errors.len(), filter.free.len());
            for index in 0..filter.free.len() {
                let mut nudged = filter.clone();
                nudged.free[index] += NUDGE;
                slopes.set_column(index, &((self.errors(&nudged) - &errors) / NUDGE));
            }
            let mut curvature = slopes.tr_mul(&slopes);
            for index in 0..filter.free.len() {
                curvature[(index, index)] += damping * (curvature[(index, index)] + 1e-3);
            }
            let Some(step) = curvature.cholesky().map(|factors| factors.solve(&slopes.tr_mul(&errors))) else { break };
            let mut tried = filter.clone();
            for (index, free) in tried.free.iter_mut().enumerate() {
                *free -= step[index].clamp(-1.0, 1.0);
                if index > 0 {
                    *free = free.clamp(-WIDEST, WIDEST);
                }
            }
            let after = self.errors(&tried);
            let gained = errors.norm_squared() - after.norm_squared();
            if gained > 0.0 {
                (filter, errors) = (tried, after);
                damping = (0.3 * damping).max(1e-9);
                if gained < 1e-6 * (1.0 + errors.norm_squared()) {
                    break;
                }
            } else {
                damping *= 10.0;
                if damping > 1e8 {
                    break;
                }
            }
        }
        let sum = errors.norm_squared();
        (filter, sum)
    }
}
