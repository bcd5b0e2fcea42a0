//! Material of a sounding object, and its Young's modulus, from the damping of its modes.
//!
//! Every mode loses energy within the material, and more to what holds the object, to the air and
//! to joints: the loss of the support, which is unknown and never negative. So a mode's decay d lies
//! above that of the material, `ln d = ln d_m(f) + e + s`, with e normal and s exponential: the
//! slowest modes tell most. The law d_m is known in three ways ([`laws`]): as a published loss
//! factor, as published Rayleigh damping, and as measured on things of that material. Each is as
//! likely as the others.
//!
//! Sound alone does not know an object's size, so that Young's modulus is that of the materials
//! that are likely: a guess with a range. [`crate::material::solid`] reads it off a bar or a disc of
//! known size.

mod laws;
pub mod solid;

use serde::Serialize;

pub use laws::Material;
use laws::{Law, MATERIALS};

use crate::strike::Fit;

/// A guess at a material.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Guess {
    /// Name of the material.
    pub name: &'static str,
    /// Share of the likelihood among the materials that were to choose from, 0 to 1.
    pub confidence: f64,
}

/// A mode as far as it tells of a material.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RingingMode {
    /// Frequency in Hz.
    pub frequency_hz: f64,
    /// Decay rate in 1/s.
    pub decay_per_s: f64,
    /// Energy of the mode's sound relative to the strongest mode's, in dB.
    pub level_db: f64,
}

/// An estimate with its range.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Interval {
    /// Median.
    pub estimate: f64,
    /// Value below which it lies with a probability of 5 %.
    pub low: f64,
    /// Value above which it lies with a probability of 5 %.
    pub high: f64,
}

/// What the modes of an object tell of its material.
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

/// Level in dB below the strongest mode from which a mode does not count.
const LEAST_LEVEL_DB: f64 = -30.0;
/// Standard deviation of ln decay about a law, beside the law's own.
const SCATTER: f64 = 0.4;
/// Mean of the support's share in ln decay.
const SUPPORT: f64 = 1.0;
/// Number of modes for which an object speaks at most: the errors of its modes are alike.
const INDEPENDENT: f64 = 4.0;

/// The material whose damping law the modes of an object follow best, with Young's modulus.
///
/// `None` without modes or materials.
pub fn identify(modes: &[RingingMode], among: &[Material]) -> Option<Identified> {
    let counted: Vec<&RingingMode> = modes.iter().filter(|mode| mode.level_db > LEAST_LEVEL_DB).collect();
    if counted.is_empty() || among.is_empty() {
        return None;
    }
    // A mode's weight is the square root of its amplitude: weak modes are less sure to be true.
    let weight = |mode: &RingingMode| 10f64.powf(mode.level_db / 40.0);
    let weights: f64 = counted.iter().map(|mode| weight(mode)).sum();
    let squares: f64 = counted.iter().map(|mode| weight(mode).powi(2)).sum();
    let independent = (weights * weights / squares).min(INDEPENDENT);
    let of_law = |law: &Law| {
        let sum: f64 = counted.iter().map(|mode| weight(mode) * log_density(mode, law)).sum();
        sum / weights * independent
    };
    let likelihoods: Vec<f64> = among
        .iter()
        .map(|material| {
            let of_laws: Vec<f64> = material.laws.iter().flatten().map(of_law).collect();
            log_mean(&of_laws)
        })
        .collect();
    let most = likelihoods.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let all: f64 = likelihoods.iter().map(|likelihood| (likelihood - most).exp()).sum();
    let mut posterior: Vec<(Guess, &Material)> = among
        .iter()
        .zip(&likelihoods)
        .map(|(material, likelihood)| {
            (Guess { name: material.name, confidence: (likelihood - most).exp() / all }, material)
        })
        .collect();
    posterior.sort_by(|a, b| b.0.confidence.total_cmp(&a.0.confidence));
    let young_modulus_pa = modulus(&posterior);
    Some(Identified {
        material: posterior.first()?.0,
        posterior: posterior.into_iter().map(|(guess, _)| guess).collect(),
        young_modulus_pa,
    })
}

/// Logarithm of the density of ln decay under a law: normal plus exponential.
fn log_density(mode: &RingingMode, law: &Law) -> f64 {
    let (expected, spread) = law.log_decay(mode.frequency_hz);
    let sigma = spread.hypot(SCATTER);
    let over = mode.decay_per_s.max(1e-6).ln() - expected;
    let rate = 1.0 / SUPPORT;
    let at = (over / sigma) - rate * sigma;
    (rate.ln() - rate * over + 0.5 * (rate * sigma).powi(2)) + log_normal_below(at)
}

/// Logarithm of the probability that a normal number lies below a bound.
fn log_normal_below(bound: f64) -> f64 {
    if bound < -6.0 {
        // Asymptotic series of Mills' ratio.
        let square = bound * bound;
        return -0.5 * square - (-bound * (2.0 * std::f64::consts::PI).sqrt()).ln() - 1.0 / square;
    }
    // Abramowitz and Stegun 7.1.26 for erf; error below 2e-7.
    let x = bound.abs() / std::f64::consts::SQRT_2;
    let t = 1.0 / (1.0 + 0.327_591_1 * x);
    let series = [0.254_829_592, -0.284_496_736, 1.421_413_741, -1.453_152_027, 1.061_405_429];
    let sum = series.iter().rev().fold(0.0, |sum, factor| (sum + factor) * t);
    let tail = 0.5 * sum * (-x * x).exp();
    (if bound < 0.0 { tail } else { 1.0 - tail }).max(1e-300).ln()
}

/// Logarithm of the mean of numbers whose logarithms are given.
fn log_mean(logs: &[f64]) -> f64 {
    let most = logs.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    most + (logs.iter().map(|log| (log - most).exp()).sum::<f64>() / logs.len().max(1) as f64).ln()
}

/// Young's modulus: median and 90 % range over all materials by their likelihood.
fn modulus(posterior: &[(Guess, &Material)]) -> Interval {
    let below = |log_pascals: f64| -> f64 {
        let share = |(guess, material): &(Guess, &Material)| {
            let [pascals, spread] = material.young_modulus;
            guess.confidence * log_normal_below((log_pascals - pascals.ln()) / spread).exp()
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
    Interval { estimate: quantile(0.5), low: quantile(0.05), high: quantile(0.95) }
}

/// The material whose damping law the modes of a fit follow best; `None` for a fit without modes.
pub fn guess(fit: &Fit) -> Option<Guess> {
    identify(&ringing(fit), &MATERIALS).map(|identified| identified.material)
}

/// Modes of a fit as far as they tell of a material, with their levels in the loudest strike.
pub fn ringing(fit: &Fit) -> Vec<RingingMode> {
    let place = if fit.measured { 0 } else { fit.loudest };
    let energy = |mode: &crate::strike::Mode| {
        mode.gains.get(place).map_or(0.0, |[sine, cosine]| sine * sine + cosine * cosine) / mode.decay_per_s
    };
    let most = fit.modes.iter().map(energy).fold(f64::MIN_POSITIVE, f64::max);
    let modes = fit.modes.iter().map(|mode| RingingMode {
        frequency_hz: mode.frequency_hz,
        decay_per_s: mode.decay_per_s,
        level_db: 10.0 * (energy(mode) / most).max(1e-20).log10(),
    });
    modes.collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn modes_of(law: &Law) -> Vec<RingingMode> {
        [300.0, 750.0, 1400.0, 2600.0, 5200.0, 9000.0]
            .map(|frequency_hz| RingingMode {
                frequency_hz,
                decay_per_s: law.log_decay(frequency_hz).0.exp(),
                level_db: 0.0,
            })
            .to_vec()
    }

    #[test]
    fn materials_of_unlike_loss_are_told_apart_by_modes_that_follow_their_loss_factor() {
        let names = ["steel", "ceramic", "wood"].map(str::to_owned);
        let among = named(&names).expect("they are known");
        for material in &among {
            let law = material.laws[0].expect("a published loss factor");
            let identified = identify(&modes_of(&law), &among).expect("there are modes");
            assert_eq!(identified.material.name, material.name, "{identified:?}");
            let shares: f64 = identified.posterior.iter().map(|guess| guess.confidence).sum();
            let modulus = identified.young_modulus_pa;
            assert!((shares - 1.0).abs() < 1e-9 && modulus.low < modulus.estimate && modulus.estimate < modulus.high);
        }
    }

    #[test]
    fn a_lossy_support_of_some_modes_does_not_change_the_material() {
        let among = named(&["steel".to_owned(), "wood".to_owned()]).expect("they are known");
        let mut modes = modes_of(&among[0].laws[0].expect("a published loss factor"));
        modes.iter_mut().step_by(2).for_each(|mode| mode.decay_per_s += 60.0);
        assert_eq!(identify(&modes, &among).expect("there are modes").material.name, "steel");
    }

    #[test]
    fn names_of_no_material_are_refused_with_those_that_are_known() {
        let error = named(&["granite".to_owned()]).expect_err("it is unknown").to_string();
        assert!(error.contains("\"granite\"") && error.contains("polycarbonate"), "{error}");
    }
}
