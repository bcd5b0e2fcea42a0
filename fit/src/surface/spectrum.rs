//! Power spectral density of heights.

use std::f64::consts::TAU;

use super::profile::Profiles;
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

/// Levels of twelfth octaves, in order of frequency, by Welch's method with Hann windows.
pub(super) fn levels(profiles: &Profiles) -> Vec<Level> {
    let mut piece = PIECE;
    while piece > (profiles.points() / 4).max(128) {
        piece /= 2;
    }
    let window: Vec<f64> = (0..piece).map(|n| 0.5 - 0.5 * (TAU * n as f64 / piece as f64).cos()).collect();
    let energy: f64 = window.iter().map(|w| w * w).sum();
    let (mut power, mut count) = (vec![0.0; piece / 2 + 1], 0.0);
    for row in &profiles.rows {
        for begin in (0..=row.len() - piece).step_by(piece / 2) {
            let part = &row[begin..begin + piece];
            let mean = part.iter().sum::<f64>() / piece as f64;
            let seen: Vec<f64> = part.iter().zip(&window).map(|(height, w)| (height - mean) * w).collect();
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
