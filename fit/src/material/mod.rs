//! Material of a sounding object, and its Young's modulus, from the damping of its modes.
//!
//! A material's law tells the decay of a mode at a frequency up to a factor of the object's own:
//! the loss of its support, of the air and of its joints. The factor is unknown and integrated
//! over. So the level of the decays tells something, and how they grow with frequency tells more.
//! The law is known in two ways: as a published loss factor, and as measured on things of that
//! kind.
//!
//! Sound alone does not know an object's size, so that Young's modulus is that of the materials
//! that are likely: a guess with a range. [`solid`] reads it off a bar or a disc of known size.

mod doubt;
mod interval;
mod laws;
mod ringing;
pub mod solid;

use serde::Serialize;

pub use doubt::Doubt;
pub use interval::Interval;
pub use laws::{Kind, Material};
use laws::{Law, MATERIALS};
pub use ringing::RingingMode;
use solid::Solid;

use crate::strike::Fit;

/// A guess at a material.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Guess {
    /// Name of the material.
    pub name: &'static str,
    /// Share of the likelihood among the materials that were to choose from, 0 to 1.
    pub confidence: f64,
}

/// Material of an object, as its modes tell it.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Identified {
    /// The most likely material.
    pub material: Guess,
    /// All materials that were to choose from, the most likely first.
    pub posterior: Vec<Guess>,
    /// Young's modulus in pascals.
    pub young_modulus_pa: Interval,
}

/// A name that is none of a known material.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("there is no material {name:?}; the known ones are {}", laws::names())]
pub struct UnknownMaterial {
    /// The name.
    pub name: String,
}

/// Materials by their names; without names, all that are known.
///
/// # Errors
/// [`UnknownMaterial`] with the first name that is none.
pub fn named(names: &[String]) -> Result<Vec<Material>, UnknownMaterial> {
    if names.is_empty() {
        return Ok(MATERIALS.to_vec());
    }
    let of_name = |name: &String| {
        let found = MATERIALS.iter().find(|material| material.name.eq_ignore_ascii_case(name.trim()));
        found.copied().ok_or_else(|| UnknownMaterial { name: name.clone() })
    };
    names.iter().map(of_name).collect()
}

/// Material and Young's modulus of an object, as its modes and its size tell them.
#[derive(Clone, Debug, PartialEq)]
pub struct Told {
    /// The likeliest material.
    pub material: Option<Guess>,
    /// Young's modulus in pascals: of the solid whose size is known, else of the likely materials.
    pub young_modulus_pa: Option<Interval>,
    /// Reasons to doubt the modulus of a solid whose size is known.
    pub doubts: Vec<Doubt>,
}

/// The likeliest material of an object, and its Young's modulus in pascals: that of a solid whose
/// size is known, else of the likely materials. `among` are those to choose from; if there are
/// none, all that are known.
pub fn guess(modes: &[RingingMode], among: &[Material], solid: Option<Solid>) -> Told {
    let identified = identify(modes, if among.is_empty() { &MATERIALS } else { among });
    let (young_modulus_pa, doubts) = match solid {
        Some(solid) => {
            let modulus = solid::young_modulus(modes, solid);
            (modulus.map(|modulus| modulus.pascals), Doubt::about(modulus.as_ref(), modes, solid))
        }
        None => (identified.as_ref().map(|identified| identified.young_modulus_pa), Vec::new()),
    };
    Told { material: identified.map(|identified| identified.material), young_modulus_pa, doubts }
}

/// Level in dB below the strongest mode from which a mode does not count.
const LEAST_LEVEL_DB: f64 = -30.0;
/// Level in dB at which a mode's weight is a tenth of the strongest one's.
const TENTH_DB: f64 = 40.0;
/// Scale by which ln decay scatters about an object's law.
const SCATTER: f64 = 1.0;
/// Degrees of freedom of Student's distribution, which that scatter has.
const FREEDOM: f64 = 4.0;
/// Standard deviation of the logarithm of an object's own factor.
const OWN_FACTOR: f64 = 0.8;
/// Probability that an object follows the measured law of its kind, not the published loss factor.
///
/// The measured things were held, and lose ten times what freely ringing ones lose.
const AS_MEASURED: f64 = 0.1;
/// Number of modes for which an object speaks at most: the errors of its modes are alike.
const INDEPENDENT: f64 = 6.0;
/// Steps of an object's own factor on either side, four to a standard deviation.
const STEPS: i32 = 10;

/// The material whose damping law the modes of an object follow best, with Young's modulus.
///
/// Materials of one kind, such as steel and tin, share the probability of their kind, so that no
/// kind is likely for having many names. `None` without modes or materials.
pub fn identify(modes: &[RingingMode], among: &[Material]) -> Option<Identified> {
    let counted: Vec<(f64, &RingingMode)> = modes
        .iter()
        .filter(|mode| mode.level_db > LEAST_LEVEL_DB && mode.decay_per_s > 0.0)
        .map(|mode| (10f64.powf(mode.level_db / TENTH_DB), mode))
        .collect();
    if counted.is_empty() || among.is_empty() {
        return None;
    }
    let likelihoods: Vec<f64> = among
        .iter()
        .map(|material| {
            let published = log_likelihood(&counted, &material.published) + (1.0 - AS_MEASURED).ln();
            let measured = log_likelihood(&counted, &material.kind.measured()) + AS_MEASURED.ln();
            let of_kind = among.iter().filter(|other| other.kind == material.kind).count();
            log_sum(&[published, measured]) - (of_kind as f64).ln()
        })
        .collect();
    let all = log_sum(&likelihoods);
    let mut posterior: Vec<(Guess, &Material)> = among
        .iter()
        .zip(&likelihoods)
        .map(|(material, likelihood)| (Guess { name: material.name, confidence: (likelihood - all).exp() }, material))
        .collect();
    posterior.sort_by(|a, b| b.0.confidence.total_cmp(&a.0.confidence));
    let young_modulus_pa = modulus(&posterior);
    Some(Identified {
        material: posterior.first()?.0,
        posterior: posterior.into_iter().map(|(guess, _)| guess).collect(),
        young_modulus_pa,
    })
}

/// Logarithm of the likelihood of modes, with their weights, under a law.
fn log_likelihood(modes: &[(f64, &RingingMode)], law: &Law) -> f64 {
    let weights: f64 = modes.iter().map(|(weight, _)| weight).sum();
    let squares: f64 = modes.iter().map(|(weight, _)| weight * weight).sum();
    let independent = (weights * weights / squares).min(INDEPENDENT);
    let steps = || (-STEPS..=STEPS).map(|step| 0.25 * f64::from(step));
    let factors: f64 = steps().map(|own| (-0.5 * own * own).exp()).sum();
    let logs: Vec<f64> = steps()
        .map(|own| {
            let misfit: f64 = modes
                .iter()
                .map(|(weight, mode)| {
                    let expected = law.decay_per_s(mode.frequency_hz) * (OWN_FACTOR * own).exp();
                    let off = (mode.decay_per_s / expected).ln() / SCATTER;
                    weight * 0.5 * (FREEDOM + 1.0) * (1.0 + off * off / FREEDOM).ln()
                })
                .sum();
            -0.5 * own * own - factors.ln() - misfit / weights * independent
        })
        .collect();
    log_sum(&logs)
}

/// Probability that a normal number lies below a bound.
fn normal_below(bound: f64) -> f64 {
    0.5 * libm::erfc(-bound / std::f64::consts::SQRT_2)
}

/// Logarithm of the sum of numbers whose logarithms are given.
fn log_sum(logs: &[f64]) -> f64 {
    let most = logs.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    most + logs.iter().map(|log| (log - most).exp()).sum::<f64>().ln()
}

/// Young's modulus: that of the likeliest material, and the 90 % range over all by likelihood.
fn modulus(posterior: &[(Guess, &Material)]) -> Interval {
    let below = |log_pascals: f64| -> f64 {
        let share = |(guess, material): &(Guess, &Material)| {
            let [pascals, spread] = material.young_modulus;
            guess.confidence * normal_below((log_pascals - pascals.ln()) / spread)
        };
        posterior.iter().map(share).sum()
    };
    let quantile = |share: f64| {
        let (mut low, mut high) = (1e8f64.ln(), 1e12f64.ln());
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            if below(middle) < share { low = middle } else { high = middle }
        }
        (0.5 * (low + high)).exp()
    };
    let (low, high) = (quantile(0.05), quantile(0.95));
    // The median of all may be that of no material: it lies between those of two.
    let estimate = posterior.first().map_or(quantile(0.5), |(_, material)| material.young_modulus[0]);
    Interval { estimate, low: low.min(estimate), high: high.max(estimate) }
}

/// Modes of a fit as far as they tell of a material, with their levels in the loudest strike.
pub fn ringing(fit: &Fit) -> Vec<RingingMode> {
    let place = if fit.measured { 0 } else { fit.loudest };
    let squared =
        |mode: &crate::strike::Mode| mode.gains.get(place).map_or(0.0, |[sine, cosine]| sine * sine + cosine * cosine);
    RingingMode::relative(fit.modes.iter().map(|mode| (mode.frequency_hz, mode.decay_per_s, squared(mode))))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn modes_of(law: &Law) -> Vec<RingingMode> {
        [300.0, 750.0, 1400.0, 2600.0, 5200.0, 9000.0]
            .map(|frequency_hz| RingingMode { frequency_hz, decay_per_s: law.decay_per_s(frequency_hz), level_db: 0.0 })
            .to_vec()
    }

    #[test]
    fn materials_of_unlike_loss_are_told_apart_by_modes_that_follow_their_loss_factor() {
        let names = ["steel", "ceramic", "wood"].map(str::to_owned);
        let among = named(&names).expect("they are known");
        for material in &among {
            let law = material.published;
            let identified = identify(&modes_of(&law), &among).expect("there are modes");
            assert_eq!(identified.material.name, material.name, "{identified:?}");
            let shares: f64 = identified.posterior.iter().map(|guess| guess.confidence).sum();
            let modulus = identified.young_modulus_pa;
            assert!((shares - 1.0).abs() < 1e-9 && modulus.low < modulus.estimate && modulus.estimate < modulus.high);
        }
    }

    #[test]
    fn a_lossy_support_does_not_change_the_material() {
        let among = named(&["steel".to_owned(), "wood".to_owned()]).expect("they are known");
        let mut modes = modes_of(&among[0].published);
        modes.iter_mut().for_each(|mode| mode.decay_per_s += 9.0);
        assert_eq!(identify(&modes, &among).expect("there are modes").material.name, "steel");
    }

    #[test]
    fn a_second_name_for_a_kind_does_not_make_the_kind_likelier() {
        let [few, many] = [["steel", "wood"].as_slice(), &["steel", "tin", "wood"]]
            .map(|names| named(&names.iter().map(|name| (*name).to_owned()).collect::<Vec<_>>()).expect("known"));
        // Without anything to tell them apart, three names of two kinds share as two would.
        let modes = [RingingMode { frequency_hz: 1000.0, decay_per_s: 45.0, level_db: 0.0 }];
        let wood = |among: &[Material]| {
            let found = identify(&modes, among).expect("a mode");
            found.posterior.iter().find(|guess| guess.name == "wood").expect("wood").confidence
        };
        assert!((wood(&few) - wood(&many)).abs() < 0.15, "{} {}", wood(&few), wood(&many));
    }

    #[test]
    fn names_of_no_material_are_refused_with_those_that_are_known() {
        let error = named(&["granite".to_owned()]).expect_err("it is unknown").to_string();
        assert!(error.contains("\"granite\"") && error.contains("polycarbonate"), "{error}");
    }
}
