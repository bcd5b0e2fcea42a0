//! A new periodic profile with the statistics of a surface.
//!
//! Noise takes in turn the distribution of each octave, the spectrum, the distribution of all
//! waves, and the spectrum again, as surrogate data do (Schreiber and Schmitz 1996): ranks keep
//! their order, bands keep their phases.

use super::statistics::{Octave, Statistics, quantiles};
use super::waves::{curvature_of_height, excess_kurtosis, frequency_per_m, signal, spectrum, within};
use crate::random::SplitMix64;

/// Number of turns.
const TURNS: usize = 30;
/// Number of further turns in which the spikes' size is adjusted.
const ADJUSTED: usize = 30;
/// Largest change of the spikes' exponent in a turn.
const MOST_CHANGE: f64 = 0.05;
/// Least number of waves in a table of an octave whose distribution is kept.
const LEAST_WAVES: f64 = 8.0;

/// Heights in metres of a periodic profile of an even number of points.
pub(super) fn synthesised(statistics: &Statistics, points: usize, step_m: f64, seed: u64) -> Vec<f64> {
    let wanted = Wanted::new(statistics, points, step_m);
    let mut random = SplitMix64(seed);
    let mut curvatures = wanted.with_spectrum((0..points).map(|_| random.normal()).collect());
    for _ in 0..TURNS {
        curvatures = wanted.turned(curvatures, 1.0);
    }
    let kurtosis = excess_kurtosis(&statistics.sorted);
    if !statistics.sorted.is_empty() {
        curvatures = wanted.as_spiky(curvatures, kurtosis);
    }
    heights_of(&curvatures, step_m)
}

/// Statistics that a profile is to have.
struct Wanted<'a> {
    statistics: &'a Statistics,
    points: usize,
    step_m: f64,
    /// Octaves with enough waves, and the values that their ranks get.
    octaves: Vec<(&'a Octave, Vec<f64>)>,
    /// Values that the ranks of all waves get; empty if they are not known.
    all: Vec<f64>,
}

impl<'a> Wanted<'a> {
    fn new(statistics: &'a Statistics, points: usize, step_m: f64) -> Self {
        let length_m = points as f64 * step_m;
        let is_kept = |octave: &&Octave| (octave.edges_per_m[1] - octave.edges_per_m[0]) * length_m >= LEAST_WAVES;
        let octaves = statistics.octaves.iter().filter(is_kept);
        Self {
            statistics,
            points,
            step_m,
            octaves: octaves.map(|octave| (octave, quantiles(&octave.sorted, points))).collect(),
            all: if statistics.sorted.is_empty() { Vec::new() } else { quantiles(&statistics.sorted, points) },
        }
    }

    /// A turn: octaves, spectrum, all waves with their spikes to a power, spectrum.
    fn turned(&self, curvatures: Vec<f64>, exponent: f64) -> Vec<f64> {
        let bins = spectrum(&curvatures);
        let mut sum = vec![0.0; self.points];
        for (octave, values) in &self.octaves {
            let part = ranked(&within(&bins, self.points, self.step_m, octave.edges_per_m), values);
            sum.iter_mut().zip(part).for_each(|(sum, part)| *sum += part);
        }
        let turned = self.with_spectrum(sum);
        if self.all.is_empty() {
            return turned;
        }
        let rms = (self.all.iter().map(|x| x * x).sum::<f64>() / self.points as f64).sqrt();
        let value = |x: &f64| rms * (x / rms).abs().powf(exponent).copysign(*x);
        let values: Vec<f64> = self.all.iter().map(value).collect();
        self.with_spectrum(ranked(&turned, &values))
    }

    /// Further turns until the curvature is as spiky as the surface's; the nearest of all.
    fn as_spiky(&self, from: Vec<f64>, kurtosis: f64) -> Vec<f64> {
        // A normal distribution has 0: 3 more is a ratio.
        let off = |curvatures: &[f64]| ((excess_kurtosis(curvatures) + 3.0) / (kurtosis + 3.0)).ln();
        let mut best = (off(&from).abs(), from.clone());
        let (mut curvatures, mut exponent) = (from, 1.0);
        for _ in 0..ADJUSTED {
            exponent -= (0.5 * off(&curvatures)).clamp(-MOST_CHANGE, MOST_CHANGE);
            curvatures = self.turned(curvatures, exponent);
            let now = off(&curvatures).abs();
            if now < best.0 {
                best = (now, curvatures.clone());
            }
        }
        best.1
    }

    /// Curvatures with the power of each band.
    fn with_spectrum(&self, curvatures: Vec<f64>) -> Vec<f64> {
        let mut bins = spectrum(&curvatures);
        let highest = 1.0 / self.statistics.shortest_m;
        bins[0] *= 0.0;
        for (bin, value) in bins.iter_mut().enumerate() {
            if frequency_per_m(bin, self.points, self.step_m) > highest {
                *value *= 0.0;
            }
        }
        let length_m = self.points as f64 * self.step_m;
        for band in &self.statistics.bands {
            // Bins above the first edge, up to the second.
            let [from, to] = band.edges_per_m.map(|edge| (edge * length_m * (1.0 + 1e-12)) as usize + 1);
            let part = &mut bins[from.min(self.points / 2)..to.min(self.points / 2)];
            if part.is_empty() {
                continue;
            }
            let power = 2.0 * part.iter().map(|bin| bin.norm_sqr()).sum::<f64>() / (self.points as f64).powi(2);
            // A band of few bins has the share of its power that falls on them.
            let width = part.len() as f64 / ((band.edges_per_m[1] - band.edges_per_m[0]) * length_m);
            let scale = (band.power * width / power.max(f64::MIN_POSITIVE)).sqrt();
            part.iter_mut().for_each(|bin| *bin *= scale);
        }
        signal(bins, self.points)
    }
}

/// Values in the order of another list's ranks.
fn ranked(like: &[f64], sorted: &[f64]) -> Vec<f64> {
    let mut order: Vec<usize> = (0..like.len()).collect();
    order.sort_by(|a, b| like[*a].total_cmp(&like[*b]));
    let mut values = vec![0.0; like.len()];
    order.into_iter().zip(sorted).for_each(|(place, value)| values[place] = *value);
    values
}

/// Heights of a periodic profile by its curvatures, with a mean of 0.
fn heights_of(curvatures: &[f64], step_m: f64) -> Vec<f64> {
    let points = curvatures.len();
    let mut bins = spectrum(curvatures);
    for (bin, value) in bins.iter_mut().enumerate() {
        let factor = curvature_of_height(frequency_per_m(bin, points, step_m));
        *value *= if bin == 0 { 0.0 } else { 1.0 / factor };
    }
    signal(bins, points)
}
