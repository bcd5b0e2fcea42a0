//! What is heard of a law in a model's sound, and how what is off is asked for anew.

use rayon::prelude::*;

use super::damping::mean_of;
use super::joint::{Joint, Sought};
use super::path::times_s;
use super::response::heard_in_band;
use super::{Comparison, Model, RATE_HZ, compare, render};
use crate::bark::{DampingLaw, damping_law};
use crate::modes::DampedSine;

/// A model is heard until its slowest band has decayed by so many nepers and its noise has ended, or this long, seconds ...
const HEARD_DECAYS: f64 = 7.0;
const MOST_HEARD_S: f64 = 3.0;
/// Silence behind the noise, seconds.
const SILENCE_S: f64 = 0.1;
/// ... with the noise of these seeds, none of them the study's, in sets of so many.
const SEEDS: std::ops::Range<u64> = 1001..1017;
const SET: usize = 4;
/// An error of α up to here is as good as none: so much is another draw's.
const GOOD: f64 = 0.06;
/// An error of α that is as bad as can be counted.
const WORST: f64 = 0.3;
/// Rounds of asking anew.
const ROUNDS: usize = 5;
/// The same for a mode that is tried.
const SHORT_ROUNDS: usize = 2;
/// A mode is in a band that hears so much of its power, and so many of a band's modes are tried.
const INSIDE: f64 = 0.2;
const TRIED: usize = 2;
/// Of what is off in the logarithm of α, so much is asked for in a round ...
const ASKED: f64 = 0.6;
/// ... and as much as this in all.
const MOST_ASKED: f64 = 0.6;

/// What is heard of a law in a model.
#[derive(Clone)]
pub(crate) struct Heard {
    /// Band by band, over all draws.
    bands: Vec<Comparison>,
    /// How much of the law is missed by as few draws as the study takes: for each band from 0 where it is met to 1 where it is lost.
    pub(crate) missed: f64,
}

/// Listens to a model. What a few draws say of noise is their own as much as the model's, and the best of many models by the same few draws is one
/// that suits these: so there are several sets of draws, and what each misses counts.
pub(crate) fn hear(law: &DampingLaw, model: &Model) -> Heard {
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
    Heard { bands: compared(&laws), missed }
}

/// A model, and what is heard of the law in it.
#[derive(Clone)]
pub(crate) struct Mended<S> {
    /// What was sought.
    sought: S,
    /// The law that was asked for.
    asked: DampingLaw,
    /// The model of it.
    pub(crate) model: Model,
    /// What is heard of the law in it.
    pub(crate) heard: Heard,
}

/// The model that sounds best of one found and those that follow when the law asked for is moved by what was heard to be off.
///
/// The descent takes powers for what a band's decay is read off, a loop's mode for the steady one, and straight lines for what lies between
/// breakpoints; what is left of that is an error of every band that hardly depends on the seed.
///
/// `descend` finds anew, from what was found, what is asked for.
pub(crate) fn mend<S: Clone>(
    law: &DampingLaw,
    found: &S,
    model_of: impl Fn(&S) -> Model,
    descend: impl Fn(&DampingLaw, &S) -> S,
) -> Mended<S> {
    mend_from(law, law.clone(), found.clone(), model_of, descend, ROUNDS)
}

/// [`Joint`]'s descent for what is asked for in the place of a law.
pub(crate) fn descend(law: &DampingLaw) -> impl Fn(&DampingLaw, &Sought) -> Sought + Copy + use<'_> {
    move |asked, sought| Joint::new(asked, &times_s(law)).descend(sought)
}

fn mend_from<S: Clone>(
    law: &DampingLaw,
    mut asked: DampingLaw,
    mut sought: S,
    model_of: impl Fn(&S) -> Model,
    descend: impl Fn(&DampingLaw, &S) -> S,
    rounds: usize,
) -> Mended<S> {
    let mut best: Option<Mended<S>> = None;
    let mut round = 0;
    loop {
        let model = model_of(&sought);
        let heard = hear(law, &model);
        let now = Mended { sought: sought.clone(), asked: asked.clone(), model, heard };
        for asked in &mut asked.bands {
            let Some(band) = now.heard.bands.iter().find(|heard| heard.recorded.bark == asked.bark) else { continue };
            let (meant, Some(found)) = (band.recorded.decay_per_s, band.decay_per_s) else { continue };
            let moved = (asked.decay_per_s / meant).ln() + ASKED * (meant / found).ln();
            asked.decay_per_s = meant * moved.clamp(-MOST_ASKED, MOST_ASKED).exp();
        }
        let best = match best.take() {
            Some(before) if before.heard.missed <= now.heard.missed => best.insert(before),
            _ => best.insert(now),
        };
        if round == rounds || best.heard.missed <= 0.0 {
            return best.clone();
        }
        round += 1;
        sought = descend(&asked, &sought);
    }
}

/// The modes that a law's worst band may lack, the loudest in it first.
pub(crate) fn lacking(band: &Comparison, modes: &[DampedSine], taken_hz: &[f64]) -> Vec<DampedSine> {
    let heard = |mode: &DampedSine| heard_in_band(mode.frequency_hz, band.recorded.bark);
    let is_new = |mode: &&DampedSine| !taken_hz.contains(&mode.frequency_hz);
    let mut there: Vec<DampedSine> = modes.iter().filter(|mode| heard(mode) > INSIDE).filter(is_new).copied().collect();
    there.sort_by(|a, b| (heard(b) * b.amplitude.powi(2)).total_cmp(&(heard(a) * a.amplitude.powi(2))));
    there.truncate(TRIED);
    there
}

/// Takes in what `offered` gives where a model is heard to lack it, band by band, the worst first, at most so many bands, as long as that is heard to help.
///
/// Predictions say of each mode alone what it would do; where noise is in its way, only the fit of all together tells.
pub(crate) fn complete<S: Clone + Send + Sync>(
    law: &DampingLaw,
    mended: Mended<S>,
    bands: usize,
    offered: impl Fn(&S, &Comparison) -> Vec<S> + Sync,
    model_of: impl Fn(&S) -> Model + Sync,
    descend: impl Fn(&DampingLaw, &S) -> S + Sync,
) -> Mended<S> {
    let mut best = mended;
    let mut given_up = Vec::new();
    for _ in 0..bands {
        let is_open = |band: &&Comparison| band.error() > GOOD && !given_up.contains(&band.recorded.bark);
        let worst = best.heard.bands.iter().filter(is_open).max_by(|a, b| a.error().total_cmp(&b.error()));
        let Some(worst) = worst.copied() else { break };
        let tried: Vec<Mended<S>> = offered(&best.sought, &worst)
            .into_par_iter()
            .map(|sought| {
                let start = descend(&best.asked, &sought);
                mend_from(law, best.asked.clone(), start, &model_of, &descend, SHORT_ROUNDS)
            })
            .collect();
        match tried.into_iter().min_by(|a, b| a.heard.missed.total_cmp(&b.heard.missed)) {
            Some(better) if better.heard.missed < best.heard.missed => best = better,
            _ => given_up.push(worst.recorded.bark),
        }
    }
    best
}
