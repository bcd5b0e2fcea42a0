//! Power envelopes in gammatone bands.

use fourier::Complex;

use crate::analytic;

/// Number of bands.
const BANDS: usize = 60;
/// Lowest and highest centre in Hz, as far as the rate allows.
const RANGE_HZ: [f64; 2] = [60.0, 16_000.0];
/// Time between two values of an envelope, in seconds.
pub(crate) const HOP_S: f64 = 0.002;
/// Reach of a band's response on either side, in units of its bandwidth: 86 dB down.
const REACH: f64 = 12.0;

/// Equivalent rectangular bandwidth of hearing at a frequency, in Hz (Glasberg and Moore).
fn erb_hz(hz: f64) -> f64 {
    24.7 * (0.004_37 * hz + 1.0)
}

/// Returns the centres of the 60 bands in Hz. They are equally spaced on the ERB scale, from 60 Hz
/// to 16 kHz, or to 0.45 of the sample rate if that is lower.
pub fn centres_hz(rate_hz: f64) -> Vec<f64> {
    let rate_of = |hz: f64| (1.0 + 0.004_37 * hz).ln();
    let [low, high] = [rate_of(RANGE_HZ[0]), rate_of(RANGE_HZ[1].min(0.45 * rate_hz))];
    let centre = |band: usize| ((low + (high - low) * band as f64 / (BANDS - 1) as f64).exp() - 1.0) / 0.004_37;
    (0..BANDS).map(centre).collect()
}

/// Threshold of hearing in quiet at a frequency, in dB SPL (Terhardt).
pub fn threshold_db(hz: f64) -> f64 {
    let khz = hz / 1000.0;
    3.64 * khz.powf(-0.8) - 6.5 * (-0.6 * (khz - 3.3).powi(2)).exp() + 1e-3 * khz.powi(4)
}

/// Power of a sine in a band, relative to one at the band's centre.
pub(super) fn response(hz: f64, centre_hz: f64) -> f64 {
    let detune = (hz - centre_hz) / (1.019 * erb_hz(centre_hz));
    (1.0 + detune * detune).powi(-4)
}

/// Returns the power of each gammatone band of fourth order, a value for each 2 ms.
///
/// A value is twice the mean square over the whole number of samples in 2 ms.
pub(super) fn power(samples: &[f64], rate_hz: f64, centres_hz: &[f64]) -> Vec<Vec<f64>> {
    let hop = HOP_S * rate_hz;
    let step = hop as usize;
    let frames = samples.len().checked_div(step).unwrap_or(0);
    let size = (samples.len() + (0.05 * rate_hz) as usize).max(2).next_power_of_two();
    let transform = fourier::forward(size);
    let mut padded = samples.to_vec();
    padded.resize(size, 0.0);
    let mut spectrum = transform.make_output_vec();
    if transform.process(&mut padded, &mut spectrum).is_err() {
        return vec![vec![0.0; frames]; centres_hz.len()];
    }
    let bin_hz = rate_hz / size as f64;
    let band = |&centre: &f64| {
        let width = 1.019 * erb_hz(centre);
        let first = ((centre - REACH * width) / bin_hz).max(0.0) as usize;
        let last = (((centre + REACH * width) / bin_hz) as usize).min(size / 2);
        let bins: Vec<Complex<f64>> = (first..last)
            .map(|bin| {
                let detune = Complex::new(1.0, (bin as f64 * bin_hz - centre) / width);
                spectrum[bin] * 2.0 / (detune * detune * detune * detune)
            })
            .collect();
        let least = bins.len().max((4.0 * size as f64 / hop).ceil() as usize).max(64);
        means(&envelope(&bins, least.next_power_of_two(), size), size, step, frames)
    };
    centres_hz.iter().map(band).collect()
}

/// Squared magnitude of the analytic signal with the given bins, at `count` times within `size`
/// samples.
fn envelope(bins: &[Complex<f64>], count: usize, size: usize) -> Vec<f64> {
    let scale = (size as f64).powi(-2);
    analytic::samples(bins, count).into_iter().map(|sample| sample.norm_sqr() * scale).collect()
}

/// Means of an envelope over steps of samples.
fn means(envelope: &[f64], size: usize, step: usize, frames: usize) -> Vec<f64> {
    let stride = size as f64 / envelope.len() as f64;
    let mut sums = Vec::with_capacity(envelope.len() + 1);
    let mut sum = 0.0;
    sums.push(sum);
    for power in envelope {
        sum += power * stride;
        sums.push(sum);
    }
    let at = |sample: usize| {
        let place = sample as f64 / stride;
        let low = (place as usize).min(envelope.len().saturating_sub(1));
        let [from, to] = [sums.get(low), sums.get(low + 1)].map(|sum| sum.copied().unwrap_or(0.0));
        from + (to - from) * (place - low as f64).min(1.0)
    };
    (0..frames).map(|frame| (at((frame + 1) * step) - at(frame * step)) / step as f64).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_band_holds_a_sine_at_its_centre_with_its_squared_amplitude() {
        let rate_hz = 44_100.0;
        let centres = centres_hz(rate_hz);
        let hz = centres[30];
        let sine: Vec<f64> =
            (0..44_100).map(|n| 0.2 * (std::f64::consts::TAU * hz * f64::from(n) / rate_hz).sin()).collect();
        let bands = power(&sine, rate_hz, &centres);
        let steady = bands[30][250];
        assert!((steady / 0.04 - 1.0).abs() < 1e-3, "{steady}");
        assert!(bands[20][250] < 1e-3 * steady && bands[40][250] < 1e-3 * steady);
    }
}
