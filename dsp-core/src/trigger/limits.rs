//! Limits of the inputs that a trigger is made for.

/// Slowest ADC rate that a trigger takes, in Hz.
pub const MIN_RATE_HZ: f64 = 32_000.0;
/// Fastest ADC rate that a trigger takes, in Hz.
pub const MAX_RATE_HZ: f64 = 64_000.0;
/// Time at a rail after which a channel counts as stuck, in seconds at an ADC rate of 48 kHz.
pub const STUCK_S: f64 = 0.02;
