//! What the modes leave: noise in bands that die away each at its own rate (physics-diffusion eq. 5, 6).
//!
//! `R(t) = Σ_m w_m 10^{-γ_m t/20} B_m(t)`, with B_m Gaussian noise of unit rms in band m. In place of the paper's trained encoder the weights
//! and decays are fitted, band by band, to the power that the recording has beyond the model's.

use fourier::Complex;
use serde::Serialize;

use crate::distance::Spectrogram;
use crate::synthetic::SplitMix64;

/// A band of decaying noise.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Band {
    /// Lower and upper edge in Hz.
    pub edges_hz: [f64; 2],
    /// Rms at t = 0, full scale 1; 0 for a band in which the modes leave nothing.
    pub weight: f64,
    /// Decay in dB/s, 0 and more.
    pub decay_db_per_s: f64,
}

/// Bands unless asked otherwise, as in the paper.
pub const BANDS: usize = 100;
/// Lowest edge in Hz.
const LOWEST_HZ: f64 = 50.0;
/// Windows of the level in samples. A band takes the first one that resolves it, so that it does not hear its neighbours' decays.
const WINDOWS: [usize; 2] = [1024, 4096];
/// Bins that a band has to be wide to count as resolved.
const RESOLVED_BINS: f64 = 16.0;
/// A Hann window reaches so far into the neighbouring bands: such a margin is left out where a band has more than twice as much.
const MARGIN_BINS: f64 = 1.5;
/// Power over the band's floor that counts, as a ratio.
const OVER_FLOOR: f64 = 4.0;
/// Further down than this, 35 dB, a band may hear its slower neighbours through the window's skirts.
const LEAST_OF_LOUDEST: f64 = 3e-4;
/// What is left has to be so large a share of the recording's power in a frame and band.
const LEAST_SHARE: f64 = 0.05;

/// Edges of `count` bands, evenly spaced on the ERB-rate scale (Glasberg and Moore) from 50 Hz to 0.98 of Nyquist.
fn edges_hz(count: usize, rate_hz: f64) -> Vec<f64> {
    let rate = |f: f64| (1.0 + 0.004_37 * f).ln();
    let (low, high) = (rate(LOWEST_HZ), rate(0.49 * rate_hz));
    (0..=count).map(|edge| ((low + (high - low) * edge as f64 / count as f64).exp() - 1.0) / 0.004_37).collect()
}

/// Fits `count` bands (1 to 1000) to what `recording` has and `model` has not; both begin at the strike and are equally long.
pub fn fit_bands(recording: &[f64], model: &[f64], rate_hz: f64, count: usize) -> Vec<Band> {
    let levels = WINDOWS.map(|window| Levels::new(recording, model, window));
    let edges = edges_hz(count.clamp(1, 1000), rate_hz);
    let bands = edges.windows(2).map(|edge| {
        let resolves = |levels: &&Levels| (edge[1] - edge[0]) * levels.window as f64 / rate_hz >= RESOLVED_BINS;
        let levels = levels.iter().find(resolves).unwrap_or(&levels[levels.len() - 1]);
        let (weight, decay_db_per_s) = levels.decay([edge[0] / rate_hz, edge[1] / rate_hz], rate_hz);
        Band { edges_hz: [edge[0], edge[1]], weight, decay_db_per_s }
    });
    bands.collect()
}

/// Short-time spectra of a recording and its model.
struct Levels {
    window: usize,
    hop: usize,
    bins: usize,
    whole: Vec<f64>,
    modelled: Vec<f64>,
}

impl Levels {
    fn new(recording: &[f64], model: &[f64], window: usize) -> Self {
        let spectrogram = Spectrogram::new(window);
        let (hop, bins) = (spectrogram.hop(), spectrogram.bin_count());
        Self { window, hop, bins, whole: spectrogram.power(recording), modelled: spectrogram.power(model) }
    }

    /// Weight and decay (dB/s) of a band, whose edges are given in cycles a sample.
    fn decay(&self, edges: [f64; 2], rate_hz: f64) -> (f64, f64) {
        let window = self.window as f64;
        let [from, to] = edges.map(|edge| edge * window);
        let margin = if to - from > 2.0 * MARGIN_BINS + 1.0 { MARGIN_BINS } else { 0.0 };
        // |X|² of a Hann window to the mean square of both sides of the spectrum, and what the margins hold.
        let scale = 2.0 / (0.375 * window * window) * (to - from) / (to - from - 2.0 * margin);
        let power = |spectra: &[f64]| -> Vec<f64> {
            let frames = spectra.chunks_exact(self.bins);
            frames.map(|frame| band_power(frame, from + margin, to - margin) * scale).collect()
        };
        let (whole, modelled) = (power(&self.whole), power(&self.modelled));
        let mut sorted = whole.clone();
        sorted.sort_by(f64::total_cmp);
        let floor = sorted.get(sorted.len() / 20).copied().unwrap_or(0.0).max(1e-12);
        decay_of(&whole, &modelled, floor, self.hop as f64 / rate_hz)
    }
}

/// Power between two places of a spectrum, given in bins with fractions.
fn band_power(frame: &[f64], from: f64, to: f64) -> f64 {
    let share = |bin: usize| (to.min(bin as f64 + 0.5) - from.max(bin as f64 - 0.5)).clamp(0.0, 1.0);
    let first = (from - 0.5).floor().max(0.0) as usize;
    let last = ((to + 0.5).ceil() as usize).min(frame.len().saturating_sub(1));
    (first..=last).map(|bin| frame[bin] * share(bin)).sum()
}

/// Rms at the strike and decay in dB/s of what a band has beyond the model.
fn decay_of(whole: &[f64], modelled: &[f64], floor: f64, frame_s: f64) -> (f64, f64) {
    let left: Vec<f64> = whole.iter().zip(modelled).map(|(whole, modelled)| (whole - modelled).max(0.0)).collect();
    // From the loudest frame until the band has died away for good.
    let start = (0..left.len()).max_by(|&a, &b| left[a].total_cmp(&left[b])).unwrap_or(0);
    let least = left.get(start).map_or(0.0, |loudest| (loudest * LEAST_OF_LOUDEST).max(OVER_FLOOR * floor));
    let counts = |frame: usize| left[frame] > least && left[frame] > LEAST_SHARE * whole[frame];
    let end = (start..left.len()).rfind(|&frame| whole[frame] > OVER_FLOOR * floor).map_or(start, |last| last + 1);
    let used: Vec<(f64, f64)> = (start..end)
        .filter(|&frame| counts(frame))
        // A frame stands for its middle.
        .map(|frame| ((frame as f64 + 2.0) * frame_s, left[frame]))
        .collect();
    if used.len() < 2 {
        return (0.0, 0.0);
    }
    let level = |power: f64| 10.0 * power.log10();
    let count = used.len() as f64;
    let mean_t = used.iter().map(|(t, _)| t).sum::<f64>() / count;
    let mean_level = used.iter().map(|(_, power)| level(*power)).sum::<f64>() / count;
    let spread: f64 = used.iter().map(|(t, _)| (t - mean_t).powi(2)).sum();
    let slope = used.iter().map(|(t, power)| (t - mean_t) * (level(*power) - mean_level)).sum::<f64>() / spread;
    let decay_db_per_s = (-slope).clamp(0.0, 2e4);
    // The level from the energy: the mean of a logarithm of noise lies below the logarithm of its mean.
    let shape: f64 = used.iter().map(|(t, _)| 10f64.powf(-decay_db_per_s * t / 10.0)).sum();
    let energy: f64 = used.iter().map(|(_, power)| power).sum();
    ((energy / shape).sqrt(), decay_db_per_s)
}

/// Renders bands, from the strike on; the noise is the same for the same seed.
pub fn render(bands: &[Band], length: usize, rate_hz: f64, seed: u64) -> Vec<f64> {
    let size = (length + 1).next_power_of_two().max(64);
    let mut random = SplitMix64(seed);
    let (forward, inverse) = (fourier::forward(size), fourier::inverse(size));
    let mut noise: Vec<f64> = (0..size).map(|_| random.normal()).collect();
    let mut spectrum = forward.make_output_vec();
    let mut sound = vec![0.0; length];
    if forward.process(&mut noise, &mut spectrum).is_err() {
        return sound;
    }
    let bin_hz = rate_hz / size as f64;
    for band in bands.iter().filter(|band| band.weight > 0.0) {
        let inside = |bin: usize| (band.edges_hz[0]..band.edges_hz[1]).contains(&(bin as f64 * bin_hz));
        let mut part: Vec<Complex<f64>> = spectrum
            .iter()
            .enumerate()
            .map(|(bin, value)| if inside(bin) { *value } else { Complex::new(0.0, 0.0) })
            .collect();
        let mut wave = inverse.make_output_vec();
        if inverse.process(&mut part, &mut wave).is_err() {
            continue;
        }
        let rms = (wave.iter().map(|x| x * x).sum::<f64>() / size as f64).sqrt();
        if rms <= 0.0 {
            continue;
        }
        let fade = 10f64.powf(-band.decay_db_per_s / (20.0 * rate_hz));
        let mut gain = band.weight / rms;
        for (sound, wave) in sound.iter_mut().zip(&wave) {
            *sound += gain * wave;
            gain *= fade;
        }
    }
    sound
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bands_of_decaying_noise_are_found_again() {
        let truth: Vec<Band> = edges_hz(12, 44_100.0)
            .windows(2)
            .enumerate()
            .map(|(index, edge)| Band {
                edges_hz: [edge[0], edge[1]],
                weight: 0.1 / (1.0 + index as f64),
                decay_db_per_s: 60.0 + 20.0 * index as f64,
            })
            .collect();
        // Noise scatters: a band of some hundred Hz that dies away within half a second holds about a hundred independent values. So
        // single estimates are held to three of their standard deviations, and the mean over the draws to their absence of bias.
        const DRAWS: u64 = 12;
        let mut mean = vec![(0.0, 0.0); truth.len()];
        for seed in 0..DRAWS {
            let mut sound = render(&truth, 66_150, 44_100.0, seed);
            let mut random = SplitMix64(100 + seed);
            sound.iter_mut().for_each(|x| *x += 1e-6 * random.normal());
            let found = fit_bands(&sound, &vec![0.0; sound.len()], 44_100.0, 12);
            for ((truth, found), mean) in truth.iter().zip(&found).zip(&mut mean) {
                let level_db = 20.0 * (found.weight / truth.weight).log10();
                let decay = found.decay_db_per_s / truth.decay_db_per_s;
                assert!(level_db.abs() < 4.0 && (decay - 1.0).abs() < 0.35, "{truth:?} {found:?}");
                mean.0 += level_db / DRAWS as f64;
                mean.1 += decay / DRAWS as f64;
            }
        }
        for ((level_db, decay), truth) in mean.iter().zip(&truth) {
            println!("{:?} Hz: level {level_db:+.2} dB, decay {decay:.3}", truth.edges_hz);
            assert!(level_db.abs() < 1.0 && (decay - 1.0).abs() < 0.06, "{truth:?}: {level_db:+.2} dB, {decay:.3}");
        }
    }
}
