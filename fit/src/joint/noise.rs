//! Expected power of decaying noise in bands, in the cells of a grid.

use std::f64::consts::{LN_10, TAU};

use super::grid::{Cells, Frame, powers};
use crate::distance::Spectrogram;

/// Number of lines to a cycle per sample of the instrument's noise.
const LINES: f64 = 1024.0;
/// Number of points at which a window is sampled for the decay within a frame.
const POINTS: usize = 24;

/// Power of each noise band in the cells of one grid.
pub(super) struct NoiseGrid {
    /// First cell and powers for unit rms, by band, of frames that begin after the onset.
    ringing: Vec<(usize, Vec<f32>)>,
    /// Index of a frame that contains the onset, and the powers of all cells by band.
    onsets: Vec<(usize, Vec<Vec<f32>>)>,
    /// Times in seconds and weights at which the decay within a frame is sampled.
    points: Vec<(f64, f64)>,
    starts_s: Vec<f64>,
}

/// Decay of a band's power in a frame, and its derivative by the decay in dB/s.
pub(super) type Fall = (f32, f32);

impl NoiseGrid {
    pub(super) fn new(edges_hz: &[f64], rate_hz: f64, size: usize, frames: &[Frame], cells: &Cells) -> Self {
        let bins = size / 2 + 1;
        let window: Vec<f64> = (0..size).map(|n| 0.5 - 0.5 * (TAU * n as f64 / size as f64).cos()).collect();
        let energy: f64 = window.iter().map(|w| w * w).sum();
        let places: Vec<f64> = edges_hz.iter().map(|edge| edge / rate_hz * size as f64).collect();
        // Noise of unit rms in a band has this power in a bin that lies wholly in it.
        let full = |place: &[f64]| energy * size as f64 / (2.0 * (place[1] - place[0]).max(1e-9));
        let ringing = places.windows(2).map(|place| {
            let cover = |bin: f64| {
                let half = 0.5 * (1.0 + size as f64 / LINES);
                let overlap = (place[1].min(bin + half) - place[0].max(bin - half)).max(0.0);
                overlap / (2.0 * half)
            };
            // A Hann window has a sixth of its energy in either neighbour.
            let power: Vec<f32> = (0..bins)
                .map(|bin| {
                    let bin = bin as f64;
                    (full(place) * (cover(bin - 1.0) / 6.0 + cover(bin) / 1.5 + cover(bin + 1.0) / 6.0)) as f32
                })
                .collect();
            sparse(powers(cells, &power))
        });
        let onsets = frames.iter().enumerate().filter(|(_, frame)| frame.start < 0).map(|(index, frame)| {
            let kernel = kernel(&window, usize::try_from(-frame.start).unwrap_or(0));
            let by_band = places.windows(2).map(|place| {
                let power: Vec<f32> = (0..bins)
                    .map(|bin| {
                        let share =
                            sum_below(&kernel, bin as f64 - place[0]) - sum_below(&kernel, bin as f64 - place[1]);
                        (full(place) * share) as f32
                    })
                    .collect();
                powers(cells, &power)
            });
            (index, by_band.collect())
        });
        let point = |index: usize| {
            let place = (index as f64 + 0.5) / POINTS as f64;
            let at = (place * size as f64) as usize;
            (place * size as f64 / rate_hz, window.get(at).map_or(0.0, |w| w * w))
        };
        let points: Vec<(f64, f64)> = (0..POINTS).map(point).collect();
        let sum: f64 = points.iter().map(|point| point.1).sum();
        Self {
            ringing: ringing.collect(),
            onsets: onsets.collect(),
            points: points.into_iter().map(|(time, weight)| (time, weight / sum)).collect(),
            starts_s: frames.iter().map(|frame| frame.start as f64 / rate_hz).collect(),
        }
    }

    /// Decay of a band's power in every frame.
    pub(super) fn falls(&self, decay_db_per_s: f64) -> Vec<Fall> {
        let rate = LN_10 / 10.0 * decay_db_per_s;
        let within = |from_s: f64| {
            let (mut sum, mut slope) = (0.0, 0.0);
            for &(time_s, weight) in self.points.iter().filter(|point| point.0 + from_s >= 0.0) {
                let left = weight * (-rate * (time_s + from_s)).exp();
                sum += left;
                slope -= LN_10 / 10.0 * (time_s + from_s) * left;
            }
            (sum, slope)
        };
        let (sum, slope) = within(0.0);
        let fall = |&start_s: &f64| {
            if start_s < 0.0 {
                let (sum, slope) = within(start_s);
                return (sum as f32, slope as f32);
            }
            let left = (-rate * start_s).exp();
            ((left * sum) as f32, (left * (slope - LN_10 / 10.0 * start_s * sum)) as f32)
        };
        self.starts_s.iter().map(fall).collect()
    }

    /// Powers of a band in the cells of a frame for unit rms, and the first of these cells.
    pub(super) fn powers(&self, band: usize, frame: usize) -> (usize, &[f32]) {
        match self.onsets.iter().find(|onset| onset.0 == frame) {
            Some((_, bands)) => (0, &bands[band]),
            None => (self.ringing[band].0, &self.ringing[band].1),
        }
    }
}

/// The powers without zeros at either end, and the index of the first.
fn sparse(power: Vec<f32>) -> (usize, Vec<f32>) {
    let first = power.iter().position(|power| *power > 0.0).unwrap_or(0);
    let last = power.iter().rposition(|power| *power > 0.0).map_or(first, |last| last + 1);
    (first, power[first..last].to_vec())
}

/// Power spectrum, of sum 1, of a window that is 0 before sample `from`, by distance in bins.
fn kernel(window: &[f64], from: usize) -> Vec<f64> {
    let mut cut = window.to_vec();
    cut.iter_mut().take(from).for_each(|w| *w = 0.0);
    let half = Spectrogram::rectangular_power(&cut);
    let sum: f64 = half.iter().sum::<f64>() * 2.0 - half.first().unwrap_or(&0.0) - half.last().unwrap_or(&0.0);
    half.iter().map(|power| power / sum.max(f64::MIN_POSITIVE)).collect()
}

/// Share of a kernel's energy at distances below `distance` bins.
fn sum_below(kernel: &[f64], distance: f64) -> f64 {
    let reach = distance.abs();
    let whole = (reach + 0.5).floor() as usize;
    let inner: f64 = kernel.iter().take(whole).sum::<f64>() - 0.5 * kernel.first().unwrap_or(&0.0);
    let part = kernel.get(whole).unwrap_or(&0.0) * (reach + 0.5 - whole as f64);
    // Bin 0 reaches half a bin to either side.
    let half = if reach < 0.5 { kernel.first().unwrap_or(&0.0) * reach } else { inner + part };
    0.5 + half.min(0.5) * distance.signum()
}
