//! Modes, as far as they tell of a material.

/// A mode as far as it tells of a material.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RingingMode {
    /// Frequency in Hz.
    pub frequency_hz: f64,
    /// Decay rate in 1/s.
    pub decay_per_s: f64,
    /// Energy of the mode's sound relative to the strongest mode's, in dB.
    pub level_db: f64,
}
