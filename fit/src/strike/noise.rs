//! Noise with which the descent begins: what the modes leave, in bands.

use crate::band::{Band, usual_edges_hz};
use crate::distance::Background;
use crate::distance::{Spectrogram, band_power};

/// Number of samples in the frames that measure the noise.
const FRAME: usize = 1024;
/// Number of these frames, which are denser at the beginning.
const FRAMES: usize = 48;
/// Time in seconds behind the beginning of a frame at which its level is measured.
const MIDDLE_S: f64 = 0.008;
/// Level, as a power ratio to the loudest band and frame, below which nothing counts: -60 dB.
const FLOOR: f64 = 1e-6;
/// Decays of noise that the descent may begin with, in dB/s.
const DECAYS_DB_PER_S: [f64; 11] = [1.0, 4.0, 10.0, 20.0, 40.0, 80.0, 160.0, 320.0, 640.0, 1_200.0, 2_400.0];
/// Number of levels of noise that the descent may begin with, from below the floor on.
const LEVELS: u32 = 17;
/// Distance of these levels in dB.
const LEVEL_DB: f64 = 5.0;

/// Noise in bands that brings the levels of a model in a background nearest to the recording's, in
/// decibels.
///
/// Of every band's levels and decays on a coarse grid the best is taken: a start for the descent.
pub(super) fn noise_of(recording: &[f64], left: &[f64], background: Option<&Background>, rate_hz: f64) -> Vec<Band> {
    let spectrogram = Spectrogram::new(FRAME);
    let bins = spectrogram.bin_count();
    let count = spectrogram.frame_count(recording.len());
    let frames: Vec<usize> = (0..=FRAMES).map(|index| count * index * index / (FRAMES * FRAMES)).collect();
    let frames: Vec<usize> = frames.windows(2).filter(|pair| pair[0] < pair[1]).map(|pair| pair[0]).collect();
    let starts_s: Vec<f64> = frames.iter().map(|frame| (frame * spectrogram.hop()) as f64 / rate_hz).collect();
    let model: Vec<f64> = recording.iter().zip(left).map(|(recording, left)| recording - left).collect();
    // Power that noise of unit rms has in a frame, summed over all bins.
    let unit = spectrogram.window().iter().map(|w| w * w).sum::<f64>() * FRAME as f64 / 2.0;
    let [wanted, given] = [recording, &model].map(|sound| -> Vec<f64> {
        let of_frame = |frame: &usize| {
            let from = frame * spectrogram.hop();
            spectrogram.power(&sound[from..sound.len().min(from + FRAME)])
        };
        frames.iter().flat_map(of_frame).collect()
    });
    let edges_hz = usual_edges_hz(rate_hz);
    let powers = |power: &[f64], edge: &[f64]| -> Vec<f64> {
        let [from, to] = [edge[0], edge[1]].map(|hz| hz / rate_hz * FRAME as f64);
        power.chunks_exact(bins).map(|frame| band_power(frame, from, to) / unit).collect()
    };
    let wanted: Vec<Vec<f64>> = edges_hz.windows(2).map(|edge| powers(&wanted, edge)).collect();
    let loudest = wanted.iter().flatten().copied().fold(f64::MIN_POSITIVE, f64::max);
    let floor = FLOOR * loudest;
    let background = background.map_or_else(|| vec![0.0; bins], |background| background.bins(FRAME));
    let bands = edges_hz.windows(2).zip(&wanted).map(|(edge, wanted)| {
        let steady = powers(&background, edge)[0];
        let given: Vec<f64> = powers(&given, edge).iter().map(|power| power + steady).collect();
        let mut best = (f64::INFINITY, 0.0, 100.0);
        for decay_db_per_s in DECAYS_DB_PER_S {
            let falls: Vec<f64> =
                starts_s.iter().map(|start_s| 10f64.powf(-decay_db_per_s * (start_s + MIDDLE_S) / 10.0)).collect();
            for step in 0..LEVELS {
                let power = floor * 10f64.powf(0.1 * LEVEL_DB * (f64::from(step) - 1.0));
                let error = |((wanted, given), fall): ((&f64, &f64), &f64)| {
                    (10.0 * ((given + power * fall + floor) / (wanted + floor)).log10()).powi(2)
                };
                let cost: f64 = wanted.iter().zip(&given).zip(&falls).map(error).sum();
                if cost < best.0 {
                    best = (cost, power, decay_db_per_s);
                }
            }
        }
        Band { edges_hz: [edge[0], edge[1]], weight: best.1.sqrt(), decay_db_per_s: best.2 }
    });
    bands.collect()
}
