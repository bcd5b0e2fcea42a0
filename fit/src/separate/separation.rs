//! Modes, blows and stems that a separation finds.

use serde::Serialize;

use crate::clipping::Limits;
use crate::material::RingingMode;
use crate::multi_strike::is_clipped;

/// Number of steps of which a separation reports how many are done.
pub const STEPS: usize = 40;

/// A mode of a thing or a striker.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PartMode {
    /// Frequency in Hz.
    pub frequency_hz: f64,
    /// Decay rate in 1/s.
    pub decay_per_s: f64,
    /// Gains `[sine, cosine]` in output per newton-second, as tables define them, in the part's
    /// loudest blow, the force of which has a peak of 1.
    pub gain: [f64; 2],
    /// Energy heard in the part's recordings, relative to the part's strongest mode, in dB.
    pub level_db: f64,
}

impl PartMode {
    /// The mode as far as it tells of a material.
    pub fn ringing(&self) -> RingingMode {
        RingingMode { frequency_hz: self.frequency_hz, decay_per_s: self.decay_per_s, level_db: self.level_db }
    }
}

/// A blow of a recording.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Blow {
    /// Onset of the contact in seconds.
    pub at_s: f64,
    /// Contact time in seconds.
    pub contact_time_s: f64,
    /// Level in dB relative to the recording's loudest blow.
    pub level_db: f64,
}

/// Onsets in seconds of the blows at which a recording is clipped: it stands still at its highest
/// or lowest value.
pub fn clipped_at_s(samples: &[f64], rate_hz: f64, blows: &[Blow]) -> Vec<f64> {
    let limits = Limits::of(samples);
    let is_clipped = |at_s: &f64| is_clipped(samples, (at_s * rate_hz).max(0.0) as usize, rate_hz, limits);
    blows.iter().map(|blow| blow.at_s).filter(is_clipped).collect()
}

/// The sounds of which a recording is the sum, and its blows.
#[derive(Clone, Debug)]
pub struct Stems {
    /// Sound of the thing.
    pub object: Vec<f64>,
    /// Sound of the striker, with its acceleration sound.
    pub striker: Vec<f64>,
    /// Rest: the recording without both.
    pub rest: Vec<f64>,
    /// Energy of the rest relative to the recording's, in dB.
    pub left_db: f64,
    /// Blows in order of time.
    pub blows: Vec<Blow>,
}

/// Result of a separation.
#[derive(Clone, Debug)]
pub struct Separation {
    /// Modes of each thing in order of frequency.
    pub objects: Vec<Vec<PartMode>>,
    /// Modes of each striker in order of frequency.
    pub strikers: Vec<Vec<PartMode>>,
    /// Stems of each recording.
    pub stems: Vec<Stems>,
}
