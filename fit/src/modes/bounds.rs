//! Cramer-Rao bounds of modes in white noise.

use super::damped_sine::DampedSine;
use super::pole::Pole;
use super::refine::standard_deviations;

/// Cramer-Rao bounds of a mode: the smallest standard deviations of an unbiased estimator.
#[derive(Clone, Copy, Debug, PartialEq)]
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
