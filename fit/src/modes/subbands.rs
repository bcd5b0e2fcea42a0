//! More modes than a table can hold, from bands as wide as 1.5 of the ear's.
//!
//! A loud mode hides no quiet one in another band, and each band has poles of its own, as many as
//! stand out of its noise. Which of them a table gets is decided by what is heard.

use nalgebra::{Cholesky, Complex, DMatrix, DVector};

use super::damped_sine::DampedSine;
use super::esprit::poles;
use super::estimate::Settings;
use crate::analytic;

type C64 = Complex<f64>;

/// Width of a band in units of the ear's.
const WIDTH_ERB: f64 = 1.5;
/// Width of the slope on either side, relative to the band's half width.
const SLOPE: f64 = 1.0;
/// Maximum number of modes of a band.
const MOST_IN_BAND: usize = 14;
/// Maximum number of samples of a band that are analysed.
const MOST_SAMPLES: usize = 1_500;
/// Number of a band's samples that are left out, in which the onset is smeared.
const SMEARED: usize = 2;
/// Silence behind the sound, in seconds, into which the bands ring.
const PAUSE_S: f64 = 0.1;
/// Highest frequency of a mode, relative to the rate.
const HIGHEST: f64 = 0.47;

/// Damped sines that ring from the first sample on, band after band.
///
/// Amplitudes are those of each band alone.
pub(crate) fn candidates(samples: &[f64], rate_hz: f64, settings: Settings) -> Vec<DampedSine> {
    let size = (samples.len() + (PAUSE_S * rate_hz) as usize).next_power_of_two();
    let transform = fourier::forward(size);
    let mut padded = samples.to_vec();
    padded.resize(size, 0.0);
    let mut spectrum = transform.make_output_vec();
    if samples.is_empty() || transform.process(&mut padded, &mut spectrum).is_err() {
        return Vec::new();
    }
    let mut found = Vec::new();
    let mut low = settings.lowest_hz;
    while low < HIGHEST * rate_hz {
        let high = low + WIDTH_ERB * 24.7 * (0.004_37 * low + 1.0) * 1.08;
        let band = Band { low, high, bin_hz: rate_hz / size as f64 };
        let fastest = settings.fastest_decay_per_s.min(6.0 * (high - low));
        found.extend(band.modes(&spectrum, samples.len() as f64 / rate_hz, fastest));
        low = high;
    }
    found
}

struct Band {
    low: f64,
    high: f64,
    bin_hz: f64,
}

impl Band {
    fn modes(&self, spectrum: &[C64], length_s: f64, fastest: f64) -> Vec<DampedSine> {
        let half = 0.5 * (self.high - self.low);
        let (from_hz, to_hz) = (self.low - SLOPE * half, self.high + SLOPE * half);
        let first = ((from_hz / self.bin_hz).ceil().max(1.0)) as usize;
        let last = ((to_hz / self.bin_hz) as usize).min(spectrum.len() - 1);
        let gain = |hz: f64| {
            let outside = ((self.low - hz).max(hz - self.high) / (SLOPE * half)).clamp(0.0, 1.0);
            0.5 + 0.5 * (std::f64::consts::PI * outside).cos()
        };
        let bins: Vec<C64> = (first..=last).map(|bin| spectrum[bin] * gain(bin as f64 * self.bin_hz)).collect();
        let count = bins.len() + 1;
        let rate_hz = count as f64 * self.bin_hz;
        let all = analytic::samples(&bins, count);
        let end = ((length_s * rate_hz) as usize).min(SMEARED + MOST_SAMPLES).min(all.len());
        let scale = 1.0 / (spectrum.len() - 1) as f64;
        let samples: Vec<C64> = all.get(SMEARED..end).unwrap_or(&[]).iter().map(|sample| sample * scale).collect();
        let slowest = 0.5 / length_s;
        let keep = |pole: C64| {
            let log = pole.ln();
            // The samples stand one bin above the first.
            let turns = (log.im / std::f64::consts::TAU).rem_euclid(1.0);
            let hz = turns * rate_hz + (first as f64 - 1.0) * self.bin_hz;
            let decay = -log.re * rate_hz;
            let is_inside = (self.low..self.high).contains(&hz) && decay < fastest && decay > -2.0 / length_s;
            let decay = decay.max(slowest);
            is_inside.then(|| (hz, decay, C64::new(-decay / rate_hz, log.im)))
        };
        let kept: Vec<(f64, f64, C64)> = poles(&samples, MOST_IN_BAND).into_iter().filter_map(keep).collect();
        let logs: Vec<C64> = kept.iter().map(|mode| mode.2).collect();
        let gains = gains(&samples, &logs);
        kept.iter()
            .zip(gains)
            .map(|(&(frequency_hz, decay_per_s, log), gain)| {
                let gain = gain * (log * -(SMEARED as f64)).exp();
                DampedSine { frequency_hz, decay_per_s, amplitude: gain.norm(), phase: gain.arg() }
            })
            .collect()
    }
}

/// Gains of exponentials with the given `ln z`, by least squares.
fn gains(samples: &[C64], logs: &[C64]) -> Vec<C64> {
    let count = logs.len();
    let mut normal = DMatrix::<C64>::zeros(count, count);
    let mut right = DVector::<C64>::zeros(count);
    let steps: Vec<C64> = logs.iter().map(|log| log.exp()).collect();
    let mut powers = vec![C64::new(1.0, 0.0); count];
    for sample in samples {
        for row in 0..count {
            let conjugate = powers[row].conj();
            right[row] += conjugate * sample;
            for column in 0..=row {
                normal[(row, column)] += conjugate * powers[column];
            }
        }
        powers.iter_mut().zip(&steps).for_each(|(power, step)| *power *= step);
    }
    for row in 0..count {
        for column in row + 1..count {
            normal[(row, column)] = normal[(column, row)].conj();
        }
        normal[(row, row)] *= C64::new(1.0 + 1e-9, 0.0);
    }
    let zero = || vec![C64::new(0.0, 0.0); count];
    Cholesky::new(normal).map_or_else(zero, |factor| factor.solve(&right).iter().copied().collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::score::matches;
    use crate::synthetic::struck;

    #[test]
    fn nearly_all_of_twenty_modes_are_among_the_candidates() {
        let (mut found, mut off_db) = (0, Vec::new());
        for seed in 1..5 {
            let sound = struck(seed, -60.0);
            let all = candidates(&sound.samples, sound.rate_hz, Settings::default());
            let pairs = matches(&sound.modes, &all, 20.0);
            found += pairs.len();
            off_db.extend(pairs.iter().map(|pair| pair.amplitude_db()));
        }
        let median = crate::score::quantile(&off_db, 0.5);
        assert!(found >= 74 && median < 1.0, "{found} of 80, {median} dB");
    }
}
