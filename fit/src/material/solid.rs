//! Young's modulus of bars and discs of known size, from the frequencies of their modes.
//!
//! A bar that is free at both ends bends at `f_n = b_n h/(2πL²) sqrt(E/12ρ)`, a free disc at
//! `f_n = λ_n² h/(2πR²) sqrt(E/(12 ρ (1 - ν²)))`. The numbers b_n and λ_n² do not depend on E, so
//! that a mode tells E once its number n is known. The numbers are those, and E is the value, with
//! which the loudest recorded modes lie nearest to modes of the solid.

use std::f64::consts::{FRAC_1_SQRT_2, TAU};

use super::interval::Interval;
use super::ringing::RingingMode;
use crate::random::SplitMix64;

/// A solid of uniform thickness, free all round.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Solid {
    /// Bar of rectangular section, struck across its thickness.
    Bar {
        /// Length in metres.
        length_m: f64,
        /// Thickness in metres, in the direction in which it bends.
        height_m: f64,
        /// Density in kg/m³.
        density: f64,
    },
    /// Circular disc.
    Disc {
        /// Radius in metres.
        radius_m: f64,
        /// Thickness in metres, at most a tenth of the radius.
        height_m: f64,
        /// Density in kg/m³.
        density: f64,
    },
}

/// Poisson's ratio that is assumed; bars hardly depend on it.
const POISSON: f64 = 0.3;
/// Numbers λ² of the free disc at a Poisson's ratio of 0.3, lowest first.
const DISC: [f64; 8] = [5.358, 9.003, 12.439, 20.475, 21.835, 33.495, 35.260, 38.443];
/// Number of a bar's modes that are looked for.
const BAR_MODES: usize = 8;
/// Number of a solid's lowest modes that a recorded mode may be taken for at the beginning.
const FIRST: usize = 3;
/// Largest distance of a recorded mode from the solid's, in natural logarithms: 2 %.
const NEAR: f64 = 0.02;
/// Cost of a mode of the solid that is not recorded, in units of the loudest mode's weight.
const MISSING: f64 = 0.25;
/// Least level in dB of a mode that counts.
pub(super) const LEAST_LEVEL_DB: f64 = -45.0;
/// Least number of modes that stand where those of the solid do.
pub(super) const LEAST_MODES: usize = 2;
/// Least share of the energy that these modes have.
///
/// `cargo test -p fit --lib material::doubt -- --nocapture` prints how many of random bars and
/// discs, with up to five modes of other kinds, stay below it, and how many of other bodies do.
pub(super) const LEAST_SHARE: f64 = 0.6;
/// Range in pascals in which Young's modulus is looked for.
pub(super) const MODULI_PA: std::ops::RangeInclusive<f64> = 1e7..=2e12;
/// Number of trials with modes at other frequencies.
const TRIALS: usize = 200;
/// Largest move of a mode's frequency in a trial, in natural logarithms.
const MOVED: f64 = 0.2;
/// Largest share of trials whose modes stand as near to the solid's as the recorded ones do; above
/// it the body may be another one.
///
/// `cargo test -p fit --lib material::doubt -- --nocapture` prints how many random bodies are
/// doubted.
pub(super) const MOST_CHANCE: f64 = 0.3;
/// Least standard deviation of ln E: Poisson's ratio, thickness and ends are not exactly known.
const LEAST_SPREAD: f64 = 0.01;

/// Young's modulus that the modes of a solid tell.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Modulus {
    /// Young's modulus in pascals.
    pub pascals: Interval,
    /// Number of recorded modes that stand where one of the solid's does.
    pub modes: usize,
    /// Share of the energy of all recorded modes that they have, 0 to 1.
    pub share: f64,
    /// Share of trials in which modes at other frequencies stand as near to the solid's, 0 to 1.
    pub chance: f64,
}

/// A recorded mode beside one of the solid.
struct Match<'a> {
    /// Frequency over the number of the solid's mode, in Hz.
    scale: f64,
    weight: f64,
    mode: &'a RingingMode,
}

/// Places of a solid's series among recorded modes, each with its score.
///
/// Frequencies are `scale` times the numbers of the series; a scale is one at which some recorded
/// mode is one of the solid's lowest.
fn places<'a>(heard: &[&'a RingingMode], series: &[f64], solid: Solid) -> Vec<(f64, Vec<Match<'a>>)> {
    let highest_hz = heard.iter().map(|mode| mode.frequency_hz).fold(0.0, f64::max);
    let weight = |mode: &RingingMode| 10f64.powf(mode.level_db / 40.0);
    let matched = |scale: f64| -> (f64, Vec<Match<'a>>) {
        let (mut score, mut found) = (0.0, Vec::new());
        for number in series.iter().filter(|number| *number * scale < highest_hz * (1.0 + NEAR)) {
            let off = |mode: &RingingMode| (mode.frequency_hz / (number * scale)).ln();
            let worth = |mode: &RingingMode| weight(mode) * (1.0 - (off(mode) / NEAR).powi(2));
            let near = heard.iter().copied().filter(|mode| off(mode).abs() < NEAR);
            match near.max_by(|a, b| worth(a).total_cmp(&worth(b))) {
                Some(mode) => {
                    score += worth(mode);
                    found.push(Match { scale: mode.frequency_hz / number, weight: weight(mode), mode });
                }
                None => score -= MISSING,
            }
        }
        (score, found)
    };
    let scales = heard.iter().flat_map(|mode| series.iter().take(FIRST).map(|number| mode.frequency_hz / number));
    let possible = scales.filter(|scale| MODULI_PA.contains(&modulus(solid, *scale)));
    possible.map(matched).filter(|(_, found)| !found.is_empty()).collect()
}

/// Scores of a solid's best place among modes at other frequencies, lowest first.
///
/// Each trial moves every recorded mode by up to [`MOVED`], and keeps its level.
fn chance_scores(heard: &[&RingingMode], series: &[f64], solid: Solid) -> Vec<f64> {
    let mut random = SplitMix64(1);
    let trial = |_| {
        let moved = |mode: &&RingingMode| RingingMode {
            frequency_hz: mode.frequency_hz * (MOVED * (2.0 * random.uniform() - 1.0)).exp(),
            ..**mode
        };
        let moved: Vec<RingingMode> = heard.iter().map(moved).collect();
        let moved: Vec<&RingingMode> = moved.iter().collect();
        places(&moved, series, solid).iter().map(|place| place.0).fold(f64::MIN, f64::max)
    };
    let mut scores: Vec<f64> = (0..TRIALS).map(trial).collect();
    scores.sort_by(f64::total_cmp);
    scores
}

/// Young's modulus of a solid whose modes are recorded, with its range.
///
/// Bars are those of Timoshenko with a Poisson's ratio of 0.3. Within 3 % for bars up to a
/// thickness of a fifth of the length (`cargo test -p fit --lib material::solid`). Discs are thin
/// plates. `None` if no mode fits a modulus from 10 MPa to 2 TPa.
///
/// Range of a body that may be another one ([`Doubt`](super::Doubt)): it holds all
/// moduli whose score is half the best one, or that of a trial with modes at other frequencies.
pub fn young_modulus(modes: &[RingingMode], solid: Solid) -> Option<Modulus> {
    let series = series(solid);
    let heard: Vec<&RingingMode> = modes.iter().filter(|mode| mode.level_db > LEAST_LEVEL_DB).collect();
    let places = places(&heard, &series, solid);
    let (score, best) = places.iter().max_by(|a, b| a.0.total_cmp(&b.0))?;
    let mean_of = |found: &[Match<'_>]| {
        let weights: f64 = found.iter().map(|found| found.weight).sum();
        (found.iter().map(|found| found.weight * found.scale.ln()).sum::<f64>() / weights, weights)
    };
    let (mean, weights) = mean_of(best);
    let variance = best.iter().map(|found| found.weight * (found.scale.ln() - mean).powi(2)).sum::<f64>() / weights;
    // E grows as the square of the frequencies.
    let spread = 1.645 * (4.0 * variance / best.len() as f64).sqrt().max(LEAST_SPREAD);
    let estimate = modulus(solid, mean.exp());
    let energy = |mode: &RingingMode| 10f64.powf(mode.level_db / 10.0);
    let scores = chance_scores(&heard, &series, solid);
    let chance = scores.iter().filter(|of_trial| *of_trial >= score).count() as f64 / TRIALS as f64;
    let [mut low, mut high] = [estimate * (-spread).exp(), estimate * spread.exp()];
    let share =
        best.iter().map(|found| energy(found.mode)).sum::<f64>() / heard.iter().copied().map(energy).sum::<f64>();
    if chance > MOST_CHANCE || best.len() < LEAST_MODES || share < LEAST_SHARE {
        let least = scores[TRIALS / 2].min(score - 0.5 * score.abs());
        for (_, found) in places.iter().filter(|place| place.0 >= least) {
            let other = modulus(solid, mean_of(found).0.exp());
            low = low.min(other * (-spread).exp());
            high = high.max(other * spread.exp());
        }
    }
    Some(Modulus { pascals: Interval { estimate, low, high }, modes: best.len(), share, chance })
}

/// Young's modulus at which a solid's frequencies are `scale` times its series.
fn modulus(solid: Solid, scale: f64) -> f64 {
    match solid {
        Solid::Bar { length_m, height_m, density } => {
            12.0 * density * (TAU * scale * length_m * length_m / height_m).powi(2)
        }
        Solid::Disc { radius_m, height_m, density } => {
            12.0 * density * (1.0 - POISSON * POISSON) * (TAU * scale * radius_m * radius_m / height_m).powi(2)
        }
    }
}

/// Numbers `ω L² sqrt(ρA/EI)` of a bar, or `ω R² sqrt(ρh/D)` of a disc, lowest first.
fn series(solid: Solid) -> Vec<f64> {
    match solid {
        Solid::Bar { length_m, height_m, .. } => bar_series(height_m / length_m, BAR_MODES),
        Solid::Disc { .. } => DISC.to_vec(),
    }
}

/// Roots of the frequency equation of a free Timoshenko bar of rectangular section.
///
/// T. C. Huang, The effect of rotatory inertia and of shear deformation, J. Appl. Mech. 28, 1961.
fn bar_series(slenderness: f64, count: usize) -> Vec<f64> {
    let inertia = slenderness * slenderness / 12.0;
    // The shear coefficient of a rectangle is 10(1+ν)/(12+11ν) (Cowper 1966), E/G is 2(1+ν).
    let shear = inertia * 2.0 * (12.0 + 11.0 * POISSON) / 10.0;
    let equation = |b: f64| {
        let root = ((inertia - shear).powi(2) + 4.0 / (b * b)).sqrt();
        let alpha = FRAC_1_SQRT_2 * (root - inertia - shear).max(0.0).sqrt();
        let beta = FRAC_1_SQRT_2 * (root + inertia + shear).sqrt();
        let below = (1.0 - b * b * inertia * shear).sqrt();
        let factor = b / below * (b * b * inertia * (inertia - shear).powi(2) + 3.0 * inertia - shear);
        // Divided by cosh bα, which grows beyond all bounds.
        let cosh = (b * alpha).min(300.0).cosh();
        2.0 / cosh - 2.0 * (b * beta).cos() + factor * (b * alpha).tanh() * (b * beta).sin()
    };
    let mut roots = Vec::with_capacity(count);
    // Above this frequency waves of a second kind run along the bar, and the equation changes.
    let cut_off = 0.999 / (inertia * shear).sqrt();
    let (mut low, step) = (2.0, 0.1);
    while roots.len() < count && low + step < cut_off {
        let high = low + step;
        if equation(low) * equation(high) < 0.0 {
            let (mut from, mut to) = (low, high);
            for _ in 0..60 {
                let middle = 0.5 * (from + to);
                if equation(from) * equation(middle) <= 0.0 { to = middle } else { from = middle }
            }
            roots.push(0.5 * (from + to));
        }
        low = high;
    }
    roots
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Frequencies in Hz of a free Timoshenko bar, with no use of its frequency equation.
    ///
    /// The four equations of motion are integrated from one end by Runge-Kutta steps, for two
    /// starts without moment and shear force; at a mode some mixture of both has neither at the
    /// other end.
    fn bar_hz(length: f64, height: f64, density: f64, young: f64, poisson: f64, count: usize) -> Vec<f64> {
        let (area, second) = (height, height.powi(3) / 12.0);
        let shear = 10.0 * (1.0 + poisson) / (12.0 + 11.0 * poisson) * young / (2.0 * (1.0 + poisson)) * area;
        let determinant = |hz: f64| {
            let w2 = (TAU * hz).powi(2);
            // Deflection, turn, moment, shear force.
            let slope = |[y, turn, moment, force]: [f64; 4]| {
                [
                    turn + force / shear,
                    moment / (young * second),
                    -density * second * w2 * turn - force,
                    -density * area * w2 * y,
                ]
            };
            let end = |mut state: [f64; 4]| {
                let steps = 1500;
                let h = length / f64::from(steps);
                let plus = |a: [f64; 4], b: [f64; 4], by: f64| std::array::from_fn(|i| a[i] + by * b[i]);
                for _ in 0..steps {
                    let k1 = slope(state);
                    let k2 = slope(plus(state, k1, h / 2.0));
                    let k3 = slope(plus(state, k2, h / 2.0));
                    let k4 = slope(plus(state, k3, h));
                    state = std::array::from_fn(|i| state[i] + h / 6.0 * (k1[i] + 2.0 * k2[i] + 2.0 * k3[i] + k4[i]));
                }
                state
            };
            let (a, b) = (end([1.0, 0.0, 0.0, 0.0]), end([0.0, 1.0 / length, 0.0, 0.0]));
            a[2] * b[3] - a[3] * b[2]
        };
        let euler = height / (TAU * length * length) * (young / (12.0 * density)).sqrt();
        let (mut found, mut low, step) = (Vec::new(), 3.0 * euler, 2.0 * euler);
        while found.len() < count {
            let high = low + step;
            if determinant(low) * determinant(high) < 0.0 {
                let (mut from, mut to) = (low, high);
                for _ in 0..30 {
                    let middle = 0.5 * (from + to);
                    if determinant(from) * determinant(middle) <= 0.0 { to = middle } else { from = middle }
                }
                found.push(0.5 * (from + to));
            }
            low = high;
        }
        found
    }

    fn ringing(frequencies: &[f64], levels_db: &[f64]) -> Vec<RingingMode> {
        let modes = frequencies.iter().zip(levels_db);
        modes.map(|(&frequency_hz, &level_db)| RingingMode { frequency_hz, decay_per_s: 5.0, level_db }).collect()
    }

    #[test]
    fn numbers_of_a_slender_bar_are_those_of_euler_and_bernoulli() {
        let euler = [4.730_041f64, 7.853_205, 10.995_608, 14.137_165].map(|root| root * root);
        for (found, expected) in bar_series(1e-4, 4).iter().zip(euler) {
            assert!((found / expected - 1.0).abs() < 1e-5, "{found} {expected}");
        }
    }

    #[test]
    fn modulus_of_bars_of_known_size_is_found_within_3_percent() {
        // Length, thickness, density, E, Poisson's ratio: steel, glass, wood and plastic.
        let bars = [
            (0.30, 0.006, 7850.0, 2.0e11, 0.29),
            (0.20, 0.010, 2600.0, 6.2e10, 0.20),
            (0.35, 0.020, 750.0, 1.1e10, 0.25),
            (0.15, 0.030, 1190.0, 2.4e9, 0.37),
            (0.10, 0.020, 7850.0, 2.0e11, 0.29),
        ];
        for (length_m, height_m, density, young, poisson) in bars {
            let mut modes =
                ringing(&bar_hz(length_m, height_m, density, young, poisson, 5), &[0.0, -3.0, -8.0, -6.0, -20.0]);
            // Modes of other kinds, torsion or bending sideways.
            let first_hz = modes[0].frequency_hz;
            modes.extend(ringing(&[first_hz * 1.63, first_hz * 3.9, first_hz * 6.6], &[-9.0, -12.0, -6.0]));
            let found = young_modulus(&modes, Solid::Bar { length_m, height_m, density }).expect("a bar").pascals;
            println!("E {young:e} Pa: {:.2} % off", 100.0 * (found.estimate / young - 1.0));
            assert!((found.estimate / young - 1.0).abs() < 0.03, "{young} {found:?}");
        }
    }

    #[test]
    fn modulus_of_a_bar_is_found_from_its_second_and_third_mode_alone() {
        let frequencies = bar_hz(0.3, 0.006, 7850.0, 2.0e11, 0.29, 4);
        let modes = ringing(&frequencies[1..], &[0.0, -2.0, -5.0]);
        let bar = Solid::Bar { length_m: 0.3, height_m: 0.006, density: 7850.0 };
        let found = young_modulus(&modes, bar).expect("a bar").pascals;
        assert!((found.estimate / 2.0e11 - 1.0).abs() < 0.03, "{found:?}");
    }

    #[test]
    fn modulus_of_a_disc_is_found_and_silence_tells_none() {
        let disc = Solid::Disc { radius_m: 0.1, height_m: 0.004, density: 2600.0 };
        let scale = 0.004 / (TAU * 0.01) * (6.2e10f64 / (12.0 * 2600.0 * (1.0 - 0.3 * 0.3))).sqrt();
        let modes = ringing(&DISC.map(|number| number * scale), &[0.0, -6.0, -3.0, -9.0, -8.0, -20.0, -15.0, -30.0]);
        let found = young_modulus(&modes, disc).expect("a disc").pascals;
        assert!((found.estimate / 6.2e10 - 1.0).abs() < 1e-6 && found.low < 6.2e10 && found.high > 6.2e10);
        assert_eq!(young_modulus(&[], disc), None);
    }
}
