//! High-pass for both force and sound.

use std::f64::consts::{PI, SQRT_2};

/// Filters a copy of the samples by a Butterworth high-pass of order 2 (bilinear transform).
///
/// Applied to force and sound alike, it does not change the system between them.
pub fn high_pass(samples: &[f64], cutoff_hz: f64, rate_hz: f64) -> Vec<f64> {
    let k = (PI * cutoff_hz / rate_hz).tan();
    let norm = 1.0 / (1.0 + SQRT_2 * k + k * k);
    let (b0, a1, a2) = (norm, 2.0 * (k * k - 1.0) * norm, (1.0 - SQRT_2 * k + k * k) * norm);
    let (mut s1, mut s2) = (0.0, 0.0);
    samples
        .iter()
        .map(|&x| {
            let y = b0 * x + s1;
            s1 = -2.0 * b0 * x - a1 * y + s2;
            s2 = b0 * x - a2 * y;
            y
        })
        .collect()
}
