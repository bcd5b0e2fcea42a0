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

impl RingingMode {
    /// Modes with their levels, from the frequency in Hz, the decay in 1/s and the squared
    /// amplitude of each.
    pub fn relative(modes: impl Iterator<Item = (f64, f64, f64)>) -> Vec<Self> {
        let modes: Vec<(f64, f64, f64)> = modes
            .map(|(frequency_hz, decay_per_s, squared)| (frequency_hz, decay_per_s, squared / decay_per_s))
            .collect();
        let most = modes.iter().map(|mode| mode.2).fold(f64::MIN_POSITIVE, f64::max);
        let level_db = |energy: f64| 10.0 * (energy / most).max(1e-20).log10();
        modes
            .into_iter()
            .map(|(frequency_hz, decay_per_s, energy)| Self { frequency_hz, decay_per_s, level_db: level_db(energy) })
            .collect()
    }
}
