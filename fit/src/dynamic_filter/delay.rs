//! Delay of a loop (dynamic-filter eq. 22).

use std::f64::consts::TAU;

use super::model::RATE_HZ;

/// Shortest delay of a loop in samples, so that a board can compute the loop a tick at a time.
pub const SHORTEST_DELAY: f64 = 32.0;

/// Delay in seconds after which a wave returns round a loop in phase (eq. 22).
///
/// `filter_phase` is the phase of the filter at `frequency_hz`, in radians.
pub(crate) fn delay_s(frequency_hz: f64, filter_phase: f64) -> f64 {
    let period = RATE_HZ / frequency_hz;
    let first = filter_phase / TAU * period;
    let turns = ((SHORTEST_DELAY - first) / period).ceil();
    (first + turns * period) / RATE_HZ
}
