//! Bands of a sound as analytic signals, cut out of its spectrum.

use std::f64::consts::TAU;

use fourier::Complex;

use super::scale::{bark, width_hz};

/// Standard deviation of a Gaussian response in Bark.
///
/// Neighbours cross at -4.3 dB, and the sum of all responses is constant within 1.5 %.
pub(crate) const SPREAD_BARK: f64 = 0.5;
/// Number of standard deviations from its middle at which a response ends (-87 dB).
const REACH: f64 = 4.5;

/// Gaussian response at x of a band round `middle`: `exp(-(x - middle)²/2 spread²)`.
///
/// The scale of frequency is arbitrary.
pub(crate) fn gaussian(x: f64, middle: f64, spread: f64) -> f64 {
    (-0.5 * ((x - middle) / spread).powi(2)).exp()
}

/// A Gaussian band of a sound: the power of its analytic signal over time.
#[derive(Clone, Debug)]
pub(crate) struct Subband {
    /// Squared envelope from the sound's first sample on: A² for a sine of amplitude A in the
    /// middle of the band.
    pub(crate) power: Vec<f64>,
    /// Rate of `power` in Hz.
    pub(crate) rate_hz: f64,
    /// Standard deviation of the band's response in time, in seconds: ends of the sound are smeared
    /// by it.
    pub(crate) smear_s: f64,
}

impl Subband {
    /// Number of independent values that a second of noise has in the band.
    ///
    /// It is `√(2π)` standard deviations of the band's response in Hz.
    pub(crate) fn independent_per_s(&self) -> f64 {
        TAU.sqrt() / (TAU * self.smear_s)
    }
}

/// Spectrum of a sound, from which bands are cut.
pub(crate) struct Spectrum {
    bins: Vec<Complex<f64>>,
    bin_hz: f64,
    size: usize,
    length_s: f64,
}

impl Spectrum {
    /// Spectrum of a sound; `None` without samples.
    ///
    /// At least 50 ms of silence follow the sound, so that its end does not run into its beginning.
    pub(crate) fn of(samples: &[f64], rate_hz: f64) -> Option<Self> {
        if samples.is_empty() {
            return None;
        }
        let size = (samples.len() + (0.05 * rate_hz) as usize).next_power_of_two().max(1024);
        let transform = fourier::forward(size);
        let mut input = transform.make_input_vec();
        for (slot, x) in input.iter_mut().zip(samples) {
            *slot = *x;
        }
        let mut bins = transform.make_output_vec();
        transform.process(&mut input, &mut bins).ok()?;
        Some(Self { bins, bin_hz: rate_hz / size as f64, size, length_s: samples.len() as f64 / rate_hz })
    }

    /// Power `|X|²` of each bin, in units of the sum over samples.
    pub(crate) fn power(&self) -> impl Iterator<Item = f64> + '_ {
        self.bins.iter().map(Complex::norm_sqr)
    }

    /// Distance between bins in Hz.
    pub(crate) fn bin_hz(&self) -> f64 {
        self.bin_hz
    }

    /// The band round a whole number of Bark.
    pub(crate) fn bark_band(&self, rate: f64, centre_hz: f64) -> Option<Subband> {
        let smear_s = (TAU * SPREAD_BARK * width_hz(centre_hz)).recip();
        self.band(|f| gaussian(bark(f), rate, SPREAD_BARK), centre_hz, smear_s)
    }

    /// The band of a response that rises up to `centre_hz` and falls behind it.
    ///
    /// The rate of its analytic signal is no higher than its width requires. `None` if the response
    /// is negligible at the bin nearest to `centre_hz`.
    pub(crate) fn band(&self, response: impl Fn(f64) -> f64, centre_hz: f64, smear_s: f64) -> Option<Subband> {
        let least = gaussian(REACH, 0.0, 1.0);
        let is_heard = |bin: usize| response(bin as f64 * self.bin_hz) > least;
        let count = self.bins.len();
        let centre = ((centre_hz / self.bin_hz).round() as usize).min(count.saturating_sub(1));
        if count == 0 || !is_heard(centre) {
            return None;
        }
        let first = first_bin(0, centre, is_heard);
        let last = first_bin(centre, count, |bin| !is_heard(bin)) - 1;
        let weights = (first..=last).map(|bin| response(bin as f64 * self.bin_hz));
        let weights: Vec<f64> = weights.collect();
        // A real transform of twice the band's width gives the real part of the analytic signal,
        // shifted down in frequency. Turned by a quarter, it gives the imaginary part. The first
        // bin has to be real, so the band begins at the second.
        let size = (2 * (last - first + 3)).next_power_of_two().max(64);
        let transform = fourier::inverse(size);
        let part = |turn: Complex<f64>| {
            let mut input = transform.make_input_vec();
            let cut = self.bins.get(first..=last).unwrap_or(&[]);
            for ((slot, bin), weight) in input.iter_mut().skip(1).zip(cut).zip(&weights) {
                *slot = bin * turn * *weight;
            }
            let mut output = transform.make_output_vec();
            transform.process(&mut input, &mut output).ok().map(|()| output)
        };
        let (real, imaginary) = (part(Complex::new(1.0, 0.0))?, part(Complex::new(0.0, -1.0))?);
        // A real sine has half its amplitude on each side of the spectrum; the inverse of a real
        // transform takes both sides.
        let scale = (self.size as f64).recip().powi(2);
        let rate_hz = self.bin_hz * size as f64;
        let heard = (self.length_s * rate_hz) as usize;
        let power = real.iter().zip(&imaginary).take(heard).map(|(re, im)| (re * re + im * im) * scale);
        Some(Subband { power: power.collect(), rate_hz, smear_s })
    }
}

/// First bin from `from` on that is wanted; `to` if none before it is.
///
/// No bin behind a wanted one may be unwanted.
fn first_bin(from: usize, to: usize, is_wanted: impl Fn(usize) -> bool) -> usize {
    let (mut from, mut to) = (from, to);
    while from < to {
        let middle = usize::midpoint(from, to);
        if is_wanted(middle) { to = middle } else { from = middle + 1 }
    }
    to
}

#[cfg(test)]
mod tests {
    use super::super::scale::frequency_hz;
    use super::*;

    #[test]
    fn envelope_of_a_sine_in_the_middle_of_a_band_is_its_amplitude() {
        let rate_hz = 44_100.0;
        for rate in [2.0, 9.0, 17.0, 22.0] {
            let centre_hz = frequency_hz(rate);
            let sound: Vec<f64> = (0..44_100).map(|n| 0.3 * (TAU * centre_hz * f64::from(n) / rate_hz).sin()).collect();
            let band = Spectrum::of(&sound, rate_hz)
                .and_then(|spectrum| spectrum.bark_band(rate, centre_hz))
                .expect("there is sound");
            let middle = band.power[band.power.len() / 2].sqrt();
            assert!((middle / 0.3 - 1.0).abs() < 1e-3, "{rate} Bark: {middle}");
        }
    }

    #[test]
    fn all_responses_together_are_constant_within_1_5_percent() {
        let sum = |f: f64| -> f64 { (-3..30).map(|rate| gaussian(bark(f), f64::from(rate), SPREAD_BARK)).sum() };
        let sums: Vec<f64> = (1..2000).map(|step| sum(f64::from(step) * 10.0)).collect();
        let (least, most) = sums.iter().fold((f64::MAX, 0.0_f64), |(least, most), x| (least.min(*x), most.max(*x)));
        assert!(most / least < 1.03, "{least} to {most}");
    }
}
