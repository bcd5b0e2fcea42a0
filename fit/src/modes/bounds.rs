//! Cramer-Rao bounds of modes in white noise.

use nalgebra::{Cholesky, Complex, DMatrix};
use serde::Serialize;

use super::basis::{Basis, Stretch};
use super::damped_sine::DampedSine;
use super::noise::NoiseFloor;
use super::pole::Pole;

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

/// Cramer-Rao bounds: standard deviations of `[decay, angular, ln amplitude]` of each mode, per
/// sample.
///
/// The noise is white with variance `noise_variance`; all gains and poles are unknown. `None` if
/// the modes cannot be told apart.
fn standard_deviations(length: usize, modes: &[(Pole, Complex<f64>)], noise_variance: f64) -> Option<Vec<[f64; 3]>> {
    let silence = vec![0.0; length];
    let stretch = Stretch::ringing(&silence);
    let bases: Vec<Basis> = modes.iter().map(|(pole, _)| Basis::new(*pole, &stretch)).collect();
    let size = 4 * modes.len();
    let mut information = DMatrix::zeros(size, size);
    let turn = Complex::new(0.0, 1.0);
    // Columns of each mode: decay, angular, ln amplitude, phase.
    let columns = |c: Complex<f64>| [(true, -c), (true, turn * c), (false, c), (false, turn * c)];
    for (k, (a, (_, gain_a))) in bases.iter().zip(modes).enumerate() {
        for (l, (b, (_, gain_b))) in bases.iter().zip(modes).enumerate() {
            let products = a.products(b);
            for (i, (ramp_a, alpha)) in columns(*gain_a).into_iter().enumerate() {
                for (j, (ramp_b, beta)) in columns(*gain_b).into_iter().enumerate() {
                    let pair = match (ramp_a, ramp_b) {
                        (false, false) => products.uu,
                        (false, true) => products.uv,
                        (true, false) => products.vu,
                        (true, true) => products.vv,
                    };
                    information[(4 * k + i, 4 * l + j)] = pair.real(alpha, beta);
                }
            }
        }
    }
    // A unit diagonal makes the inverse exact in any units.
    let scale: Vec<f64> = (0..size).map(|index| information[(index, index)].sqrt()).collect();
    for row in 0..size {
        for column in 0..size {
            information[(row, column)] /= scale[row] * scale[column];
        }
    }
    let inverse = Cholesky::new(information)?.inverse();
    let deviation = |index: usize| (noise_variance * inverse[(index, index)]).sqrt() / scale[index];
    Some((0..modes.len()).map(|k| [4 * k, 4 * k + 1, 4 * k + 2].map(deviation)).collect())
}
