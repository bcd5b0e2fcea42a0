//! Guess at an object's material, from the damping of its modes.
//!
//! Modal sound synthesis describes damping by Rayleigh's law, `d(ω) = (α + β ω²)/2` with two
//! numbers a material, given here as published for sounding objects. The law ignores how the object
//! is held, and the air round it. So the result is a guess with a confidence.

use serde::Serialize;

use crate::strike::Fit;

/// Name, α in 1/s and β in s of each material.
const MATERIALS: [(&str, f64, f64); 7] = [
    ("ceramic", 6.0, 1e-7),
    ("glass", 1.0, 1e-7),
    ("wood", 60.0, 2e-6),
    ("plastic", 30.0, 1e-6),
    ("polycarbonate", 0.5, 4e-7),
    ("steel", 5.0, 3e-8),
    ("tin", 2.0, 3e-8),
];
/// Standard deviation of ln decay of an object's modes about the material's law: a factor of 2.5.
const SCATTER: f64 = 0.9;
/// Amplitude, relative to the strongest mode, below which a mode does not count: 40 dB.
const LEAST_AMPLITUDE: f64 = 0.01;

/// A guess at a material.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Guess {
    /// Name of the material.
    pub name: &'static str,
    /// Share of the likelihood among the materials known here, 0 to 1.
    pub confidence: f64,
}

/// The material whose damping law the modes of a fit follow best; `None` for a fit without modes.
///
/// Strong and lasting modes weigh most.
pub fn guess(fit: &Fit) -> Option<Guess> {
    let place = if fit.measured { 0 } else { fit.loudest };
    let amplitude = |gains: &[[f64; 2]]| gains.get(place).map_or(0.0, |[sine, cosine]| sine.hypot(*cosine));
    let modes: Vec<(f64, f64, f64)> =
        fit.modes.iter().map(|mode| (mode.frequency_hz, mode.decay_per_s, amplitude(&mode.gains))).collect();
    // Strength is energy, because short modes are often no more than a rough attack.
    let energy = |mode: &(f64, f64, f64)| mode.2 * mode.2 / mode.1;
    let most = modes.iter().map(energy).fold(0.0, f64::max);
    let counted: Vec<_> = modes.iter().filter(|mode| energy(mode) > most * LEAST_AMPLITUDE * LEAST_AMPLITUDE).collect();
    let weight = |mode: &(f64, f64, f64)| (energy(mode) / most).sqrt();
    let weights: f64 = counted.iter().map(|mode| weight(mode)).sum();
    if weights <= 0.0 {
        return None;
    }
    let likelihoods = MATERIALS.map(|(name, alpha, beta)| {
        let misfit: f64 = counted
            .iter()
            .map(|mode| {
                let omega = std::f64::consts::TAU * mode.0;
                let law = 0.5 * (alpha + beta * omega * omega);
                weight(mode) * (mode.1 / law).ln().powi(2)
            })
            .sum();
        (name, (-0.5 * misfit / weights / (SCATTER * SCATTER)).exp())
    });
    let all: f64 = likelihoods.iter().map(|(_, likelihood)| likelihood).sum();
    let (name, likelihood) = likelihoods.into_iter().max_by(|a, b| a.1.total_cmp(&b.1))?;
    Some(Guess { name, confidence: if all > 0.0 { likelihood / all } else { 0.0 } })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::strike::Mode;

    #[test]
    fn modes_that_follow_a_materials_law_are_guessed_as_that_material() {
        for (name, alpha, beta) in MATERIALS {
            let modes = [300.0, 750.0, 1400.0, 2600.0, 5200.0, 9000.0].map(|frequency_hz| Mode {
                frequency_hz,
                decay_per_s: 0.5 * (alpha + beta * (std::f64::consts::TAU * frequency_hz).powi(2)),
                gains: vec![[1.0, 0.0]],
            });
            let fit = Fit { modes: modes.into(), ..Fit::silent(44_100.0) };
            assert_eq!(guess(&fit).map(|guess| guess.name), Some(name));
        }
    }
}
