//! The bins estimator: one mode for each bin of a spectrogram (physical priors of physics-diffusion
//! §3.1).
//!
//! It is simple and fast, and gives the modes of a physical prior. A decay read off when a bin
//! falls silent depends on the bin's noise, its neighbours and its window as much as on the mode.
//! docs/fit.md has its figures beside those of [`crate::modes`].

use std::f64::consts::{FRAC_PI_2, TAU};

use dsp_core::table::range::FREQUENCY_HZ;

use crate::modes::DampedSine;

/// Window of the spectrogram in samples (§4.1 of the paper).
pub const WINDOW: usize = 2048;
/// Number of bins of the spectrogram, and most modes of a sound.
pub const BINS: usize = WINDOW / 2 + 1;
/// Hop of the spectrogram in samples (§4.1 of the paper).
pub const HOP: usize = 256;
/// Level of silence in dB, relative to the loudest bin of the spectrogram.
const SILENCE_DB: f64 = -80.0;

/// One mode for each of the 1025 bins that is not silent at the strike, in order of frequency.
///
/// The frequency is that of the highest peak within the bin, in the spectrum of the whole sound.
/// The bins at 0 Hz and at half the rate reach half as far, and their peaks lie beside these two
/// frequencies, at which nothing rings.
/// The amplitude follows from the first frame's magnitude. The decay takes the bin to -80 dB (below
/// the loudest bin) when the bin first gets there, or at the end of a sound that does not. Phases
/// are those of sines that begin at zero: `amplitude e^{-dt} sin 2πft` (physics-diffusion eq. 3,
/// 4).
///
/// `strike` has full scale 1 and begins at its onset; `rate_hz` is its rate. Silence has no modes.
pub fn estimate(strike: &[f64], rate_hz: f64) -> Vec<DampedSine> {
    let frames = levels(strike);
    let loudest = frames.iter().flatten().copied().fold(0.0, f64::max);
    if loudest <= 0.0 {
        return Vec::new();
    }
    let level_db = |magnitude: f64| (20.0 * (magnitude / loudest).log10()).max(SILENCE_DB);
    let whole = magnitudes(strike, strike.len().next_power_of_two().max(WINDOW), |_| 1.0);
    let size = 2 * (whole.len() - 1);
    let fine = size / WINDOW;
    let Some(first) = frames.first() else { return Vec::new() };
    let lowest = ((f64::from(FREQUENCY_HZ.min) * size as f64 / rate_hz).ceil() as usize).max(1);
    (0..BINS)
        .filter_map(|bin| {
            let power = *first.get(bin)?;
            let power_db = level_db(power);
            if power_db <= SILENCE_DB {
                return None;
            }
            let silent = (1..frames.len())
                .find(|&frame| frames[frame].get(bin).is_none_or(|magnitude| level_db(*magnitude) <= SILENCE_DB))
                .unwrap_or(frames.len());
            let silent_s = (silent * HOP) as f64 / rate_hz;
            let decay_db_per_s = (power_db - SILENCE_DB) / silent_s;
            let from = (bin * fine).saturating_sub(fine / 2).max(lowest);
            let to = (bin * fine + fine.div_ceil(2)).min(size / 2);
            let peak = (from..to).max_by(|&a, &b| {
                let at = |place: usize| whole.get(place).copied().unwrap_or(0.0);
                at(a).total_cmp(&at(b))
            })?;
            // Both lines of a sine fall into the bin at 0 Hz, and into that at half the rate.
            let lines = if bin == 0 || bin == BINS - 1 { 2.0 } else { 1.0 };
            Some(DampedSine {
                frequency_hz: peak as f64 * rate_hz / size as f64,
                decay_per_s: decay_db_per_s * 10f64.ln() / 20.0,
                // A sine of amplitude 1 has the magnitude of half the window's sum, which is half
                // its length.
                amplitude: power * 4.0 / (lines * WINDOW as f64),
                phase: -FRAC_PI_2,
            })
        })
        .collect()
}

/// The `most` modes of largest energy, in order of frequency.
pub fn strongest(mut modes: Vec<DampedSine>, most: usize) -> Vec<DampedSine> {
    let energy = |mode: &DampedSine| mode.amplitude * mode.amplitude / mode.decay_per_s;
    modes.sort_by(|a, b| energy(b).total_cmp(&energy(a)));
    modes.truncate(most);
    modes.sort_by(|a, b| a.frequency_hz.total_cmp(&b.frequency_hz));
    modes
}

/// Magnitudes of Hann-windowed frames, at least one; the end is padded with zeros.
fn levels(strike: &[f64]) -> Vec<Vec<f64>> {
    let hann = |n: usize| 0.5 - 0.5 * (TAU * n as f64 / WINDOW as f64).cos();
    let count = 1 + strike.len().saturating_sub(WINDOW) / HOP;
    (0..count).map(|frame| magnitudes(strike.get(frame * HOP..).unwrap_or(&[]), WINDOW, hann)).collect()
}

/// Magnitudes of the spectrum of the first `size` samples.
fn magnitudes(samples: &[f64], size: usize, window: impl Fn(usize) -> f64) -> Vec<f64> {
    let transform = fourier::forward(size);
    let (mut input, mut output) = (transform.make_input_vec(), transform.make_output_vec());
    for (n, (slot, x)) in input.iter_mut().zip(samples).enumerate() {
        *slot = x * window(n);
    }
    match transform.process(&mut input, &mut output) {
        Ok(()) => output.iter().map(|bin| bin.norm()).collect(),
        Err(_) => Vec::new(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::synthetic::of_these;

    #[test]
    fn a_lone_mode_without_noise_has_its_frequency_and_roughly_its_decay() {
        for (frequency_hz, t60_s) in [(440.0, 1.0), (2500.0, 0.6)] {
            let mode =
                DampedSine { frequency_hz, decay_per_s: 1000f64.ln() / t60_s, amplitude: 0.5, phase: -FRAC_PI_2 };
            let sound = of_these(vec![mode], 88_200, 1, -140.0);
            let found = strongest(estimate(&sound.samples, sound.rate_hz), 1);
            assert!((found[0].frequency_hz / frequency_hz - 1.0).abs() < 2e-3, "{found:?}");
            assert!((found[0].t60_s() / t60_s - 1.0).abs() < 0.1, "{found:?}");
        }
    }

    #[test]
    fn each_bin_of_a_noisy_strike_is_one_mode_between_0_hz_and_half_the_rate() {
        let mode = DampedSine { frequency_hz: 440.0, decay_per_s: 7.0, amplitude: 0.5, phase: -FRAC_PI_2 };
        let sound = of_these(vec![mode], 44_100, 1, -20.0);
        let modes = estimate(&sound.samples, sound.rate_hz);
        assert_eq!(modes.len(), BINS);
        let half_bin_hz = 0.5 * sound.rate_hz / WINDOW as f64;
        for (bin, mode) in modes.iter().enumerate() {
            let off_hz = mode.frequency_hz - 2.0 * half_bin_hz * bin as f64;
            assert!(off_hz.abs() <= half_bin_hz, "bin {bin}: {mode:?}");
            assert!(mode.frequency_hz > 0.0 && mode.frequency_hz < 0.5 * sound.rate_hz, "bin {bin}: {mode:?}");
        }
    }

    #[test]
    fn silence_has_no_modes() {
        assert!(estimate(&[0.0; 5000], 44_100.0).is_empty());
        assert!(estimate(&[], 44_100.0).is_empty());
    }
}
