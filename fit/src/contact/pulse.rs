//! The contact pulse that fits assume, its force and its spectrum.

use std::f64::consts::PI;

use kit::Striker;
use reference::{Pulse, SampleRate};

/// Full width at half maximum of the contact pulse, as a share of its contact time T.
pub const PULSE_FWHM: f64 = 0.500_266;

/// Skew A of the pulse at the default restitution: `(1-r)/(1+r)`, `r = 0.45^4.6`.
const SKEW: f64 = 0.950_464_6;

/// The contact pulse of a striker with the default restitution; its spectrum has no zeros.
fn pulse() -> Pulse {
    Pulse::Hertz { restitution: f64::from(Striker::DEFAULT_RESTITUTION) }
}

/// Force of a contact that begins at sample 0, with a peak of 1, as the instrument plays it.
///
/// Each sample is the mean over the interval that ends there.
pub fn force(contact_time_s: f64, rate_hz: f64) -> Vec<f64> {
    let rate = SampleRate { numerator: rate_hz.round() as u32, denominator: 1 };
    let length = (contact_time_s * rate_hz).ceil() as usize + 1;
    (0..length).map(|n| pulse().sample(n as f64 / rate.hz(), contact_time_s, rate)).collect()
}

/// Power spectrum of a contact of time T at frequency f, 1 at f = 0.
///
/// `(cos πx / (1 - 4x²))² + (A/4 sin πx / (1 - x²))²` with x = fT.
pub fn pulse_power(frequency_hz: f64, contact_time_s: f64) -> f64 {
    let x = frequency_hz * contact_time_s;
    let (sine, cosine) = (PI * x).sin_cos();
    let near = |pole: f64| (x - pole).abs() < 1e-6;
    let even = if near(0.5) { PI / 4.0 } else { cosine / (1.0 - 4.0 * x * x) };
    let odd = if near(1.0) { PI / 2.0 } else { sine / (1.0 - x * x) };
    even.powi(2) + (SKEW / 4.0 * odd).powi(2)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn spectrum_of_the_force_is_the_closed_form() {
        // A high rate, because the mean over a sample attenuates by sinc(f/fs).
        let (time_s, rate_hz) = (1e-3, 4_000_000.0);
        let force = force(time_s, rate_hz);
        let transform = |frequency_hz: f64| {
            let (mut re, mut im) = (0.0, 0.0);
            for (n, x) in force.iter().enumerate() {
                let (sine, cosine) = (2.0 * PI * frequency_hz * n as f64 / rate_hz).sin_cos();
                re += x * cosine;
                im += x * sine;
            }
            re * re + im * im
        };
        for frequency_hz in [100.0, 500.0, 1_000.0, 1_500.0, 2_500.0, 7_300.0, 12_000.0] {
            let ratio = transform(frequency_hz) / transform(0.0) / pulse_power(frequency_hz, time_s);
            assert!((ratio - 1.0).abs() < 1e-3, "{frequency_hz} Hz: {ratio}");
        }
    }

    #[test]
    fn width_at_half_maximum_is_the_documented_share() {
        let force = force(1.0, 1_000_000.0);
        let above = force.iter().filter(|x| **x > 0.5).count() as f64 / 1e6;
        assert!((above - PULSE_FWHM).abs() < 3e-6, "{above}");
    }

    #[test]
    fn pulse_spectrum_never_rises_by_half_a_decibel() {
        let mut lowest = 1.0f64;
        for step in 1..200_000 {
            let power = pulse_power(f64::from(step) * 1e-4, 1.0);
            let rise_db = 10.0 * (power / lowest).log10();
            assert!(rise_db < 0.5, "fT = {}: {rise_db} dB", f64::from(step) * 1e-4);
            lowest = lowest.min(power);
        }
    }
}
