//! Log-spectral distance and its derivative by every sample of the rendering.

use std::sync::Arc;

use fourier::{Complex, ComplexToReal};

use super::lsd::{FLOOR, SIZES, of_unit_rms};
use super::spectrogram::Spectrogram;

/// A recording with its spectra, with which renderings are compared.
pub(crate) struct Target {
    scales: Vec<Scale>,
    /// Rms of the recording.
    rms: f64,
}

struct Scale {
    spectrogram: Spectrogram,
    inverse: Arc<dyn ComplexToReal<f64>>,
    wanted: Vec<f64>,
    floor: f64,
}

impl Target {
    pub(crate) fn new(recording: &[f64]) -> Self {
        let rms = rms(recording);
        let recording = of_unit_rms(recording);
        let scales = SIZES.map(|size| {
            let spectrogram = Spectrogram::new(size);
            let wanted = spectrogram.power(&recording);
            let floor = wanted.iter().copied().fold(f64::MIN_POSITIVE, f64::max) * FLOOR;
            Scale { spectrogram, inverse: fourier::inverse(size), wanted, floor }
        });
        Self { scales: scales.into(), rms }
    }

    /// A part of the recording, with the floor of the whole.
    pub(crate) fn part(&self, samples: &[f64]) -> Self {
        let samples: Vec<f64> = samples.iter().map(|x| x / self.rms).collect();
        let scale = |scale: &Scale| Scale {
            spectrogram: scale.spectrogram.clone(),
            inverse: scale.inverse.clone(),
            wanted: scale.spectrogram.power(&samples),
            floor: scale.floor,
        };
        Self { scales: self.scales.iter().map(scale).collect(), rms: self.rms }
    }

    /// Distance in dB with a soft floor (`P + floor` in place of `max(P, floor)`), and its
    /// derivative by each sample.
    ///
    /// The rendering is scaled to unit rms.
    pub(crate) fn distance_and_slope(&self, rendering: &[f64]) -> (f64, Vec<f64>) {
        let length = rendering.len();
        let rms = rms(rendering);
        let scaled: Vec<f64> = rendering.iter().map(|x| x / rms).collect();
        let (distance, mut slope) = self.of_scaled(&scaled);
        // The division by the rms removes the part of the slope that only changes the level.
        let along = slope.iter().zip(&scaled).map(|(slope, x)| slope * x).sum::<f64>() / length.max(1) as f64;
        for (slope, x) in slope.iter_mut().zip(&scaled) {
            *slope = (*slope - along * x) / rms;
        }
        (distance, slope)
    }

    /// Distance in dB with a soft floor, and its derivative by each sample, without scaling of the
    /// rendering.
    ///
    /// The level of the rendering counts.
    pub(crate) fn distance_and_slope_at_level(&self, rendering: &[f64]) -> (f64, Vec<f64>) {
        let scaled: Vec<f64> = rendering.iter().map(|x| x / self.rms).collect();
        let (distance, mut slope) = self.of_scaled(&scaled);
        slope.iter_mut().for_each(|slope| *slope /= self.rms);
        (distance, slope)
    }

    fn of_scaled(&self, scaled: &[f64]) -> (f64, Vec<f64>) {
        let mut slope = vec![0.0; scaled.len()];
        let scales = self.scales.len() as f64;
        let distance = self.scales.iter().map(|scale| scale.add(scaled, scales, &mut slope)).sum();
        (distance, slope)
    }
}

fn rms(samples: &[f64]) -> f64 {
    (samples.iter().map(|x| x * x).sum::<f64>() / samples.len().max(1) as f64).sqrt().max(1e-12)
}

impl Scale {
    /// Adds this scale's share of the slope, and returns its share of the distance.
    fn add(&self, rendering: &[f64], scales: f64, slope: &mut [f64]) -> f64 {
        let bins = self.spectrogram.bin_count();
        let spectra = self.spectrogram.complex(rendering);
        let share = 1.0 / (scales * (spectra.len() / bins).max(1) as f64);
        let mut distance = 0.0;
        let mut adjoint = self.inverse.make_input_vec();
        let mut wave = self.inverse.make_output_vec();
        for (frame, (spectrum, wanted)) in spectra.chunks_exact(bins).zip(self.wanted.chunks_exact(bins)).enumerate() {
            let difference = |given: &Complex<f64>, wanted: &f64| {
                10.0 * ((given.norm_sqr() + self.floor) / (wanted + self.floor)).log10()
            };
            let squares: f64 =
                spectrum.iter().zip(wanted).map(|(given, wanted)| difference(given, wanted).powi(2)).sum();
            let rms = (squares / bins as f64).sqrt();
            distance += rms * share;
            let factor = share / (rms.max(1e-6) * bins as f64) * 20.0 / 10f64.ln();
            for (bin, ((adjoint, given), wanted)) in adjoint.iter_mut().zip(spectrum).zip(wanted).enumerate() {
                *adjoint = given * (factor * difference(given, wanted) / (given.norm_sqr() + self.floor));
                // The inverse transform adds the other half of the spectrum.
                if bin == 0 || bin + 1 == bins { adjoint.im = 0.0 } else { *adjoint *= 0.5 }
            }
            if self.inverse.process(&mut adjoint, &mut wave).is_err() {
                continue;
            }
            let from = frame * self.spectrogram.hop();
            for ((slope, wave), window) in slope.iter_mut().skip(from).zip(&wave).zip(self.spectrogram.window()) {
                *slope += wave * window;
            }
        }
        distance
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn slope_of_the_distance_equals_its_numeric_derivative() {
        let tone =
            |f: f64, d: f64| (0..4000u32).map(f64::from).map(|n| (-d * n).exp() * (f * n).sin()).collect::<Vec<f64>>();
        let (wanted, given) = (tone(0.3, 1e-3), tone(0.31, 2e-3));
        let target = Target::new(&wanted);
        let (distance, slope) = target.distance_and_slope(&given);
        let part = target.part(&wanted[1000..3048]);
        let (part_distance, part_slope) = part.distance_and_slope_at_level(&given[1000..3048]);
        for at in [10, 700, 2500] {
            let mut moved = given.clone();
            moved[at] += 1e-6;
            let numeric = (target.distance_and_slope(&moved).0 - distance) / 1e-6;
            assert!((numeric - slope[at]).abs() < 1e-3 * numeric.abs() + 1e-5, "{at}: {numeric} {}", slope[at]);
            let Some(slope) = at.checked_sub(1000).and_then(|at| part_slope.get(at)) else { continue };
            let numeric = (part.distance_and_slope_at_level(&moved[1000..3048]).0 - part_distance) / 1e-6;
            assert!((numeric - slope).abs() < 1e-3 * numeric.abs() + 1e-5, "{at}: {numeric} {slope}");
        }
    }
}
