//! Expected values of the residual's noise: power over time, energy over frequency.

use std::f64::consts::PI;

use super::band::{Band, Hold};

/// Expected power of a band at `time_s` (0 or above) after a strike at the reference force:
/// `w² 10^(-γ t/10)`.
pub fn power(band: &Band, time_s: f64) -> f64 {
    band.weight * band.weight * 10f64.powf(-band.decay_db_per_s * time_s / 10.0)
}

/// Amplitude of a band at `time_s` (0 or above) after a strike, as a share of its amplitude at 0.
///
/// The band falls by its own decay. During each of `holds`, which do not overlap, it falls at least
/// by the hand's decay.
pub fn envelope(band: &Band, holds: &[Hold], time_s: f64) -> f64 {
    let own = band.decay_per_s();
    let more = |hold: &Hold| {
        let held_s = (hold.to_s.min(time_s) - hold.from_s.max(0.0)).max(0.0);
        (1000f64.ln() / hold.t60_s - own).max(0.0) * held_s
    };
    (-own * time_s - holds.iter().map(more).sum::<f64>()).exp()
}

/// Expected one-sided energy density of one strike at a frequency, in full scale squared times
/// seconds per hertz.
///
/// The noise of a band has the flat power `w²/(f2 - f1)` between its edges, times `e^(-σt)` from
/// `t = 0` on. Its density is convolved with the envelope's spectrum `1/(σ² + 4π² Δ²)`. The
/// integral of that spectrum over the band is a difference of two arctangents. Negative frequencies
/// count as well. Every decay must be above 0; otherwise the energy has no bound.
pub fn energy_density(bands: &[Band], frequency_hz: f64) -> f64 {
    let of_band = |band: &Band| {
        let (sigma, [low, high]) = (band.decay_per_s(), band.edges_hz);
        let reach = |from: f64, to: f64| {
            ((2.0 * PI * to / sigma).atan() - (2.0 * PI * from / sigma).atan()) / (2.0 * PI * sigma)
        };
        let both = reach(low - frequency_hz, high - frequency_hz) + reach(-high - frequency_hz, -low - frequency_hz);
        band.weight * band.weight / (high - low) * both
    };
    bands.iter().map(of_band).sum()
}
