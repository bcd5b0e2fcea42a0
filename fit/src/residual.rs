//! What the modes leave: noise in bands that die away each at its own rate (physics-diffusion eq. 5, 6).
//!
//! `R(t) = Σ_m w_m 10^{-γ_m t/20} B_m(t)`, with B_m Gaussian noise of unit rms in band m. In place of the paper's trained encoder the weights
//! and decays are fitted, band by band, to the power that the recording has beyond the model's.

use realfft::RealFftPlanner;
use realfft::num_complex::Complex;
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
/// Window of the level in samples.
const WINDOW: usize = 1024;
/// Power over the band's floor that counts, as a ratio.
const OVER_FLOOR: f64 = 4.0;
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
    let spectrogram = Spectrogram::new(WINDOW);
    let (whole, modelled) = (spectrogram.power(recording), spectrogram.power(model));
    let bins = spectrogram.bin_count();
    let bin_hz = rate_hz / WINDOW as f64;
    // |X|² of a Hann window to the mean square of one side of the spectrum.
    let scale = 2.0 / (WINDOW as f64 * 0.375 * WINDOW as f64);
    let frame_s = spectrogram.hop() as f64 / rate_hz;
    let edges = edges_hz(count.clamp(1, 1000), rate_hz);
    let bands = edges.windows(2).map(|edge| {
        let power = |spectra: &[f64]| -> Vec<f64> {
            spectra
                .chunks_exact(bins)
                .map(|frame| band_power(frame, edge[0] / bin_hz, edge[1] / bin_hz) * scale)
                .collect()
        };
        let (whole, modelled) = (power(&whole), power(&modelled));
        let mut sorted = whole.clone();
        sorted.sort_by(f64::total_cmp);
        let floor = sorted.get(sorted.len() / 20).copied().unwrap_or(0.0).max(1e-12);
        let (weight, decay_db_per_s) = decay_of(&whole, &modelled, floor, frame_s);
        Band { edges_hz: [edge[0], edge[1]], weight, decay_db_per_s }
    });
    bands.collect()
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
    let counts = |frame: usize| left[frame] > OVER_FLOOR * floor && left[frame] > LEAST_SHARE * whole[frame];
    // From the loudest frame until the band has died away for good.
    let start = (0..left.len()).max_by(|&a, &b| left[a].total_cmp(&left[b])).unwrap_or(0);
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
    // No louder at the strike than a decay through the loudest frame allows.
    ((energy / shape).sqrt(), decay_db_per_s)
}

/// Renders bands, from the strike on; the noise is the same for the same seed.
pub fn render(bands: &[Band], length: usize, rate_hz: f64, seed: u64) -> Vec<f64> {
    let size = (length + 1).next_power_of_two().max(64);
    let mut random = SplitMix64(seed);
    let mut planner = RealFftPlanner::<f64>::new();
    let (forward, inverse) = (planner.plan_fft_forward(size), planner.plan_fft_inverse(size));
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
        let mut sound = render(&truth, 66_150, 44_100.0, 3);
        let mut random = SplitMix64(9);
        sound.iter_mut().for_each(|x| *x += 1e-6 * random.normal());
        let found = fit_bands(&sound, &vec![0.0; sound.len()], 44_100.0, 12);
        for (truth, found) in truth.iter().zip(&found).skip(2) {
            let level_db = 20.0 * (found.weight / truth.weight).log10();
            let decay = found.decay_db_per_s / truth.decay_db_per_s;
            assert!(level_db.abs() < 2.0 && (decay - 1.0).abs() < 0.1, "{truth:?} {found:?}");
        }
    }
}
