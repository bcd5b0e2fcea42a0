//! Response of the filter at one moment (dynamic-filter eq. 5), and of Bark bands to its noise.

use std::f64::consts::{PI, TAU};

use nalgebra::Complex;

use super::model::{Coefficients, RATE_HZ};
use crate::bark::{bark, frequency_hz, width_hz};

/// Variance of the dynamic filter's noise, uniform from -1 to 1.
const NOISE_VARIANCE: f64 = 1.0 / 3.0;
/// Mean square of the noise's envelope per Hz at 48 kHz: its one-sided density, doubled for an
/// analytic signal.
pub(crate) const NOISE_DENSITY: f64 = 2.0 * 2.0 * NOISE_VARIANCE / RATE_HZ;
/// Standard deviation in Bark of a band's response to power: that of [`crate::bark`] to amplitude
/// over √2.
const SPREAD_BARK: f64 = 0.5 * std::f64::consts::FRAC_1_SQRT_2;
/// Number of sample points on either side of a band's middle.
const PLACES: i32 = 3;
/// Distance of the sample points in standard deviations of the band's response.
const APART: f64 = 0.9;

/// Response `F(e^{iω})` for frozen coefficients, ω in radians a sample.
pub fn response(coefficients: &Coefficients, angular: f64) -> Complex<f64> {
    let late = Complex::from_polar(1.0, -angular);
    let [b0, b1, b2] = coefficients.b;
    let [a1, a2] = coefficients.a;
    (late * (late * b2 + b1) + b0) / (late * (late * a2 + a1) + 1.0)
}

/// Offsets of the angles near a pole, in distances of the pole from the unit circle.
const POLE_STEPS: [f64; 7] = [-2.0, -1.0, -0.5, 0.0, 0.5, 1.0, 2.0];

/// Angles ω near a filter's poles, where its magnitude may be largest, in radians a sample.
pub(crate) fn near_poles(filter: &Coefficients) -> impl Iterator<Item = f64> + use<> {
    let [a1, a2] = filter.a;
    let (middle, rest) = (-a1 / 2.0, a1 * a1 / 4.0 - a2);
    let real = |pole: f64| (if pole < 0.0 { PI } else { 0.0 }, 1.0 - pole.abs());
    let poles = match rest {
        rest if rest < 0.0 => [((-rest).sqrt().atan2(middle), 1.0 - a2.sqrt()); 2],
        rest => [1.0, -1.0].map(|sign| real(middle + sign * rest.sqrt())),
    };
    poles.into_iter().flat_map(|(angle, distance)| POLE_STEPS.map(|step| (angle + step * distance).clamp(0.0, PI)))
}

/// Response of one Bark band to white noise through the filter, at sample points.
#[derive(Clone, Debug)]
pub(crate) struct NoiseBand {
    /// Sample points: ω in radians a sample, and the weight of the filter's power there.
    places: Vec<(f64, f64)>,
}

impl NoiseBand {
    /// The band round `rate` in Bark, at 48 kHz.
    pub(crate) fn new(rate: f64) -> Self {
        let step = APART * SPREAD_BARK;
        let places = (-PLACES..=PLACES).filter_map(|place| {
            let apart = f64::from(place) * APART;
            let frequency = frequency_hz((rate + apart * SPREAD_BARK).max(0.0));
            if frequency >= 0.5 * RATE_HZ || rate + apart * SPREAD_BARK <= 0.0 {
                return None;
            }
            let weight = NOISE_DENSITY * (-0.5 * apart * apart).exp() * width_hz(frequency) * step;
            Some((TAU * frequency / RATE_HZ, weight))
        });
        Self { places: places.collect() }
    }

    /// Mean square of the band's envelope for a filter's squared magnitude as a function of ω.
    pub(crate) fn power(&self, squared: impl Fn(f64) -> f64) -> f64 {
        self.places.iter().map(|(angular, weight)| weight * squared(*angular)).sum()
    }
}

/// Power response of the band round `rate` in Bark to a sine at a frequency in Hz.
pub(crate) fn sine_power_in_band(frequency: f64, rate: f64) -> f64 {
    (-0.5 * ((bark(frequency) - rate) / SPREAD_BARK).powi(2)).exp()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn power_of_white_noise_in_a_band_follows_from_its_width() {
        for rate in [4.0, 10.0, 18.0] {
            let width = std::f64::consts::PI.sqrt() * 0.5 * width_hz(frequency_hz(rate));
            let expected = 2.0 * NOISE_VARIANCE * width / (0.5 * RATE_HZ);
            let db = 10.0 * (NoiseBand::new(rate).power(|_| 1.0) / expected).log10();
            assert!(db.abs() < 0.2, "{rate} Bark: {db}");
        }
    }

    #[test]
    fn the_first_order_form_of_eq_17_passes_nothing_at_half_the_rate() {
        let filter = Coefficients { a: [-0.7, 0.0], b: [0.2, 0.2, 0.0] };
        assert!(response(&filter, std::f64::consts::PI).norm() < 1e-12);
        assert!((response(&filter, 0.0).norm() - 0.4 / 0.3).abs() < 1e-12);
    }
}
