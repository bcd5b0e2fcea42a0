//! Search for modes that a model lacks: the likelihood ratio of one more damped sine, over all
//! frequencies and a grid of decays.
//!
//! For a pole z the best such sine explains the energy `2 |Σ r z*ⁿ|² / Σ |z|²ⁿ` of the residual r.
//! For one decay, the sums at all frequencies are one Fourier transform of `r e^{-dn}`.

use std::f64::consts::PI;

use super::noise::NoiseFloor;
use super::pole::Pole;
use crate::parabola;

/// A possible mode.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Candidate {
    pub(crate) pole: Pole,
    /// Energy that the mode explains, in units of the noise variance at its frequency.
    pub(crate) significance: f64,
}

/// Range of the search.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Range {
    /// Slowest decay in 1/sample.
    pub(crate) slowest: f64,
    /// Fastest decay in 1/sample.
    pub(crate) fastest: f64,
    /// Lowest and highest frequency in rad/sample.
    pub(crate) angular: (f64, f64),
}

impl Range {
    /// Decays of the search's grid.
    pub(crate) fn decays(self) -> impl Iterator<Item = f64> {
        let grid = std::iter::successors(Some(self.slowest), |decay| Some(decay * GRID));
        grid.take_while(move |decay| *decay < self.fastest * GRID)
    }

    /// True if a frequency in rad/sample lies within the search.
    pub(crate) fn holds(self, angular: f64) -> bool {
        (self.angular.0..=self.angular.1).contains(&angular)
    }
}

/// Finds the most significant modes; those in the skirt of a stronger one are left to the next
/// pass.
pub(crate) fn search(
    residual: &[f64],
    noise: &NoiseFloor,
    range: Range,
    threshold: f64,
    most: usize,
) -> Vec<Candidate> {
    let mut found: Vec<Candidate> = Vec::new();
    for decay in range.decays() {
        for (angular, energy) in peaks(residual, decay) {
            let significance = energy / noise.variance(angular);
            if significance > threshold && range.holds(angular) {
                found.push(Candidate { pole: Pole { decay, angular }, significance });
            }
        }
    }
    standing_out(found, threshold, most, residual.len())
}

/// Candidates above a threshold that stand out of the skirts of stronger ones, the most significant
/// first. `length` is the longest time in samples that they were seen for.
pub(crate) fn standing_out(mut found: Vec<Candidate>, threshold: f64, most: usize, length: usize) -> Vec<Candidate> {
    found.sort_by(|a, b| b.significance.total_cmp(&a.significance));
    let mut chosen: Vec<Candidate> = Vec::new();
    let threshold = found.first().map_or(threshold, |best| threshold.max(best.significance / IN_ONE_PASS));
    found.retain(|candidate| candidate.significance >= threshold);
    for candidate in found {
        if chosen.len() >= most {
            break;
        }
        if chosen.iter().all(|stronger| stands_out(&candidate, stronger, length)) {
            chosen.push(candidate);
        }
    }
    chosen
}

/// Ratio of successive decays of the grid; a mode half way between loses 3 % of its energy.
const GRID: f64 = 2.0;
/// Factor by which a candidate has to exceed the skirt of a stronger one.
const OVER_SKIRT: f64 = 8.0;

/// Largest ratio of significance to the strongest (20 dB) in one pass.
///
/// A weaker peak may be a remainder of the strongest modes, so it waits for the next pass.
const IN_ONE_PASS: f64 = 100.0;

/// True if a candidate is no part of the skirt of a stronger one, seen for `length` samples.
pub(crate) fn stands_out(candidate: &Candidate, stronger: &Candidate, length: usize) -> bool {
    let distance = candidate.pole.angular - stronger.pole.angular;
    let width = (stronger.pole.decay + candidate.pole.decay).max(PI / length as f64);
    let skirt = stronger.significance * width * width / (width * width + distance * distance);
    candidate.significance > OVER_SKIRT * skirt
}

/// Frequencies in rad/sample at which one more sine of a decay explains most energy, and that
/// energy.
fn peaks(residual: &[f64], decay: f64) -> Vec<(f64, f64)> {
    let length = residual.len().min((6.0 / decay).ceil() as usize + 2);
    let size = (2 * length).next_power_of_two().max(64);
    let transform = fourier::forward(size);
    let mut input = transform.make_input_vec();
    let mut output = transform.make_output_vec();
    let (mut weight, ratio, mut energy) = (1.0, (-decay).exp(), 0.0);
    for (slot, x) in input.iter_mut().zip(&residual[..length]) {
        *slot = x * weight;
        energy += weight * weight;
        weight *= ratio;
    }
    if transform.process(&mut input, &mut output).is_err() {
        return Vec::new();
    }
    let power: Vec<f64> = output.iter().map(|bin| 2.0 * bin.norm_sqr() / energy).collect();
    parabola::peaks(&power).map(|(place, power)| (PI * place / (size / 2) as f64, power)).collect()
}
