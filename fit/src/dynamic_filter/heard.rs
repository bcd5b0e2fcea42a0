//! What is heard of a law in a model's sound, and how what is off is asked for anew.

use super::joint::{Joint, Sought};
use super::path::times_s;
use super::{Model, RATE_HZ, compare, mean_law, render};
use crate::bark::DampingLaw;

/// A model is heard until its slowest band has decayed by so many nepers, or this long, seconds ...
const HEARD_DECAYS: f64 = 6.0;
const MOST_HEARD_S: f64 = 4.0;
/// ... with the noise of so many seeds, none of them the study's.
const HEARD_SEEDS: [u64; 6] = [1001, 1002, 1003, 1004, 1005, 1006];
/// An error of α that is as bad as can be counted.
const WORST_HEARD: f64 = 0.3;
/// Rounds of asking anew.
const ROUNDS: usize = 3;
/// Of what is off in the logarithm of α, so much is asked for in a round ...
const ASKED: f64 = 0.6;
/// ... and as much as this in all.
const MOST_ASKED: f64 = 0.5;

/// The law of a model's sounds.
fn heard_law(law: &DampingLaw, model: &Model) -> Option<DampingLaw> {
    let slowest = law.bands.iter().map(|band| band.decay_per_s).fold(f64::INFINITY, f64::min);
    let length_s = (HEARD_DECAYS / slowest).min(MOST_HEARD_S);
    let sounds: Vec<Vec<f64>> =
        HEARD_SEEDS.iter().map(|seed| render(model, (length_s * RATE_HZ) as usize, *seed)).collect();
    mean_law(&sounds)
}

/// What a law misses in another: the sum over bands of the error of α, none more than [`WORST_HEARD`].
fn off(law: &DampingLaw, heard: Option<&DampingLaw>) -> f64 {
    compare(law, heard).iter().map(|band| band.error().min(WORST_HEARD)).sum()
}

/// The model that sounds best of one found and those that follow when the law asked for is moved by what was heard to be off.
///
/// The descent takes powers for what a band's decay is read off, a loop's mode for the steady one, and straight lines for what lies between
/// breakpoints; what is left of that is an error of every band that hardly depends on the seed.
pub(crate) fn mend(law: &DampingLaw, found: &Sought, model_of: &dyn Fn(&DampingLaw, &Sought) -> Model) -> (f64, Model) {
    let times_s = times_s(law);
    let (mut asked, mut sought) = (law.clone(), found.clone());
    let mut best: Option<(f64, Model)> = None;
    for round in 0..=ROUNDS {
        let model = model_of(law, &sought);
        let heard = heard_law(law, &model);
        let off = off(law, heard.as_ref());
        if best.as_ref().is_none_or(|best| off < best.0) {
            best = Some((off, model));
        }
        if round == ROUNDS {
            break;
        }
        for (asked, band) in asked.bands.iter_mut().zip(&law.bands) {
            let found = heard.as_ref().and_then(|heard| heard.bands.iter().find(|heard| heard.bark == band.bark));
            if let Some(found) = found {
                let moved = ASKED * (band.decay_per_s / found.decay_per_s).ln();
                let all = (asked.decay_per_s / band.decay_per_s).ln() + moved;
                asked.decay_per_s = band.decay_per_s * all.clamp(-MOST_ASKED, MOST_ASKED).exp();
            }
        }
        sought = Joint::new(&asked, &times_s).descend(&sought);
    }
    best.unwrap_or_default()
}
