//! What the law expects of its noise: power over time, energy over frequency.

use std::f64::consts::PI;

use super::Band;

/// Expected power of a band a time (seconds, not negative) after a strike at the reference force: `w² 10^(-γ t/10)`.
pub fn power(band: &Band, time_s: f64) -> f64 {
    band.weight * band.weight * 10f64.powf(-band.decay_db_per_s * time_s / 10.0)
}

/// Expected one-sided energy density (full scale squared times seconds per hertz) of one strike at a frequency.
///
/// Noise of flat power `w²/(f2 - f1)` between a band's edges, times `e^(-σt)` from t = 0 on: its density is convolved with the envelope's
/// spectrum `1/(σ² + 4π² Δ²)`, whose integral over the band is a difference of two arctangents. Negative frequencies count as well. Every decay must
/// be above 0, or the energy has no bound.
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
