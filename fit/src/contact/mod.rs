//! The contact between striker and object: how long it lasts, from sound alone.

mod from_sound;

pub use from_sound::contact_time_s;

use std::f64::consts::PI;

/// Full width at half maximum of a half-sine contact of time T, as a share of T.
pub const HALF_SINE_FWHM: f64 = 2.0 / 3.0;

/// The half-sine force of a contact of `contact_time_s`, peak 1, sampled from its onset; at least one sample.
pub fn half_sine(contact_time_s: f64, rate_hz: f64) -> Vec<f64> {
    let length = (contact_time_s * rate_hz).ceil().max(2.0) as usize;
    (0..length).map(|n| (PI * n as f64 / (contact_time_s * rate_hz)).sin().max(0.0)).collect()
}

/// Power spectrum of a half-sine of contact time T at frequency f, 1 at f = 0: `(cos πfT / (1 - (2fT)²))²`.
pub fn half_sine_power(frequency_hz: f64, contact_time_s: f64) -> f64 {
    let x = frequency_hz * contact_time_s;
    let denominator = 1.0 - (2.0 * x).powi(2);
    if denominator.abs() < 1e-6 { (PI / 4.0).powi(2) } else { ((PI * x).cos() / denominator).powi(2) }
}
