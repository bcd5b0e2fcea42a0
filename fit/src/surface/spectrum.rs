//! Power spectral density of heights.

use std::f64::consts::TAU;

use super::profile::{Profiles, level};
use super::waves::{frequency_per_m, spectrum};

/// Largest number of points of a piece.
const PIECE: usize = 8192;
/// Number of levels of an octave.
const PER_OCTAVE: i32 = 12;

/// Level of a spectrum in a twelfth of an octave.
#[derive(Clone, Copy, Debug)]
pub(super) struct Level {
    /// Middle of the band in cycles per metre.
    pub(super) frequency_per_m: f64,
    /// Mean power spectral density of heights in the band, in dB of 1 m³.
    pub(super) db: f64,
}

/// Levels of twelfth octaves, in order of frequency, by Welch's method: straight lines
/// are taken off the pieces, and the window of Blackman and Harris (1978), whose side lobes lie
/// 92 dB low, keeps the long waves off the short ones.
pub(super) fn levels(profiles: &Profiles) -> Vec<Level> {
    let mut piece = PIECE;
    while piece > (profiles.points() / 4).max(128) {
        piece /= 2;
    }
    let turn = TAU / piece as f64;
    let blackman_harris = |n: usize| {
        let wave = |k: f64| (k * turn * n as f64).cos();
        0.35875 - 0.48829 * wave(1.0) + 0.14128 * wave(2.0) - 0.01168 * wave(3.0)
    };
    let window: Vec<f64> = (0..piece).map(blackman_harris).collect();
    let energy: f64 = window.iter().map(|w| w * w).sum();
    let (mut power, mut count) = (vec![0.0; piece / 2 + 1], 0.0);
    for row in &profiles.rows {
        for begin in (0..=row.len() - piece).step_by(piece / 2) {
            let mut seen = row[begin..begin + piece].to_vec();
            level(&mut seen);
            seen.iter_mut().zip(&window).for_each(|(height, w)| *height *= w);
            power.iter_mut().zip(spectrum(&seen)).for_each(|(power, bin)| *power += bin.norm_sqr());
            count += 1.0;
        }
    }
    let density = |bin: usize| 2.0 * power[bin] * profiles.step_m / (count * energy);
    let highest = 0.5 / profiles.step_m;
    let mut levels = Vec::new();
    let mut upper = highest;
    while upper > 2.0 / (piece as f64 * profiles.step_m) {
        let lower = upper * 2f64.powf(-1.0 / f64::from(PER_OCTAVE));
        let bins = (1..piece / 2).filter(|bin| {
            let frequency = frequency_per_m(*bin, piece, profiles.step_m);
            frequency > lower && frequency <= upper
        });
        let densities: Vec<f64> = bins.map(density).collect();
        if !densities.is_empty() {
            let mean = densities.iter().sum::<f64>() / densities.len() as f64;
            levels.push(Level { frequency_per_m: (lower * upper).sqrt(), db: 10.0 * mean.max(1e-60).log10() });
        }
        upper = lower;
    }
    levels.reverse();
    levels
}
