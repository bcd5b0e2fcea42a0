//! The three spectral centroids at which a dynamic filter keeps the damping.

use serde::Serialize;

use super::filter_bank::{Spectrum, gaussian};
use super::scale::bark;

/// Power of the spectrum's envelope, relative to its maximum, below which the spectrum is not
/// relevant: 60 dB.
const RELEVANT: f64 = 1e-6;
/// Standard deviation in Bark over which the spectrum's power is smoothed to the envelope.
const SMOOTH_BARK: f64 = 0.25;
/// Number of points a Bark at which the envelope is computed.
const PLACES_A_BARK: usize = 8;

/// Spectral centroids in Hz (dynamic-filter eq. 18): of the whole relevant spectrum, and of the
/// parts below and above that.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Centroids {
    /// G1: centroid of the energy from 0 to `highest_hz`.
    pub whole_hz: f64,
    /// G2: centroid of the energy below G1.
    pub below_hz: f64,
    /// G3: centroid of the energy from G1 to `highest_hz`.
    pub above_hz: f64,
    /// ω_max/2π: frequency beyond which the spectrum's envelope stays 60 dB below its maximum.
    pub highest_hz: f64,
}

/// Centroids of a sound's spectrum; `None` for silence.
pub(crate) fn centroids(spectrum: &Spectrum) -> Option<Centroids> {
    let power: Vec<f64> = spectrum.power().collect();
    let bin_hz = spectrum.bin_hz();
    let rates: Vec<f64> = (0..power.len()).map(|bin| bark(bin as f64 * bin_hz)).collect();
    let places = (rates.last()? * PLACES_A_BARK as f64) as usize;
    let envelope: Vec<f64> = (0..=places)
        .map(|place| {
            let rate = place as f64 / PLACES_A_BARK as f64;
            let first = rates.partition_point(|x| *x < rate - 4.0 * SMOOTH_BARK);
            let (mut sum, mut weights) = (0.0, 0.0);
            for (power, x) in power.iter().zip(&rates).skip(first).take_while(|(_, x)| **x < rate + 4.0 * SMOOTH_BARK) {
                let weight = gaussian(*x, rate, SMOOTH_BARK);
                sum += weight * power;
                weights += weight;
            }
            if weights > 0.0 { sum / weights } else { 0.0 }
        })
        .collect();
    let most = envelope.iter().copied().fold(0.0, f64::max);
    if most <= 0.0 {
        return None;
    }
    let last = envelope.iter().rposition(|power| *power > most * RELEVANT)?;
    let highest = rates.partition_point(|rate| *rate <= last as f64 / PLACES_A_BARK as f64).clamp(1, power.len());
    let centroid = |range: std::ops::Range<usize>| {
        let (mut moment, mut energy) = (0.0, 0.0);
        for (bin, power) in power.iter().enumerate().take(range.end).skip(range.start) {
            moment += bin as f64 * bin_hz * power;
            energy += power;
        }
        if energy > 0.0 { moment / energy } else { range.start as f64 * bin_hz }
    };
    let whole_hz = centroid(0..highest);
    let middle = ((whole_hz / bin_hz).ceil() as usize).min(highest);
    Some(Centroids {
        whole_hz,
        below_hz: centroid(0..middle),
        above_hz: centroid(middle..highest),
        highest_hz: (highest - 1) as f64 * bin_hz,
    })
}
