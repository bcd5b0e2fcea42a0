//! First estimate of contacts where each strike has a position of its own, or its own striker.
//!
//! Modes of a thing have real shapes: the gain of mode k at position x is `e^{jθ_k} φ_k(x)`. A
//! strike changes its amplitude by `a = m e^{jθ} φ(x) Q(τ) e^{-sδ}`, Q almost real. So `a²` has the
//! phase `2θ - 2ωδ` whatever position, contact time and signs are: δ comes first. Then all
//! amplitudes are real, and positions are the order in which strikes resemble one another (the
//! second eigenvector of their graph's Laplacian). Gains along the object, and contact time and
//! position of each strike on a grid, are improved in turn.

use std::f64::consts::TAU;

use nalgebra::{Complex, DMatrix, DVector};
use rayon::prelude::*;

use super::amplitudes::Change;
use super::contact::{Contact, strength};
use super::contact_grid::{contact_times, exponents_of};
use super::layout::Layout;
use super::model::{Model, Strike};
use super::seriation;
use super::spline::Weights;
use super::start::strongest_but;
use super::strikers::assigned;
use super::timing::{Turned, timed, turned};
use crate::modes::Pole;

type C64 = Complex<f64>;

/// Number of contact times that are tried for the strongest strike.
const TRIED: usize = 16;
/// Number of contact times on a strike's own grid.
const TIMES: usize = 40;
/// Number of positions on a strike's own grid.
const POSITIONS: usize = 41;
/// Errors of a modelled amplitude that are allowed for in each round, as shares of it.
const TOLERANCES: [f64; 12] = [0.5, 0.4, 0.3, 0.25, 0.2, 0.15, 0.12, 0.1, 0.08, 0.06, 0.05, 0.05];
/// Round from which on a mode may be a striker's own.
const OWNED_FROM: usize = 3;
/// Number of halvings of the steps about the best point of the grid.
const HALVINGS: usize = 5;

/// Contact time, position and peak of a strike while they are improved.
#[derive(Clone, Copy, Debug)]
struct Trial {
    time: f64,
    position: f64,
    peak: f64,
    striker: usize,
}

/// Starting models from changes of amplitudes, one for each contact time tried, the best first.
///
/// Times and levels begin from the strongest strike, once `attempt` stronger ones are passed over.
pub(crate) fn starts_at_places(
    changes: &[Change],
    poles: &[Pole],
    rate_hz: f64,
    layout: Layout,
    attempt: usize,
) -> Vec<Model> {
    let exponents = exponents_of(poles);
    let Some((shifts, phases)) = timed(changes, &exponents, rate_hz, attempt) else { return Vec::new() };
    let turned: Vec<Turned> =
        changes.iter().zip(&shifts).map(|(change, shift)| turned(change, *shift, &exponents, &phases)).collect();
    let loudness =
        |strike: &Turned| strike.values.iter().zip(&strike.variances).map(|(x, v)| (1.0 + x * x / v).ln()).sum::<f64>();
    let all: Vec<f64> = turned.iter().map(loudness).collect();
    let Some(strongest) = strongest_but(&all, attempt) else { return Vec::new() };
    let search =
        Search { changes, turned: &turned, shifts: &shifts, phases: &phases, poles, exponents, rate_hz, layout };
    let mut found: Vec<(f64, Model)> =
        contact_times(TRIED, rate_hz).into_par_iter().map(|time| search.of_trial(strongest, time)).collect();
    found.sort_by(|a, b| a.0.total_cmp(&b.0));
    found.into_iter().map(|(_, model)| model).collect()
}

struct Search<'a> {
    changes: &'a [Change],
    turned: &'a [Turned],
    shifts: &'a [f64],
    phases: &'a [f64],
    poles: &'a [Pole],
    exponents: Vec<C64>,
    rate_hz: f64,
    layout: Layout,
}

impl Search<'_> {
    /// Model for a contact time of the strongest strike, with its misfit.
    fn of_trial(&self, strongest: usize, time: f64) -> (f64, Model) {
        let times = self.times(strongest, time);
        let positions = self.positions(&times);
        let mut trials: Vec<Trial> = (times.iter().zip(positions))
            .map(|(time, position)| Trial { time: *time, position, peak: 1.0, striker: 0 })
            .collect();
        for (index, trial) in trials.iter_mut().enumerate() {
            let strengths = self.strengths(trial.time);
            let size = strengths.iter().map(|q| q * q).sum::<f64>();
            let energy = self.turned[index].values.iter().map(|x| x * x).sum::<f64>();
            trial.peak = (energy / size.max(1e-300)).sqrt();
        }
        let mut owners = vec![None; self.poles.len()];
        let mut gains = Vec::new();
        for (round, tolerance) in TOLERANCES.into_iter().enumerate() {
            gains = self.gains(&trials, &owners, tolerance);
            self.improve(&mut trials, &gains, &owners, tolerance, round + 3 > TOLERANCES.len());
            spread_out(&mut trials);
            if round >= OWNED_FROM {
                let model = self.model(&trials, &gains, &owners);
                let model = assigned(&model, self.changes, self.layout.strikers, self.layout.positions, self.rate_hz);
                owners.clone_from(&model.owners);
                // The strikes of the model are in order of time, as the changes are.
                trials.iter_mut().zip(&model.strikes).for_each(|(trial, strike)| trial.striker = strike.striker);
            }
        }
        let last = TOLERANCES[TOLERANCES.len() - 1];
        if !gains.is_empty() {
            gains = self.gains(&trials, &owners, last);
        }
        let misfit = |(index, trial): (usize, &Trial)| {
            let own = self.misfit(index, *trial, &gains, &owners, last).0;
            (1.0 + own / self.poles.len() as f64).ln()
        };
        let misfit = trials.iter().enumerate().map(misfit).sum();
        let mut model = self.model(&trials, &gains, &owners);
        model.strikes.sort_by(|a, b| a.contact.middle.total_cmp(&b.contact.middle));
        model.normalise();
        (misfit, model)
    }

    fn strengths(&self, time: f64) -> Vec<f64> {
        self.exponents.iter().map(|s| strength(*s, time).value.re).collect()
    }

    /// Contact time of each strike by the fall of its spectrum, whatever the shapes are.
    ///
    /// Levels of the modes are those of the median strike; positions scatter about them.
    fn times(&self, strongest: usize, time: f64) -> Vec<f64> {
        let grid = contact_times(TIMES, self.rate_hz);
        let falls: Vec<Vec<f64>> = grid
            .iter()
            .map(|time| self.strengths(*time).iter().map(|q| (q.abs() + 1e-3 * time).ln()).collect())
            .collect();
        let levels: Vec<Vec<f64>> = self
            .turned
            .iter()
            .map(|strike| strike.values.iter().zip(&strike.variances).map(|(x, v)| 0.5 * (x * x + v).ln()).collect())
            .collect();
        let weights: Vec<Vec<f64>> = self
            .turned
            .iter()
            .map(|strike| strike.values.iter().zip(&strike.variances).map(|(x, v)| x * x / (x * x + 9.0 * v)).collect())
            .collect();
        let start = self.strengths(time);
        let mut modes: Vec<f64> =
            levels[strongest].iter().zip(&start).map(|(level, q)| level - (q.abs() + 1e-3 * time).ln()).collect();
        let mut chosen = vec![0; levels.len()];
        for _ in 0..6 {
            for (strike, chosen) in chosen.iter_mut().enumerate() {
                let misfit = |fall: &Vec<f64>| {
                    let apart: Vec<(f64, f64)> = (0..modes.len())
                        .map(|mode| (levels[strike][mode] - modes[mode] - fall[mode], weights[strike][mode]))
                        .collect();
                    let mean = weighted_median(&apart);
                    apart.iter().map(|(x, w)| w * (x - mean).abs().min(2.0)).sum::<f64>()
                };
                let misfits: Vec<f64> = falls.iter().map(misfit).collect();
                *chosen = (0..grid.len()).min_by(|a, b| misfits[*a].total_cmp(&misfits[*b])).unwrap_or(0);
            }
            for (mode, level) in modes.iter_mut().enumerate() {
                let peaks = (0..levels.len()).map(|strike| {
                    let apart: Vec<(f64, f64)> = (0..self.poles.len())
                        .map(|other| (levels[strike][other] - falls[chosen[strike]][other], weights[strike][other]))
                        .collect();
                    let loudness = weighted_median(&apart);
                    (levels[strike][mode] - falls[chosen[strike]][mode] - loudness, weights[strike][mode])
                });
                *level = weighted_median(&peaks.collect::<Vec<(f64, f64)>>());
            }
        }
        chosen.into_iter().map(|index| grid[index]).collect()
    }

    /// Positions in the order in which strikes resemble one another.
    fn positions(&self, times: &[f64]) -> Vec<f64> {
        if self.layout.positions < 2 {
            return vec![0.0; times.len()];
        }
        let count = self.poles.len();
        let mut shapes: Vec<Vec<(f64, f64)>> = Vec::new();
        for (strike, time) in self.turned.iter().zip(times) {
            let strengths = self.strengths(*time);
            let of_mode = |mode: usize| {
                let q = strengths[mode];
                let q = if q.abs() < 1e-6 * time { 1e-6 * time } else { q };
                (strike.values[mode] / q, strike.variances[mode] / (q * q))
            };
            shapes.push((0..count).map(of_mode).collect());
        }
        // Each strike has a mean square of 1, then each mode.
        for strike in &mut shapes {
            let energy: f64 = strike.iter().map(|(x, v)| x * x / (1.0 + v / (x * x + 1e-300))).sum();
            strike.iter_mut().for_each(|(x, v)| (*x, *v) = (*x / energy.sqrt().max(1e-300), *v / energy.max(1e-300)));
        }
        for mode in 0..count {
            let weight = |x: f64, v: f64| x * x / (x * x + 4.0 * v);
            let sum: f64 =
                shapes.iter().map(|strike| weight(strike[mode].0, strike[mode].1) * strike[mode].0.powi(2)).sum();
            let size: f64 = shapes.iter().map(|strike| weight(strike[mode].0, strike[mode].1)).sum();
            let mean = (sum / size.max(1e-300)).max(1e-300);
            shapes.iter_mut().for_each(|strike| strike[mode] = (strike[mode].0 / mean.sqrt(), strike[mode].1 / mean));
        }
        seriation::positions(&shapes)
    }

    /// Gains of all modes at given contacts and positions: coefficients along the object, real.
    fn gains(&self, trials: &[Trial], owners: &[Option<usize>], tolerance: f64) -> Vec<Vec<f64>> {
        let strengths: Vec<Vec<f64>> = trials.iter().map(|trial| self.strengths(trial.time)).collect();
        let of_mode = |mode: usize| {
            let size = if owners[mode].is_some() { 1 } else { self.layout.positions };
            let (mut normal, mut right) = (DMatrix::<f64>::zeros(size, size), DVector::<f64>::zeros(size));
            for ((trial, strength), strike) in trials.iter().zip(&strengths).zip(self.turned) {
                if owners[mode].is_some_and(|owner| owner != trial.striker) {
                    continue;
                }
                let shape = trial.peak * strength[mode];
                let value = strike.values[mode];
                let weight = 1.0
                    / (strike.variances[mode] + (tolerance * value).powi(2) + (0.1 * tolerance * shape * 1e-6).powi(2));
                let weights = Weights::at(trial.position, size);
                for (a, x) in weights.values().iter().enumerate() {
                    right[weights.first + a] += weight * shape * x * value;
                    for (b, y) in weights.values().iter().enumerate() {
                        normal[(weights.first + a, weights.first + b)] += weight * shape * shape * x * y;
                    }
                }
            }
            let ridge = 1e-4 * normal.trace() / size as f64 + f64::MIN_POSITIVE;
            (0..size).for_each(|index| normal[(index, index)] += ridge);
            normal.cholesky().map_or(vec![0.0; size], |factor| factor.solve(&right).iter().copied().collect())
        };
        (0..self.poles.len()).map(of_mode).collect()
    }

    /// Remainder of a strike's amplitudes behind a contact, with the peak that leaves least.
    fn misfit(
        &self,
        index: usize,
        trial: Trial,
        gains: &[Vec<f64>],
        owners: &[Option<usize>],
        tolerance: f64,
    ) -> (f64, f64) {
        let strengths = self.strengths(trial.time);
        let shapes = (0..gains.len()).map(|mode| {
            let is_heard = owners[mode].is_none_or(|owner| owner == trial.striker);
            if is_heard { strengths[mode] * value(&gains[mode], trial.position) } else { 0.0 }
        });
        self.misfit_of(index, shapes, tolerance)
    }

    fn misfit_of(&self, index: usize, shapes: impl Iterator<Item = f64>, tolerance: f64) -> (f64, f64) {
        let strike = &self.turned[index];
        let (mut along, mut size, mut energy) = (0.0, 1e-300, 0.0);
        for ((shape, value), variance) in shapes.zip(&strike.values).zip(&strike.variances) {
            let weight = 1.0 / (variance + (tolerance * value).powi(2));
            along += weight * shape * value;
            size += weight * shape * shape;
            energy += weight * value * value;
        }
        if along <= 0.0 { (energy, 0.0) } else { (energy - along * along / size, along / size) }
    }

    /// Improves contact time, position and peak of each strike at given gains.
    fn improve(
        &self,
        trials: &mut [Trial],
        gains: &[Vec<f64>],
        owners: &[Option<usize>],
        tolerance: f64,
        is_fine: bool,
    ) {
        let times = contact_times(TIMES, self.rate_hz);
        let strengths: Vec<Vec<f64>> = times.iter().map(|time| self.strengths(*time)).collect();
        let count = if self.layout.positions < 2 { 1 } else { POSITIONS };
        let places: Vec<f64> = (0..count).map(|index| index as f64 / (POSITIONS - 1) as f64).collect();
        let at_places: Vec<Vec<f64>> =
            places.iter().map(|place| gains.iter().map(|gains| value(gains, *place)).collect()).collect();
        for (index, trial) in trials.iter_mut().enumerate() {
            let is_heard: Vec<bool> =
                owners.iter().map(|owner| owner.is_none_or(|owner| owner == trial.striker)).collect();
            let mut best = self.misfit(index, *trial, gains, owners, tolerance);
            trial.peak = best.1.max(1e-12);
            for (time, strengths) in times.iter().zip(&strengths) {
                for (place, gains) in places.iter().zip(&at_places) {
                    let shapes = (strengths.iter().zip(gains).zip(&is_heard))
                        .map(|((q, gain), is_heard)| if *is_heard { q * gain } else { 0.0 });
                    let here = self.misfit_of(index, shapes, tolerance);
                    if here.0 < best.0 && here.1 > 0.0 {
                        best = here;
                        *trial = Trial { time: *time, position: *place, peak: here.1, ..*trial };
                    }
                }
            }
            let (mut ratio, mut reach) = (1.1, if count > 1 { 0.02 } else { 0.0 });
            for _ in 0..if is_fine { 2 * HALVINGS } else { HALVINGS } {
                let center = *trial;
                for (time, position) in [
                    (ratio, 0.0),
                    (1.0 / ratio, 0.0),
                    (1.0, reach),
                    (1.0, -reach),
                    (ratio, reach),
                    (1.0 / ratio, -reach),
                    (ratio, -reach),
                    (1.0 / ratio, reach),
                ] {
                    let next = Trial {
                        time: center.time * time,
                        position: (center.position + position).clamp(0.0, 1.0),
                        ..center
                    };
                    let here = self.misfit(index, next, gains, owners, tolerance);
                    if here.0 < best.0 && here.1 > 0.0 {
                        best = here;
                        *trial = Trial { peak: here.1, ..next };
                    }
                }
                if trial.time == center.time && trial.position == center.position {
                    (ratio, reach) = (f64::sqrt(ratio), 0.5 * reach);
                }
            }
        }
    }

    fn model(&self, trials: &[Trial], gains: &[Vec<f64>], owners: &[Option<usize>]) -> Model {
        let strike = |(index, trial): (usize, &Trial)| Strike {
            contact: Contact {
                middle: self.changes[index].at as f64 + self.shifts[index],
                time: trial.time,
                peak: trial.peak,
            },
            position: trial.position,
            striker: trial.striker,
        };
        let turn = |mode: usize| C64::new(0.0, self.phases[mode] % TAU).exp();
        Model {
            poles: self.poles.to_vec(),
            gains: gains
                .iter()
                .enumerate()
                .map(|(mode, gains)| gains.iter().map(|gain| turn(mode) * *gain).collect())
                .collect(),
            owners: owners.to_vec(),
            acceleration: 0.0,
            contact_times_are_held: false,
            shapes_are_real: true,
            strikes: trials.iter().enumerate().map(strike).collect(),
        }
    }
}

/// Value of a real spline at a position.
fn value(gains: &[f64], position: f64) -> f64 {
    Weights::at(position, gains.len()).sum(gains)
}

/// Stretches positions to the whole object.
fn spread_out(trials: &mut [Trial]) {
    let least = trials.iter().map(|trial| trial.position).fold(f64::INFINITY, f64::min);
    let most = trials.iter().map(|trial| trial.position).fold(f64::NEG_INFINITY, f64::max);
    if most > least {
        trials.iter_mut().for_each(|trial| trial.position = (trial.position - least) / (most - least));
    }
}

/// Value on either side of which values have half of all weights.
fn weighted_median(values: &[(f64, f64)]) -> f64 {
    let mut sorted = values.to_vec();
    sorted.sort_by(|a, b| a.0.total_cmp(&b.0));
    let half = 0.5 * sorted.iter().map(|(_, weight)| weight).sum::<f64>();
    let mut sum = 0.0;
    for (value, weight) in &sorted {
        sum += weight;
        if sum >= half {
            return *value;
        }
    }
    0.0
}
