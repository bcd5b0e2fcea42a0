//! The room and the background of a recording of many strikes, as they are reported.

use serde::Serialize;

/// One octave of an estimated room, with the standard deviations of its numbers.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct RoomBandEstimate {
    /// Lower and upper edge in Hz, an octave apart.
    pub edges_hz: [f64; 2],
    /// T60 in seconds.
    pub t60_s: f64,
    /// Standard deviation of T60 in seconds.
    pub t60_s_sd: f64,
    /// Energy of the room's response in the octave, relative to that of the direct sound, in dB.
    pub gain_db: f64,
    /// Standard deviation of the gain in dB.
    pub gain_db_sd: f64,
}

/// The room of a recording of many strikes, with the standard deviations of its numbers.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct RoomEstimate {
    /// Octaves in which the room is heard, in order of frequency; at least one.
    pub bands: Vec<RoomBandEstimate>,
    /// T60 in seconds: geometric mean over the octaves, weighted by their certainty.
    pub t60_s: f64,
    /// Standard deviation of T60 in seconds.
    pub t60_s_sd: f64,
    /// Energy of the room's response relative to that of the direct sound, in dB: mean over the
    /// octaves, weighted by their certainty.
    pub gain_db: f64,
    /// Standard deviation of the gain in dB.
    pub gain_db_sd: f64,
}

impl RoomEstimate {
    /// The room of some octaves; `None` without any.
    pub(crate) fn of_bands(bands: Vec<RoomBandEstimate>) -> Option<Self> {
        // Mean and deviation of numbers with deviations of their own.
        let mean = |numbers: &[(f64, f64)]| {
            let weights: Vec<f64> = numbers.iter().map(|(_, sd)| 1.0 / (sd * sd).max(LEAST_VARIANCE)).collect();
            let sum: f64 = weights.iter().sum();
            let along: f64 = numbers.iter().zip(&weights).map(|((x, _), weight)| x * weight).sum();
            (along / sum, sum.recip().sqrt())
        };
        if bands.is_empty() {
            return None;
        }
        let times: Vec<(f64, f64)> =
            bands.iter().map(|band| (band.t60_s.ln(), band.t60_s_sd / band.t60_s)).collect();
        let gains: Vec<(f64, f64)> = bands.iter().map(|band| (band.gain_db, band.gain_db_sd)).collect();
        let ((logarithm, spread), (gain_db, gain_db_sd)) = (mean(&times), mean(&gains));
        let t60_s = logarithm.exp();
        Some(Self { bands, t60_s, t60_s_sd: spread * t60_s, gain_db, gain_db_sd })
    }
}

/// Least variance of an octave's number, so that no octave counts alone.
const LEAST_VARIANCE: f64 = 1e-4;

/// Level of the stationary noise in an octave of a recording.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct BackgroundBand {
    /// Lower and upper edge in Hz, an octave apart; the highest octave may be cut off.
    pub edges_hz: [f64; 2],
    /// Rms in the octave, in dB of full scale.
    pub level_dbfs: f64,
}
