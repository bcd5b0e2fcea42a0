//! Signals along a surface as sums of waves.

use std::f64::consts::TAU;

use fourier::Complex;

/// Spectrum of a real signal of even length.
pub(super) fn spectrum(signal: &[f64]) -> Vec<Complex<f64>> {
    let transform = fourier::forward(signal.len());
    let mut bins = transform.make_output_vec();
    let is_done = transform.process(&mut signal.to_vec(), &mut bins).is_ok();
    debug_assert!(is_done, "plan and buffers have one length");
    bins
}

/// Signal of an even length with a spectrum; the first and the last bin count by their real parts.
pub(super) fn signal(mut bins: Vec<Complex<f64>>, length: usize) -> Vec<f64> {
    for edge in [0, length / 2] {
        bins[edge].im = 0.0;
    }
    let transform = fourier::inverse(length);
    let mut signal = transform.make_output_vec();
    let is_done = transform.process(&mut bins, &mut signal).is_ok();
    debug_assert!(is_done, "plan and buffers have one length");
    signal.iter_mut().for_each(|x| *x /= length as f64);
    signal
}

/// Frequency of a bin in cycles per metre.
pub(super) fn frequency_per_m(bin: usize, length: usize, step_m: f64) -> f64 {
    bin as f64 / (length as f64 * step_m)
}

/// Factor `-k²` of a wave from heights to curvatures, in 1/m².
pub(super) fn curvature_of_height(frequency_per_m: f64) -> f64 {
    -(TAU * frequency_per_m).powi(2)
}

/// Curvatures of a periodic profile.
pub(super) fn curvatures(heights: &[f64], step_m: f64) -> Vec<f64> {
    let mut bins = spectrum(heights);
    for (bin, value) in bins.iter_mut().enumerate() {
        *value *= curvature_of_height(frequency_per_m(bin, heights.len(), step_m));
    }
    signal(bins, heights.len())
}

/// Part of a periodic signal whose waves lie in a band of frequencies, in cycles per metre: above
/// the first, up to the second.
pub(super) fn within(bins: &[Complex<f64>], length: usize, step_m: f64, band_per_m: [f64; 2]) -> Vec<f64> {
    let of_bin = |(bin, value): (usize, &Complex<f64>)| {
        let frequency = frequency_per_m(bin, length, step_m);
        if frequency > band_per_m[0] && frequency <= band_per_m[1] { *value } else { Complex::new(0.0, 0.0) }
    };
    signal(bins.iter().enumerate().map(of_bin).collect(), length)
}

/// Kurtosis over that of a normal distribution.
pub(super) fn excess_kurtosis(values: &[f64]) -> f64 {
    let count = values.len().max(1) as f64;
    let mean = values.iter().sum::<f64>() / count;
    let moment = |power: i32| values.iter().map(|x| (x - mean).powi(power)).sum::<f64>() / count;
    moment(4) / moment(2).powi(2).max(f64::MIN_POSITIVE) - 3.0
}
