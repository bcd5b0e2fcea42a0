//! Output: the way of a pad's signal to stereo and to 24 bits.

use std::f64::consts::FRAC_PI_4;

/// Factor for a level in dB: `10^(dB/20)`.
pub fn level_gain(level_db: f64) -> f64 {
    10_f64.powf(level_db / 20.0)
}

/// Gains to `[left, right]` at constant power, for a `pan` from -1 (left) to 1 (right).
///
/// They are the cosine and sine of `(pan + 1) π/4`.
pub fn pan_gains(pan: f64) -> [f64; 2] {
    let angle = (pan + 1.0) * FRAC_PI_4;
    [angle.cos(), angle.sin()]
}

/// Sample as a 24-bit integer: `⌊x 2^23 + 1/2⌋`, clamped to -2^23 .. 2^23 - 1.
///
/// Halves round up, as in an integer that adds one half and shifts right. NaN becomes 0.
pub fn quantise_24(x: f64) -> i32 {
    const FULL_SCALE: f64 = (1 << 23) as f64;
    (x * FULL_SCALE + 0.5).floor().clamp(-FULL_SCALE, FULL_SCALE - 1.0) as i32
}
