//! Bands of decaying noise, and the edges that they usually have.

use serde::Serialize;

use crate::distance::erb_edges_up_to_hz;

/// Upper limit of the bands in Hz: every rate of 44.1 kHz and more plays them.
const HIGHEST_HZ: f64 = 20_000.0;

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

/// Edges in Hz of the 40 bands of the ERB distance and of those above up to 20 kHz, as far as the
/// rate reaches.
pub fn usual_edges_hz(rate_hz: f64) -> Vec<f64> {
    erb_edges_up_to_hz(highest_hz(rate_hz))
}

/// Upper limit of the bands in Hz at a sample rate.
pub(crate) fn highest_hz(rate_hz: f64) -> f64 {
    HIGHEST_HZ.min(0.49 * rate_hz)
}
