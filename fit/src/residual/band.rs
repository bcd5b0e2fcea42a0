//! A band of the residual.

use serde::Serialize;

/// A band of decaying noise.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Band {
    /// Lower and upper edge in Hz.
    pub edges_hz: [f64; 2],
    /// Rms at t = 0, full scale 1; 0 for a band without noise.
    pub weight: f64,
    /// Decay in dB/s, 0 or more.
    pub decay_db_per_s: f64,
}
