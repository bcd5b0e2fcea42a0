//! Background noise: white noise through bands with constant gains (§3.4).

use fourier::Complex;

use super::bands::{edges, samples};
use super::scale::ExpSigmoid;
use crate::convolution::even;

/// Scaling of the bands' gains. The paper prints none for them; this is the released notebook's.
const GAIN: ExpSigmoid = ExpSigmoid { upper: 2.0, lower: 1e-7, bias: -3.5 };

/// Samples of noise through bands, for a spectrum of white noise.
pub(super) fn noise(gains: &[f64], white: &[Complex<f64>], length: usize) -> Vec<f64> {
    let mut spectrum = white.to_vec();
    for (gain, band) in gains.iter().zip(edges(white.len(), gains.len())) {
        let gain = GAIN.at(*gain).0;
        spectrum[band].iter_mut().for_each(|bin| *bin *= gain);
    }
    let mut noise = samples(spectrum);
    noise.truncate(length);
    noise
}

/// Gradient by the normalised gains, from that by the samples of the noise.
pub(super) fn gradient(gains: &[f64], white: &[Complex<f64>], by_noise: &[f64]) -> Vec<f64> {
    let length = even(2 * white.len().saturating_sub(1));
    let transform = fourier::forward(length);
    let (mut input, mut output) = (transform.make_input_vec(), transform.make_output_vec());
    input.iter_mut().zip(by_noise).for_each(|(slot, x)| *slot = *x);
    let _transformed = transform.process(&mut input, &mut output);
    let last = white.len() - 1;
    let of_band = |(gain, band): (&f64, std::ops::Range<usize>)| {
        // Parseval: each bin but the first and the last stands for two.
        let share = |bin: usize| if bin == 0 || bin == last { 1.0 } else { 2.0 };
        let sum: f64 = band.map(|bin| share(bin) * (output[bin].conj() * white[bin]).re).sum();
        GAIN.at(*gain).1 * sum / length as f64
    };
    gains.iter().zip(edges(white.len(), gains.len())).map(of_band).collect()
}
