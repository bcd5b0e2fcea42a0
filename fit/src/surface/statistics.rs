//! Statistics of a surface's curvature: spectrum, and distribution octave by octave.

use std::f64::consts::PI;

use fourier::Complex;

use super::profile::Profiles;
use super::waves::{curvature_of_height, frequency_per_m, signal, spectrum, within};

/// Least number of bins of a row's spectrum in a band.
const BINS: f64 = 3.0;
/// Longest wavelength in metres whose octave stands alone.
const LONGEST_M: f64 = 20e-3;
/// Length of the fade at either end of a row, in shortest waves.
const FADE: f64 = 20.0;

/// Power of the curvature in a band.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Band {
    /// Edges in cycles per metre: above the first, up to the second.
    pub(super) edges_per_m: [f64; 2],
    /// Mean square in 1/m².
    pub(super) power: f64,
}

/// Distribution of the curvature's waves in an octave.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Octave {
    /// Edges in cycles per metre: above the first, up to the second.
    pub(super) edges_per_m: [f64; 2],
    /// Curvatures in 1/m, in order of size.
    pub(super) sorted: Vec<f64>,
}

/// Statistics of a surface's curvature.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Statistics {
    /// Shortest wavelength in metres.
    pub(super) shortest_m: f64,
    /// Power in bands of one width, from the shortest waves on; the last reaches down to 0.
    pub(super) bands: Vec<Band>,
    /// Distributions, from the shortest octave on; the last reaches down to 0.
    pub(super) octaves: Vec<Octave>,
    /// Curvatures of all waves in 1/m, in order of size; empty where waves were added.
    pub(super) sorted: Vec<f64>,
}

/// Spectra of the rows' curvature, faded at their ends.
pub(super) struct Curvature {
    step_m: f64,
    points: usize,
    fade: usize,
    rows: Vec<Vec<Complex<f64>>>,
    /// Mean square of the waves below each bin.
    below: Vec<f64>,
}

impl Curvature {
    /// Spectra of the curvature of all waves down to `shortest_m`.
    pub(super) fn new(profiles: &Profiles, shortest_m: f64) -> Self {
        let points = profiles.points();
        let fade = ((FADE * shortest_m / profiles.step_m) as usize).min(points / 4);
        let weight = |index: usize| {
            let from_end = index.min(points - 1 - index);
            if from_end < fade { 0.5 - 0.5 * (PI * (from_end as f64 + 0.5) / fade as f64).cos() } else { 1.0 }
        };
        let weights: Vec<f64> = (0..points).map(weight).collect();
        let row = |row: &Vec<f64>| {
            let faded: Vec<f64> = row.iter().zip(&weights).map(|(height, weight)| height * weight).collect();
            let mut bins = spectrum(&faded);
            for (bin, value) in bins.iter_mut().enumerate() {
                let frequency = frequency_per_m(bin, points, profiles.step_m);
                *value *= if frequency > 1.0 / shortest_m { 0.0 } else { curvature_of_height(frequency) };
            }
            bins
        };
        let seen = weights.iter().map(|weight| weight * weight).sum::<f64>() / points as f64;
        let rows: Vec<Vec<Complex<f64>>> = profiles.rows.iter().map(row).collect();
        let scale = 2.0 / ((points as f64).powi(2) * rows.len() as f64 * seen);
        let mut below = vec![0.0];
        for bin in 0..=points / 2 {
            let power: f64 = rows.iter().map(|row| row[bin].norm_sqr()).sum();
            below.push(below[bin] + scale * power);
        }
        Self { step_m: profiles.step_m, points, fade, rows, below }
    }

    /// Mean square of the waves in a band, above the first frequency and up to the second.
    ///
    /// Each bin's power is spread evenly over its width.
    pub(super) fn power(&self, edges_per_m: [f64; 2]) -> f64 {
        let below = |edge_per_m: f64| {
            let place = (edge_per_m * self.points as f64 * self.step_m + 0.5).clamp(0.0, (self.below.len() - 1) as f64);
            let bin = (place as usize).min(self.below.len() - 2);
            self.below[bin] + (place - bin as f64) * (self.below[bin + 1] - self.below[bin])
        };
        below(edges_per_m[1]) - below(edges_per_m[0])
    }

    /// Width in cycles per metre of the narrowest band that has a power of its own.
    fn narrowest_per_m(&self) -> f64 {
        BINS / (self.points as f64 * self.step_m)
    }

    /// Curvatures of the waves in a band, in order of size, without the faded ends.
    fn sorted(&self, edges_per_m: [f64; 2]) -> Vec<f64> {
        let unfaded = |all: Vec<f64>| all[self.fade..self.points - self.fade].to_vec();
        let row = |bins: &Vec<Complex<f64>>| unfaded(within(bins, self.points, self.step_m, edges_per_m));
        in_order(self.rows.iter().flat_map(row).collect())
    }

    /// Curvatures of all waves in 1/m, in order of size, without the faded ends.
    pub(super) fn all_sorted(&self) -> Vec<f64> {
        let row =
            |bins: &Vec<Complex<f64>>| signal(bins.clone(), self.points)[self.fade..self.points - self.fade].to_vec();
        in_order(self.rows.iter().flat_map(row).collect())
    }
}

fn in_order(mut values: Vec<f64>) -> Vec<f64> {
    values.sort_by(f64::total_cmp);
    values
}

/// Statistics of the curvature of all waves down to `shortest_m`, for a table of a length.
pub(super) fn statistics(curvature: &Curvature, shortest_m: f64, length_m: f64) -> Statistics {
    let highest = 1.0 / shortest_m;
    let width = curvature.narrowest_per_m().max(1.0 / length_m);
    // Edges lie between the table's waves.
    let count = (highest / width) as usize;
    let edge = |index: usize| if index == count { 0.0 } else { highest - (index as f64 - 0.5).max(0.0) * width };
    let bands = (0..count).map(|index| [edge(index + 1), edge(index)]);
    Statistics {
        shortest_m,
        bands: bands.map(|edges_per_m| Band { edges_per_m, power: curvature.power(edges_per_m) }).collect(),
        octaves: octaves(highest)
            .into_iter()
            .map(|edges_per_m| Octave { edges_per_m, sorted: curvature.sorted(edges_per_m) })
            .collect(),
        sorted: curvature.all_sorted(),
    }
}

/// Edges of octaves from a frequency down; the last reaches down to 0.
fn octaves(highest_per_m: f64) -> Vec<[f64; 2]> {
    let mut all = Vec::new();
    let mut upper = highest_per_m;
    while 0.5 * upper > 1.0 / LONGEST_M {
        all.push([0.5 * upper, upper]);
        upper *= 0.5;
    }
    all.push([0.0, upper]);
    all
}

/// Values of `count` evenly spaced ranks of an ordered list.
pub(super) fn quantiles(sorted: &[f64], count: usize) -> Vec<f64> {
    let last = sorted.len().saturating_sub(1);
    let at = |index: usize| {
        let place = (index as f64 + 0.5) / count as f64 * sorted.len() as f64 - 0.5;
        let below = (place.max(0.0) as usize).min(last);
        let share = (place - below as f64).clamp(0.0, 1.0);
        sorted[below] + share * (sorted[(below + 1).min(last)] - sorted[below])
    };
    (0..count).map(at).collect()
}
