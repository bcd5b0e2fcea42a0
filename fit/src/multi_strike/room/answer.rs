//! The common answer of a room: what follows every strike alike beside the modes.
//!
//! One place means that a strike is heard as its force convolved with one response. The modes are
//! part of it; the rest, r, is the room's answer to them (diffimpact eq. 1). With the force of all
//! strikes F known, r minimises
//!
//! ```text
//! |e - F ⊗ r|² + λ |r|²
//! ```
//!
//! for the residual e of the modes. The normal equations are Toeplitz, and are solved by conjugate
//! gradients.

use super::super::descend::Fitted;
use super::super::model::Strike;
use super::convolution::{convolved, correlated};

/// Length of the answer in seconds.
const LENGTH_S: f64 = 1.5;
/// Maximum number of steps of the conjugate gradients.
const STEPS: usize = 80;
/// Ratio of the last gradient to the first at which the steps end.
const SETTLED: f64 = 1e-4;
/// Share of the force's energy that is added to the diagonal of the normal equations.
const RIDGE: f64 = 0.02;

/// Answer to a force of 1 in one sample, sample by sample.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Answer {
    pub(crate) samples: Vec<f64>,
}

impl Answer {
    /// Answer of a place without a room.
    pub(crate) fn none() -> Self {
        Self { samples: Vec::new() }
    }

    /// Answer that all strikes of a model have in common, from what its modes leave of a recording.
    pub(crate) fn of(heard: &Fitted, rate_hz: f64) -> Self {
        let residual = &heard.residual;
        let length = ((LENGTH_S * rate_hz) as usize).min(residual.len());
        let forces = forces(&heard.model.strikes, residual.len());
        let mut powers = correlated(&forces, &forces, length);
        if powers.first().is_none_or(|power| *power <= 0.0) {
            return Self::none();
        }
        powers[0] *= 1.0 + RIDGE;
        // The autocorrelation of both signs, in the order of a convolution.
        let mirrored: Vec<f64> = powers.iter().skip(1).rev().chain(&powers).copied().collect();
        let normal = |x: &[f64]| convolved(&mirrored, x, length - 1..2 * length - 1);
        let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        let mut samples = vec![0.0; length];
        let mut gradient = correlated(&forces, residual, length);
        let mut along = gradient.clone();
        let mut size = dot(&gradient, &gradient);
        let least = size * SETTLED * SETTLED;
        for _ in 0..STEPS {
            if size <= least {
                break;
            }
            let bent = normal(&along);
            let step = size / dot(&along, &bent);
            samples.iter_mut().zip(&along).for_each(|(x, along)| *x += step * along);
            gradient.iter_mut().zip(&bent).for_each(|(x, bent)| *x -= step * bent);
            let next = dot(&gradient, &gradient);
            along.iter_mut().zip(&gradient).for_each(|(along, x)| *along = x + next / size * *along);
            size = next;
        }
        Self { samples }
    }

    /// The recording without the answer to its strikes.
    pub(crate) fn taken_off(&self, recording: &[f64], strikes: &[Strike]) -> Vec<f64> {
        let forces = forces(strikes, recording.len());
        let answered = convolved(&forces, &self.samples, 0..recording.len());
        recording.iter().zip(&answered).map(|(x, answered)| x - answered).collect()
    }
}

/// Forces of all strikes, sample by sample.
fn forces(strikes: &[Strike], length: usize) -> Vec<f64> {
    let mut forces = vec![0.0; length];
    for strike in strikes {
        let contact = strike.contact;
        let [first, last] = [contact.first_sample(), contact.end_sample()].map(|at| (at.max(0.0) as usize).min(length));
        for (n, force) in (first..).zip(&mut forces[first..last]) {
            *force += contact.peak * contact.force(n as f64)[0];
        }
    }
    forces
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::multi_strike::synthetic::plain;
    use crate::multi_strike::truth::model_of;
    use crate::multi_strike::whitening::Whitening;
    use crate::random::SplitMix64;

    #[test]
    fn an_answer_that_all_strikes_have_is_found_and_taken_off() {
        let sound = plain(5, 6.0, 10, -90.0);
        let model = model_of(&sound);
        let mut random = SplitMix64(6);
        let forces = forces(&model.strikes, sound.samples.len());
        // Of 200 Hz to 1 kHz or so: forces tell no higher frequencies.
        let mut low = [0.0; 2];
        let given: Vec<f64> = (0..20_000)
            .map(|n| {
                low[0] += 0.1 * (random.normal() - low[0]);
                low[1] += 0.1 * (low[0] - low[1]);
                1e-3 * low[1] * (-2e-4 * f64::from(n)).exp()
            })
            .collect();
        let answered = convolved(&forces, &given, 0..forces.len());
        let recording: Vec<f64> = sound.samples.iter().zip(&answered).map(|(x, answered)| x + answered).collect();
        let heard = Fitted::new(model, &recording, &Whitening::none());
        let found = Answer::of(&heard, sound.rate_hz);
        let energy = |sound: &[f64]| sound.iter().map(|x| x * x).sum::<f64>();
        let apart: Vec<f64> = found.samples.iter().zip(&given).map(|(found, given)| found - given).collect();
        let error_db = 10.0 * (energy(&apart) / energy(&given)).log10();
        assert!(error_db < -15.0, "{error_db}");
        let left = heard.model.strikes.as_slice();
        let dried = found.taken_off(&recording, left);
        let left: Vec<f64> = dried.iter().zip(&sound.samples).map(|(dried, dry)| dried - dry).collect();
        let left_db = 10.0 * (energy(&left) / energy(&answered)).log10();
        assert!(left_db < -25.0, "{left_db}");
    }
}
