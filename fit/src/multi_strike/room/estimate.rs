//! The room and the background of a recording of many strikes, as they are reported.

use std::f64::consts::PI;

use serde::Serialize;

use crate::score::quantile;

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
    /// T60 in seconds: median over the octaves.
    pub t60_s: f64,
    /// Standard deviation of T60 in seconds.
    pub t60_s_sd: f64,
    /// Energy of the room's response relative to that of the direct sound, in dB: median over the
    /// octaves.
    pub gain_db: f64,
    /// Standard deviation of the gain in dB.
    pub gain_db_sd: f64,
}

impl RoomEstimate {
    /// The room of some octaves; `None` without any.
    ///
    /// A mode that was not found spoils one octave, and a median leaves it aside.
    pub(crate) fn of_bands(bands: Vec<RoomBandEstimate>) -> Option<Self> {
        if bands.is_empty() {
            return None;
        }
        let logarithms: Vec<f64> = bands.iter().map(|band| band.t60_s.ln()).collect();
        let gains: Vec<f64> = bands.iter().map(|band| band.gain_db).collect();
        let t60_s = quantile(&logarithms, 0.5).exp();
        let gain_db = quantile(&gains, 0.5);
        // A median's variance is π/2 times a mean's.
        let of_median = |deviations: &dyn Fn(&RoomBandEstimate) -> f64| {
            let squares: f64 = bands.iter().map(|band| deviations(band).powi(2)).sum();
            (0.5 * PI * squares).sqrt() / bands.len() as f64
        };
        let t60_s_sd = t60_s * of_median(&|band| band.t60_s_sd / band.t60_s);
        let gain_db_sd = of_median(&|band| band.gain_db_sd);
        Some(Self { bands, t60_s, t60_s_sd, gain_db, gain_db_sd })
    }
}

/// Level of the stationary noise in an octave of a recording.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct BackgroundBand {
    /// Lower and upper edge in Hz, an octave apart; the highest octave may be cut off.
    pub edges_hz: [f64; 2],
    /// Rms in the octave, in dB of full scale.
    pub level_dbfs: f64,
}
