//! Cramer-Rao bounds of modes in white noise.

use serde::Serialize;

use super::damped_sine::DampedSine;
use super::noise::NoiseFloor;
use super::pole::Pole;
use super::refine::standard_deviations;

/// Cramer-Rao bounds of a mode: the smallest standard deviations of an unbiased estimator.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Bounds {
    /// Standard deviation of the frequency in Hz.
    pub frequency_hz: f64,
    /// Standard deviation of the decay rate in 1/s.
    pub decay_per_s: f64,
    /// Relative standard deviation of the amplitude.
    pub amplitude: f64,
}

/// Bounds of modes that ring together in white noise of `noise_rms`, over `length` samples.
///
/// All frequencies, decays, amplitudes and phases are unknown. `None` if two modes are equal.
pub fn cramer_rao_bounds(modes: &[DampedSine], length: usize, rate_hz: f64, noise_rms: f64) -> Option<Vec<Bounds>> {
    let modes: Vec<_> =
        modes.iter().map(|sine| (Pole::new(sine.frequency_hz, sine.decay_per_s, rate_hz), sine.gain())).collect();
    let deviations = standard_deviations(length, &modes, noise_rms * noise_rms)?;
    let bounds = deviations.into_iter().map(|[decay, angular, amplitude]| Bounds {
        frequency_hz: angular * rate_hz / std::f64::consts::TAU,
        decay_per_s: decay * rate_hz,
        amplitude,
    });
    Some(bounds.collect())
}

/// Standard deviations of the modes that explain a recording, in the noise that they leave.
///
/// They are the bounds in white noise of the level that the residual has round each mode's
/// frequency. `None` if two modes are equal.
pub fn standard_deviations_in(modes: &[DampedSine], residual: &[f64], rate_hz: f64) -> Option<Vec<Bounds>> {
    let noise = NoiseFloor::of_residual(residual);
    let unit = cramer_rao_bounds(modes, residual.len(), rate_hz, 1.0)?;
    let scaled = unit.into_iter().zip(modes).map(|(bounds, mode)| {
        let rms = noise.variance(std::f64::consts::TAU * mode.frequency_hz / rate_hz).sqrt();
        Bounds {
            frequency_hz: rms * bounds.frequency_hz,
            decay_per_s: rms * bounds.decay_per_s,
            amplitude: rms * bounds.amplitude,
        }
    });
    Some(scaled.collect())
}
