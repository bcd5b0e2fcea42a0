//! Measures of how near a rendering is to a recorded strike, as an ear hears both.
//!
//! | measure | what it compares |
//! | --- | --- |
//! | log-spectral distance | single bins in dB, until 0.25 s behind the peak |
//! | ERB distance | levels in 40 bands in dB, over the whole strike, and over that beginning |
//! | loudness error | loudness in 60 gammatone bands every 2 ms: share in the wrong place |
//! | partials | share of the audible partials whose level is right within 3 dB |
//! | peak | the rendering's peak over the recording's |
//! | attack | rms of the rendering's first 3 ms over the recording's |
//!
//! A strike is judged from its onset on. The sound before the onset is the background: it masks
//! quiet partials, and is not part of the strike.

#[cfg(test)]
mod clicks;
mod gammatone;
mod loudness;
mod partials;

use serde::Serialize;

use crate::distance::{Distances, RecordedLevels};

pub(crate) use gammatone::HOP_S;
pub use gammatone::{centres_hz, threshold_db};
pub use loudness::{Loudness, LoudnessError, specific_loudness};
pub use partials::{Partial, Partials, RIGHT_DB};

/// Length of the beginning of a strike whose loudness is compared, in seconds.
pub(crate) const LOUDNESS_S: f64 = 4.0;

/// Length of the attack whose level is compared, in seconds.
pub(crate) const ATTACK_S: f64 = 0.003;
/// Magnitude that stands for silence: -180 dBFS.
const SILENCE: f64 = 1e-9;

/// A recorded strike and what is needed to compare renderings with it.
#[derive(Clone, Debug)]
pub struct Heard {
    rate_hz: f64,
    length: usize,
    levels: RecordedLevels,
    loudness: Loudness,
    partials: Partials,
}

/// Measures of a rendering against a recorded strike.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Scores {
    /// Log-spectral distance in dB from the onset until 0.25 s behind the recording's peak.
    pub lsd_db: f64,
    /// ERB distance in dB over the whole strike.
    pub erb_db: f64,
    /// ERB distance in dB over the part that the log-spectral distance compares.
    pub early_erb_db: f64,
    /// Share of the recording's loudness that the rendering has too much or too little.
    pub loudness_error: f64,
    /// Loudness error within the first 0.25 s of the strike.
    pub early_loudness_error: f64,
    /// Share of the audible partials, weighted by loudness, whose level is right within 3 dB.
    pub partials: f64,
    /// Peak of the rendering over that of the recording, in dB.
    pub peak_db: f64,
    /// Rms of the rendering's first 3 ms over that of the recording, in dB.
    pub attack_db: f64,
}

impl Heard {
    /// The strike of a recording between two samples; the samples before it are the background.
    pub fn new(recording: &[f64], rate_hz: f64, onset: usize, end: usize) -> Self {
        let end = end.min(recording.len());
        let onset = onset.min(end);
        let strike = recording[onset..end].to_vec();
        let longest = (LOUDNESS_S * rate_hz) as usize;
        let before = &recording[..onset];
        Self {
            rate_hz,
            levels: RecordedLevels::new(before, &strike, rate_hz),
            loudness: Loudness::new(&strike[..longest.min(strike.len())], before, rate_hz),
            partials: Partials::new(before, &strike, rate_hz),
            length: strike.len(),
        }
    }

    /// Measures of a rendering that begins at the strike's onset and is at least as long.
    pub fn scores(&self, rendering: &[f64]) -> Scores {
        let length = self.length.min(rendering.len());
        let rendering = &rendering[..length];
        let Distances { lsd_db, erb_db, early_erb_db } = self.levels.distances(rendering);
        let loudness = self.loudness.error(&rendering[..self.loudness.length().min(length)]);
        Scores {
            lsd_db,
            erb_db,
            early_erb_db,
            loudness_error: loudness.whole,
            early_loudness_error: loudness.early,
            partials: self.partials.matched(rendering),
            peak_db: 20.0 * (peak(rendering) / peak(self.levels.strike())).log10(),
            attack_db: 10.0 * (self.attack(rendering) / self.attack(self.levels.strike())).log10(),
        }
    }

    /// Power of a sound's first 3 ms.
    fn attack(&self, sound: &[f64]) -> f64 {
        let first = &sound[..sound.len().min((ATTACK_S * self.rate_hz) as usize)];
        first.iter().map(|x| x * x).sum::<f64>().max(SILENCE * SILENCE)
    }

    /// Loudness of the strike.
    pub fn loudness(&self) -> &Loudness {
        &self.loudness
    }

    /// Audible partials of the strike.
    pub fn partials(&self) -> &Partials {
        &self.partials
    }
}

impl Scores {
    /// Mean of several scores; all 0 without scores.
    pub fn mean(scores: &[Self]) -> Self {
        let mean = |of: fn(&Self) -> f64| scores.iter().map(of).sum::<f64>() / scores.len().max(1) as f64;
        Self {
            lsd_db: mean(|scores| scores.lsd_db),
            erb_db: mean(|scores| scores.erb_db),
            early_erb_db: mean(|scores| scores.early_erb_db),
            loudness_error: mean(|scores| scores.loudness_error),
            early_loudness_error: mean(|scores| scores.early_loudness_error),
            partials: mean(|scores| scores.partials),
            peak_db: mean(|scores| scores.peak_db),
            attack_db: mean(|scores| scores.attack_db),
        }
    }
}

/// Largest magnitude of a sound.
fn peak(sound: &[f64]) -> f64 {
    sound.iter().fold(SILENCE, |peak, x| peak.max(x.abs()))
}
