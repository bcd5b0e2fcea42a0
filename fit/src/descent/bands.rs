//! White noise in bands of equal width up to half the sample rate (`filt` of §3.4).

use std::ops::Range;

use fourier::Complex;

use crate::convolution::even;
use crate::random::SplitMix64;

/// Bins of each band in a spectrum of `bins` bins.
pub(super) fn edges(bins: usize, bands: usize) -> impl Iterator<Item = Range<usize>> + Clone {
    let edge = move |band: usize| bins * band / bands.max(1);
    (0..bands).map(move |band| edge(band)..edge(band + 1))
}

/// Spectrum of white noise with an rms of 1 in `length` samples.
pub(super) fn white(length: usize, random: &mut SplitMix64) -> Vec<Complex<f64>> {
    let size = (0.5 * length as f64).sqrt();
    let mut spectrum: Vec<Complex<f64>> =
        (0..length / 2 + 1).map(|_| Complex::new(size * random.normal(), size * random.normal())).collect();
    // The first bin of a real signal is real, and of an even length the last.
    let last = spectrum.len() - 1;
    for bin in [0, last] {
        spectrum[bin] = Complex::new(2f64.sqrt() * spectrum[bin].re, 0.0);
    }
    spectrum
}

/// Samples of a spectrum of an even length.
pub(super) fn samples(mut spectrum: Vec<Complex<f64>>) -> Vec<f64> {
    let length = even(2 * spectrum.len().saturating_sub(1));
    let inverse = fourier::inverse(length);
    let mut samples = inverse.make_output_vec();
    let _unscaled = inverse.process(&mut spectrum, &mut samples);
    samples.iter_mut().for_each(|x| *x /= length as f64);
    samples
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bands_of_white_noise_add_up_to_noise_of_rms_one() {
        let spectrum = white(8_000, &mut SplitMix64(5));
        let whole = samples(spectrum.clone());
        let power = |sound: &[f64]| sound.iter().map(|x| x * x).sum::<f64>() / sound.len() as f64;
        assert!((power(&whole) - 1.0).abs() < 0.05, "{}", power(&whole));
        let mut sum = vec![0.0; whole.len()];
        for band in edges(spectrum.len(), 7) {
            let mut part = vec![Complex::new(0.0, 0.0); spectrum.len()];
            part[band.clone()].copy_from_slice(&spectrum[band]);
            let part = samples(part);
            assert!((power(&part) - 1.0 / 7.0).abs() < 0.03, "{}", power(&part));
            sum.iter_mut().zip(part).for_each(|(sum, x)| *sum += x);
        }
        assert!(sum.iter().zip(&whole).all(|(a, b)| (a - b).abs() < 1e-9));
    }
}
