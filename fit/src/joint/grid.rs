//! Frames in which a strike and its model are compared, and the levels that are wanted there.
//!
//! Every grid begins before the onset, so that each sample of the attack lies under the middle of
//! some frame's window.

use super::cell::DECIBELS;
use crate::distance::{ErbLevels, Spectrogram};
use crate::hearing::{Partial, threshold_db};
use crate::vectors::dot;

/// Power relative to the loudest cell below which nothing counts: 60 dB.
const FLOOR: f32 = 1e-6;
/// Level in dB SPL of the loudest band and frame.
const LOUDEST_DB: f64 = 85.0;
/// Exponent of a power by which partials are weighed.
const WEIGHT: f32 = 0.3;
/// Exponent of loudness.
pub(super) const LOUDNESS: f32 = 0.23;

/// Cells of a frame: single bins, or bands of bins.
#[derive(Clone, Debug)]
pub(super) enum Cells {
    /// Each bin is a cell.
    Bins,
    /// Bands, each with its first bin and the shares of the bins from there on.
    Bands(Vec<(usize, Vec<f32>)>),
}

/// A frame that is compared.
#[derive(Clone, Copy, Debug)]
pub(super) struct Frame {
    /// First sample, counted from the onset.
    pub(super) start: i64,
    /// Weight of the frame's distance in dB.
    pub(super) weight: f32,
    /// Weight of the frame's error of loudness.
    pub(super) loudness_weight: f32,
}

/// Frames of one length, and the levels wanted in them.
pub(super) struct Grid {
    /// Number of samples in a frame.
    pub(super) size: usize,
    pub(super) frames: Vec<Frame>,
    pub(super) cells: Cells,
    /// Reciprocal of the number of independent values in each cell.
    pub(super) freedom: Vec<f32>,
    /// Natural logarithm of the wanted power with the floor, frame after frame.
    pub(super) wanted_ln: Vec<f32>,
    /// Power that is heard at the threshold in each cell; empty if loudness is not compared.
    pub(super) threshold: Vec<f32>,
    /// Wanted loudness of each cell, frame after frame; empty if loudness is not compared.
    pub(super) wanted_loudness: Vec<f32>,
    pub(super) floor: f32,
    /// Weight of each cell, frame after frame, with a sum of 1 a frame.
    pub(super) weights: Vec<f32>,
}

impl Grid {
    /// Wanted levels of a strike, whose onset is sample `onset` of `sound`.
    pub(super) fn new(sound: &[f64], onset: usize, size: usize, frames: Vec<Frame>, cells: Cells) -> Self {
        let spectrogram = Spectrogram::new(size);
        let mut wanted = Vec::new();
        for frame in &frames {
            let start = onset as i64 + frame.start;
            let samples: Vec<f64> = (start..start + size as i64)
                .map(|at| usize::try_from(at).ok().and_then(|at| sound.get(at)).copied().unwrap_or(0.0))
                .collect();
            let power: Vec<f32> = spectrogram.power(&samples).iter().map(|power| *power as f32).collect();
            wanted.extend(powers(&cells, &power));
        }
        let floor = FLOOR * wanted.iter().copied().fold(f32::MIN_POSITIVE, f32::max);
        let freedom = match &cells {
            Cells::Bins => vec![1.0; size / 2 + 1],
            Cells::Bands(bands) => {
                bands.iter().map(|(_, shares)| (1.5 / shares.iter().sum::<f32>().max(1e-6)).min(1.0)).collect()
            }
        };
        let weights = vec![1.0 / freedom.len() as f32; wanted.len()];
        Self {
            size,
            frames,
            cells,
            freedom,
            wanted_ln: wanted.iter().map(|power| (power + floor).ln()).collect(),
            threshold: Vec::new(),
            wanted_loudness: wanted,
            floor,
            weights,
        }
    }

    /// Levels of partials, each in the spectrum of 8192 samples in which it is loudest.
    ///
    /// A partial's level is the power of three bins. `None` without partials.
    pub(super) fn of_partials(
        sound: &[f64],
        onset: usize,
        rate_hz: f64,
        partials: &[Partial],
        weight: f32,
    ) -> Option<Self> {
        const SIZE: usize = 8_192;
        let start = |partial: &Partial| (partial.at_s * rate_hz).round() as i64;
        let mut starts: Vec<i64> = partials.iter().map(start).collect();
        starts.sort_unstable();
        starts.dedup();
        let bin = |partial: &Partial| (partial.frequency_hz * SIZE as f64 / rate_hz).round() as usize;
        let cells = partials.iter().map(|partial| (bin(partial).max(1) - 1, vec![1.0; 3])).collect();
        let count = partials.len().max(1) as f32;
        let of_start = |start_of: i64| partials.iter().filter(|partial| start(partial) == start_of).count() as f32;
        let frame = |&start: &i64| Frame { start, weight: weight * of_start(start) / count, loudness_weight: 0.0 };
        let mut grid = Self::new(sound, onset, SIZE, starts.iter().map(frame).collect(), Cells::Bands(cells));
        let is_in = |at: i64| move |partial: &Partial| if start(partial) == at { 1.0 / of_start(at) } else { 0.0 };
        grid.weights = starts.iter().flat_map(|&at| partials.iter().map(is_in(at))).collect();
        (!partials.is_empty()).then_some(grid)
    }

    /// Weighs the cells of each frame by the loudness of what is wanted there.
    pub(super) fn with_weights(mut self) -> Self {
        let count = self.cell_count();
        self.weights = self.wanted_loudness.iter().map(|power| (power / self.floor).powf(WEIGHT)).collect();
        for weights in self.weights.chunks_mut(count) {
            let sum = weights.iter().sum::<f32>().max(f32::MIN_POSITIVE);
            weights.iter_mut().for_each(|weight| *weight /= sum);
        }
        self
    }

    /// Compares loudness, too, in the bands of the ERB distance.
    pub(super) fn with_loudness(mut self) -> Self {
        let edges = ErbLevels::edges_hz();
        let loudest = self.wanted_loudness.iter().copied().fold(f32::MIN_POSITIVE, f32::max);
        self.threshold = edges
            .windows(2)
            .map(|edge| {
                let hz = 0.5 * (edge[0] + edge[1]);
                loudest * 10f32.powf((threshold_db(hz) - LOUDEST_DB) as f32 / 10.0)
            })
            .collect();
        let count = self.threshold.len();
        for cells in self.wanted_loudness.chunks_mut(count) {
            for (power, threshold) in cells.iter_mut().zip(&self.threshold) {
                *power = (1.0 + *power / threshold).powf(LOUDNESS);
            }
        }
        self
    }

    /// Number of bins of a frame.
    pub(super) fn bins(&self) -> usize {
        self.size / 2 + 1
    }

    /// Number of cells of a frame.
    pub(super) fn cell_count(&self) -> usize {
        self.freedom.len()
    }
}

/// Powers of the cells of a frame.
#[inline(always)]
pub(super) fn powers(cells: &Cells, power: &[f32]) -> Vec<f32> {
    match cells {
        Cells::Bins => power.to_vec(),
        Cells::Bands(bands) => {
            bands.iter().map(|(first, shares)| dot(power.get(*first..).unwrap_or(&[]), shares)).collect()
        }
    }
}

/// Bands between edges in Hz, for frames of `size` samples.
pub(super) fn bands(edges_hz: &[f64], size: usize, rate_hz: f64) -> Cells {
    let places: Vec<f64> = edges_hz.iter().map(|edge| edge / rate_hz * size as f64).collect();
    let band = |place: &[f64]| {
        let first = (place[0] - 0.5).floor().max(0.0) as usize;
        let last = ((place[1] + 0.5).ceil() as usize).min(size / 2);
        let share = |bin: usize| {
            let bin = bin as f64;
            (place[1].min(bin + 0.5) - place[0].max(bin - 0.5)).clamp(0.0, 1.0) as f32
        };
        (first.min(size / 2), (first..=last).map(share).collect())
    };
    Cells::Bands(places.windows(2).map(band).collect())
}

/// Squared decibels below which a frame's rms counts as none: the slope of its root stays finite.
pub(super) const LEAST_SQUARE: f32 = 1e-3 * DECIBELS;
