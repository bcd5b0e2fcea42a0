//! The modal estimator: search, joint refinement and pruning until no more modes are found.

use super::damped_sine::DampedSine;
use super::noise::NoiseFloor;
use super::pole::Pole;
use super::refine::{Ending, Group, Model, refine};
use super::search::{Candidate, Range, search};

/// Settings of the modal estimator.
#[derive(Clone, Copy, Debug)]
pub struct Settings {
    /// Maximum number of modes.
    pub most_modes: usize,
    /// Fastest decay of a mode in 1/s.
    pub fastest_decay_per_s: f64,
    /// Lowest frequency of a mode in Hz.
    pub lowest_hz: f64,
}

impl Default for Settings {
    /// 64 modes, decays up to 1500/s (T60 4.6 ms), from 30 Hz.
    fn default() -> Self {
        Self { most_modes: 64, fastest_decay_per_s: 1500.0, lowest_hz: 30.0 }
    }
}

/// Estimates the modes that ring freely from the first sample on, loudest energy first.
///
/// `samples` have full scale 1 and the rate `rate_hz`. The number of modes follows from the sound:
/// each has to explain more energy than the Bayesian information criterion asks of its four
/// numbers, at the noise floor round its frequency.
pub fn estimate(samples: &[f64], rate_hz: f64, settings: Settings) -> Vec<DampedSine> {
    let Some(model) = model(samples, rate_hz, settings) else { return Vec::new() };
    let gains = model.gains.iter().flat_map(|gains| &gains.modes);
    let mut modes: Vec<(f64, DampedSine)> = model
        .poles
        .iter()
        .zip(gains)
        .enumerate()
        .map(|(mode, (pole, gain))| {
            let sine = DampedSine {
                frequency_hz: pole.frequency_hz(rate_hz),
                decay_per_s: pole.decay_per_s(rate_hz),
                amplitude: gain.norm(),
                phase: gain.arg(),
            };
            (model.worth(mode), sine)
        })
        .collect();
    modes.sort_by(|a, b| b.0.total_cmp(&a.0));
    modes.into_iter().map(|(_, sine)| sine).collect()
}

/// Poles of the modes that [`estimate`] finds.
pub(crate) fn estimate_poles(samples: &[f64], rate_hz: f64, settings: Settings) -> Vec<Pole> {
    model(samples, rate_hz, settings).map_or(Vec::new(), |model| model.poles)
}

/// Maximum number of passes of search and refinement.
const PASSES: usize = 24;
/// Maximum number of passes after which modes explain a sound or do not.
const EXPLAINING_PASSES: usize = 6;
/// Maximum number of passes that add to modes that are known.
const FILLING_PASSES: usize = 3;
/// Number of candidates that are looked at for each mode that may be added.
const SPARE: usize = 4;
/// Refinement of modes that are known, and of those added to them.
const FILLING: Ending = Ending { steps: 4, ridge: 2e-3, ..Ending::COARSE };

/// Known modes, with the most significant of those that they leave added to them.
///
/// If they are to be `apart`, none lies within the width of a known one. All are refined together.
/// Modes that leave the range of the search are dropped.
pub(crate) fn filled(samples: &[f64], rate_hz: f64, settings: Settings, known: &[Pole], apart: bool) -> Option<Model> {
    let groups = [Group::ringing(samples)];
    let range = range(samples.len(), rate_hz, settings);
    let threshold = 4.0 * (samples.len() as f64).ln();
    let mut model = refine(&groups, known, Ending { steps: 0, ..FILLING })?;
    for _ in 0..FILLING_PASSES {
        let residual = model.residual(0, &groups[0].stretches[0]);
        let noise = NoiseFloor::of_residual(&residual);
        let free = settings.most_modes.saturating_sub(model.poles.len());
        // Within the width of a known mode a further one may cancel with it.
        let is_apart = |candidate: &Candidate| {
            let pole = candidate.pole;
            model.poles.iter().all(|known| (known.angular - pole.angular).abs() > known.decay + pole.decay)
        };
        let mut candidates = search(&residual, &noise, range, threshold, if apart { SPARE * free } else { free });
        candidates.retain(|candidate| !apart || is_apart(candidate));
        candidates.truncate(free);
        if candidates.is_empty() {
            break;
        }
        let mut poles = model.poles.clone();
        poles.extend(candidates.iter().map(|candidate| candidate.pole));
        model = within(&groups, refine(&groups, &poles, FILLING)?, range)?;
    }
    Some(model)
}

/// True if fewer than the maximum number of modes leave nothing significant after a few passes.
pub(crate) fn explains(samples: &[f64], rate_hz: f64, settings: Settings) -> bool {
    let groups = [Group::ringing(samples)];
    let range = range(samples.len(), rate_hz, settings);
    let threshold = 4.0 * (samples.len() as f64).ln();
    let mut poles: Vec<Pole> = Vec::new();
    let mut residual = samples.to_vec();
    for _ in 0..EXPLAINING_PASSES {
        let noise = NoiseFloor::of_residual(&residual);
        let candidates = search(&residual, &noise, range, threshold, settings.most_modes);
        if candidates.is_empty() {
            return true;
        }
        poles.extend(candidates.iter().map(|candidate| candidate.pole));
        if poles.len() >= settings.most_modes {
            return false;
        }
        let Some(model) = refine(&groups, &poles, Ending::COARSE) else { return false };
        residual = model.residual(0, &groups[0].stretches[0]);
        poles = model.poles;
    }
    false
}

fn range(length: usize, rate_hz: f64, settings: Settings) -> Range {
    Range {
        slowest: 0.5 / length as f64,
        fastest: (settings.fastest_decay_per_s / rate_hz).min(0.3),
        angular: (std::f64::consts::TAU * settings.lowest_hz / rate_hz, std::f64::consts::PI * 0.999),
    }
}

fn model(samples: &[f64], rate_hz: f64, settings: Settings) -> Option<Model> {
    let length = samples.len();
    if length < 64 {
        return None;
    }
    let groups = [Group::ringing(samples)];
    let range = range(length, rate_hz, settings);
    // A mode has four numbers, each of which has to explain ln N times the noise.
    let threshold = 4.0 * (length as f64).ln();
    let mut model = Model { poles: Vec::new(), gains: Vec::new(), worth_by_group: Vec::new() };
    let mut residual = samples.to_vec();
    let mut noise = NoiseFloor::of_residual(&residual);
    for _ in 0..PASSES {
        let candidates = search(
            &residual,
            &noise,
            range,
            threshold,
            settings.most_modes - model.poles.len().min(settings.most_modes),
        );
        if candidates.is_empty() {
            break;
        }
        let mut poles = model.poles.clone();
        poles.extend(candidates.iter().map(|candidate| candidate.pole));
        let Some(more) = refine(&groups, &poles, Ending::COARSE)
            .and_then(|more| within(&groups, more, range))
            .and_then(|more| prune(&groups, more, &noise, threshold, Ending::COARSE))
        else {
            break;
        };
        model = more;
        residual = model.residual(0, &groups[0].stretches[0]);
        noise = NoiseFloor::of_residual(&residual);
        if model.poles.len() >= settings.most_modes {
            break;
        }
    }
    let model = refine(&groups, &model.poles, Ending::FINE)?;
    prune(&groups, within(&groups, model, range)?, &noise, threshold, Ending::FINE)
}

/// Removes poles that have left the range of the search: they are drifts and clicks, not modes.
fn within(groups: &[Group<'_>], model: Model, range: Range) -> Option<Model> {
    let (lowest, highest) = range.angular;
    let strayed =
        |pole: &Pole| pole.angular < 0.9 * lowest || pole.angular > highest || pole.decay > 1.5 * range.fastest;
    let outside: Vec<usize> = (0..model.poles.len()).filter(|&k| strayed(&model.poles[k])).collect();
    if outside.is_empty() { Some(model) } else { refine(groups, &model.without(&outside), Ending::COARSE) }
}

/// Removes modes that explain too little, the least worthy first, and refines the others.
fn prune(groups: &[Group<'_>], model: Model, noise: &NoiseFloor, threshold: f64, ending: Ending) -> Option<Model> {
    let mut model = model;
    loop {
        let unworthy: Vec<usize> = (0..model.poles.len())
            .filter(|&k| model.worth(k) < threshold * noise.variance(model.poles[k].angular))
            .collect();
        if unworthy.is_empty() {
            return Some(model);
        }
        // Two modes in one place are both worth nothing, so of neighbours only the less worthy is
        // removed at a time.
        let apart = |a: usize, b: usize| {
            let (a, b) = (model.poles[a], model.poles[b]);
            (a.angular - b.angular).abs() > 10.0 * (a.decay + b.decay)
        };
        let mut dropped: Vec<usize> = Vec::new();
        let mut in_order = unworthy;
        in_order.sort_by(|&a, &b| model.worth(a).total_cmp(&model.worth(b)));
        for candidate in in_order {
            if dropped.iter().all(|&other| apart(candidate, other)) {
                dropped.push(candidate);
            }
        }
        model = refine(groups, &model.without(&dropped), ending)?;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::SplitMix64;

    #[test]
    fn a_further_mode_that_is_to_lie_apart_is_not_within_the_width_of_a_known_one() {
        let rate_hz = 44_100.0;
        let sines = [(1_000.0, 0.0), (1_001.0, -6.0), (3_000.0, -26.0)].map(|(frequency_hz, level_db): (f64, f64)| {
            DampedSine { frequency_hz, decay_per_s: 10.0, amplitude: 10f64.powf(level_db / 20.0), phase: 0.4 }
        });
        let mut random = SplitMix64(1);
        let mut sound: Vec<f64> = (0..22_050).map(|_| 1e-4 * random.normal()).collect();
        sines.iter().for_each(|sine| sine.add_to(&mut sound, rate_hz));
        let known = [Pole::new(1_000.0, 10.0, rate_hz)];
        let settings = Settings { most_modes: 2, ..Settings::default() };
        let further_hz = |apart: bool| {
            let model = filled(&sound, rate_hz, settings, &known, apart).expect("it can be solved");
            model.poles.last().expect("a mode").frequency_hz(rate_hz)
        };
        let [anywhere_hz, apart_hz] = [false, true].map(further_hz);
        assert!((anywhere_hz - 1_001.0).abs() < 3.0, "{anywhere_hz} Hz");
        assert!((apart_hz - 3_000.0).abs() < 1.0, "{apart_hz} Hz");
    }
}
