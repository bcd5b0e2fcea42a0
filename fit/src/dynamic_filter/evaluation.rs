//! Evaluation of a model by its rendered sound, and correction of the law that is asked for.

use rayon::prelude::*;

use super::damping::{Comparison, compare, mean_of};
use super::model::{Model, RATE_HZ};
use super::objective::{Candidate, Objective};
use super::response::sine_power_in_band;
use super::sound::render;
use super::times::times_s;
use crate::bark::{DampingLaw, damping_law};
use crate::modes::DampedSine;

/// Number of nepers by which the slowest band of a rendered model decays.
const HEARD_DECAYS: f64 = 7.0;
/// Maximum length of a rendered model, in seconds.
const MOST_HEARD_S: f64 = 3.0;
/// Silence rendered after the end of the noise, in seconds.
const SILENCE_S: f64 = 0.1;
/// Seeds of the rendered noises; the study's seeds are not among them.
const SEEDS: std::ops::Range<u64> = 1001..1017;
/// Number of noises in a set.
const SET: usize = 4;
/// Relative error of α that counts as none: another noise changes α by as much.
const GOOD: f64 = 0.06;
/// Relative error of α from which a band counts as lost.
const WORST: f64 = 0.3;
/// Maximum number of corrections of a candidate.
const ROUNDS: usize = 5;
/// Maximum number of corrections of a candidate with an added mode or loop.
const SHORT_ROUNDS: usize = 2;
/// Share of a mode's power that must lie in a band for the mode to be tried there.
const INSIDE: f64 = 0.2;
/// Number of modes that are tried in a band.
const TRIED: usize = 2;
/// Share of the error in ln α by which a correction moves the law asked for.
const ASKED: f64 = 0.6;
/// Maximum distance in ln α of the law asked for from the recording's law.
const MOST_ASKED: f64 = 0.6;

/// Comparison of a model's rendered sound with a damping law.
#[derive(Clone)]
pub(crate) struct Evaluation {
    /// Comparison of each counted band over all noises.
    bands: Vec<Comparison>,
    /// Number of bands lost, averaged over sets of as many noises as the study takes.
    ///
    /// Each band counts from 0 (error of α negligible) to 1 (band lost).
    pub(crate) missed: f64,
}

/// Renders a model and compares its decays with the law.
///
/// The decays of a few noises are properties of those noises as much as of the model. The best of
/// many models on one set of noises would be one that fits that set, so several sets are rendered
/// and the misses of each are averaged.
pub(crate) fn evaluate(law: &DampingLaw, model: &Model) -> Evaluation {
    let slowest = law.bands.iter().map(|band| band.decay_per_s).fold(f64::INFINITY, f64::min);
    let length_s = (HEARD_DECAYS / slowest).max(model.path.end_s() + SILENCE_S).min(MOST_HEARD_S);
    let length = (length_s * RATE_HZ) as usize;
    let laws: Vec<Option<DampingLaw>> =
        SEEDS.into_par_iter().map(|seed| damping_law(&render(model, length, seed), RATE_HZ)).collect();
    let compared = |laws: &[Option<DampingLaw>]| compare(law, mean_of(laws).as_ref());
    let lost = |band: &Comparison| ((band.error() - GOOD) / (WORST - GOOD)).clamp(0.0, 1.0);
    let sets = laws.chunks_exact(SET);
    let count = sets.len().max(1) as f64;
    let missed = sets.map(|set| compared(set).iter().map(lost).sum::<f64>()).sum::<f64>() / count;
    Evaluation { bands: compared(&laws), missed }
}

/// A candidate with its model and its evaluation.
#[derive(Clone)]
pub(crate) struct Corrected<S> {
    /// Free numbers of the candidate.
    candidate: S,
    /// Law that the descent was asked for.
    asked: DampingLaw,
    /// Model of the candidate.
    pub(crate) model: Model,
    /// Evaluation of the model against the recording's law.
    pub(crate) evaluation: Evaluation,
}

/// Corrects a candidate by its evaluation, and returns the best candidate of all rounds.
///
/// The descent approximates three things: how a band's decay is read off its power, a loop's mode
/// as the steady one, and straight lines between breakpoints. These leave an error in each band
/// that hardly depends on the seed. Each round moves the law asked for against the errors measured,
/// and `descend` starts anew from the last candidate. `model_of` makes the model of a candidate.
pub(crate) fn correct<S: Clone>(
    law: &DampingLaw,
    found: &S,
    model_of: impl Fn(&S) -> Model,
    descend: impl Fn(&DampingLaw, &S) -> S,
) -> Corrected<S> {
    correct_from(law, law.clone(), found.clone(), model_of, descend, ROUNDS)
}

/// The descent of [`Objective`] for a law asked for in place of `law`, at the times of `law`.
pub(crate) fn descend(law: &DampingLaw) -> impl Fn(&DampingLaw, &Candidate) -> Candidate + Copy + use<'_> {
    move |asked, candidate| Objective::new(asked, &times_s(law)).descend(candidate)
}

fn correct_from<S: Clone>(
    law: &DampingLaw,
    mut asked: DampingLaw,
    mut candidate: S,
    model_of: impl Fn(&S) -> Model,
    descend: impl Fn(&DampingLaw, &S) -> S,
    rounds: usize,
) -> Corrected<S> {
    let mut best: Option<Corrected<S>> = None;
    let mut round = 0;
    loop {
        let model = model_of(&candidate);
        let evaluation = evaluate(law, &model);
        let now = Corrected { candidate: candidate.clone(), asked: asked.clone(), model, evaluation };
        for asked in &mut asked.bands {
            let Some(band) = now.evaluation.bands.iter().find(|heard| heard.recorded.bark == asked.bark) else {
                continue;
            };
            let (meant, Some(found)) = (band.recorded.decay_per_s, band.decay_per_s) else { continue };
            let moved = (asked.decay_per_s / meant).ln() + ASKED * (meant / found).ln();
            asked.decay_per_s = meant * moved.clamp(-MOST_ASKED, MOST_ASKED).exp();
        }
        let best = match best.take() {
            Some(before) if before.evaluation.missed <= now.evaluation.missed => best.insert(before),
            _ => best.insert(now),
        };
        if round == rounds || best.evaluation.missed <= 0.0 {
            return best.clone();
        }
        round += 1;
        candidate = descend(&asked, &candidate);
    }
}

/// Modes that a badly kept band may lack: those inside it that are not taken yet, the loudest
/// first.
pub(crate) fn missing_modes(band: &Comparison, modes: &[DampedSine], taken_hz: &[f64]) -> Vec<DampedSine> {
    let heard = |mode: &DampedSine| sine_power_in_band(mode.frequency_hz, band.recorded.bark);
    let is_new = |mode: &&DampedSine| !taken_hz.contains(&mode.frequency_hz);
    let mut there: Vec<DampedSine> = modes.iter().filter(|mode| heard(mode) > INSIDE).filter(is_new).copied().collect();
    there.sort_by(|a, b| (heard(b) * b.amplitude.powi(2)).total_cmp(&(heard(a) * a.amplitude.powi(2))));
    there.truncate(TRIED);
    there
}

/// Adds what `offered` proposes for the worst bands, as long as the evaluation improves.
///
/// At most `bands` bands are tried, the worst first. A prediction judges each mode alone; where
/// noise interferes, only the fit of all modes together tells. `told` gets the share of the bands
/// that are tried.
pub(crate) fn complete<S: Clone + Send + Sync>(
    law: &DampingLaw,
    corrected: Corrected<S>,
    bands: usize,
    told: &(dyn Fn(f64) + Sync),
    offered: impl Fn(&S, &Comparison) -> Vec<S> + Sync,
    model_of: impl Fn(&S) -> Model + Sync,
    descend: impl Fn(&DampingLaw, &S) -> S + Sync,
) -> Corrected<S> {
    let mut best = corrected;
    let mut given_up = Vec::new();
    for band in 0..bands {
        told(band as f64 / bands as f64);
        let is_open = |band: &&Comparison| band.error() > GOOD && !given_up.contains(&band.recorded.bark);
        let worst = best.evaluation.bands.iter().filter(is_open).max_by(|a, b| a.error().total_cmp(&b.error()));
        let Some(worst) = worst.copied() else { break };
        let tried: Vec<Corrected<S>> = offered(&best.candidate, &worst)
            .into_par_iter()
            .map(|candidate| {
                let start = descend(&best.asked, &candidate);
                correct_from(law, best.asked.clone(), start, &model_of, &descend, SHORT_ROUNDS)
            })
            .collect();
        match tried.into_iter().min_by(|a, b| a.evaluation.missed.total_cmp(&b.evaluation.missed)) {
            Some(better) if better.evaluation.missed < best.evaluation.missed => best = better,
            _ => given_up.push(worst.recorded.bark),
        }
    }
    best
}
