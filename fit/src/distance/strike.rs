//! Distances of a rendering from a recorded strike, whose frames begin before the onset.
//!
//! A Hann window is 0 where it begins: a frame that begins with the strike does not hear the
//! strike's first milliseconds. So frames begin half a window before the onset. There both sounds
//! are the recording's own, since a rendering has nothing before the strike. A rendering is
//! heard in noise like the recording's steady background, which is no part of the strike.

use std::borrow::Cow;

use super::background::Background;
use super::erb::{self, ErbLevels};
use super::lsd::{self, LONGEST_WINDOW, lsd_window};

/// Distances of a sound from a recording.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct Distances {
    /// Log-spectral distance in dB.
    pub lsd_db: f64,
    /// ERB distance over the whole strike in dB.
    pub erb_db: f64,
    /// ERB distance in dB over the part of the strike that the log-spectral distance compares.
    pub early_erb_db: f64,
}

/// A recorded strike from its onset on, with which renderings are compared.
#[derive(Clone, Debug)]
pub struct RecordedLevels {
    /// Samples before the onset, as many as half the longest window; zeros where there are none.
    lead: Vec<f64>,
    strike: Vec<f64>,
    /// Noise like the steady background of the strike; empty without one.
    background: Vec<f64>,
    rate_hz: f64,
    /// Number of samples of the beginning.
    early: usize,
    levels: ErbLevels,
    early_levels: ErbLevels,
}

impl RecordedLevels {
    /// Levels of a strike; `before` are the samples that precede it.
    pub fn new(before: &[f64], strike: &[f64], rate_hz: f64) -> Self {
        let lead = lead(before, LONGEST_WINDOW / 2);
        let early = lsd_window(strike, rate_hz).end;
        let levels = |part: &[f64]| ErbLevels::new(&joined(&lead, part, erb::WINDOW / 2), rate_hz);
        Self {
            levels: levels(strike),
            early_levels: levels(&strike[..early]),
            strike: strike.to_vec(),
            background: Background::under(before, strike, rate_hz)
                .map_or_else(Vec::new, |background| background.sound(strike.len())),
            rate_hz,
            early,
            lead,
        }
    }

    /// The strike from its onset on.
    pub(crate) fn strike(&self) -> &[f64] {
        &self.strike
    }

    /// Number of samples of the strike that the log-spectral distance compares.
    pub(crate) fn early(&self) -> usize {
        self.early
    }

    /// Distances of a rendering that begins at the onset.
    pub fn distances(&self, rendering: &[f64]) -> Distances {
        let rendering = &*self.in_background(rendering);
        let levels = |part: &[f64]| ErbLevels::new(&joined(&self.lead, part, erb::WINDOW / 2), self.rate_hz);
        let early = &rendering[..self.early.min(rendering.len())];
        Distances {
            lsd_db: self.lsd_in_background_db(rendering),
            erb_db: self.levels.distance_db(&levels(rendering)),
            early_erb_db: self.early_levels.distance_db(&levels(early)),
        }
    }

    /// Log-spectral distance in dB of a rendering that begins at the onset.
    ///
    /// It is the mean over Hann windows of 512 and 2048 samples (hop a quarter) of the mean over
    /// frames of the rms over bins of the difference of the two dB spectra. Frames begin half a
    /// window before the onset and end 0.25 s behind the sample that is 20 before the peak. Both
    /// spectra are floored 60 dB below the recording's maximum, and both strikes have unit rms.
    pub fn lsd_db(&self, rendering: &[f64]) -> f64 {
        self.lsd_in_background_db(&self.in_background(rendering))
    }

    /// A rendering with noise like the background of the recording.
    fn in_background<'a>(&self, rendering: &'a [f64]) -> Cow<'a, [f64]> {
        if self.background.is_empty() {
            return Cow::Borrowed(rendering);
        }
        Cow::Owned(rendering.iter().zip(&self.background).map(|(rendering, noise)| rendering + noise).collect())
    }

    fn lsd_in_background_db(&self, rendering: &[f64]) -> f64 {
        let mut rendering = rendering[..self.early.min(rendering.len())].to_vec();
        rendering.resize(self.early, 0.0);
        let (wanted, given) = (&self.strike[..self.early], &rendering[..]);
        let scale = lsd::to_unit_rms(wanted);
        let of_unit_rms = |samples: &[f64], scale: f64| samples.iter().map(|x| x * scale).collect::<Vec<_>>();
        let lead = of_unit_rms(&self.lead, scale);
        let (wanted, given) = (of_unit_rms(wanted, scale), of_unit_rms(given, lsd::to_unit_rms(given)));
        let distances = lsd::SIZES.map(|size| {
            let [wanted, given] = [&wanted, &given].map(|sound| joined(&lead, sound, size / 2));
            let frames = lsd::frame_distances_db(&wanted, &given, size);
            frames.iter().sum::<f64>() / frames.len().max(1) as f64
        });
        distances.iter().sum::<f64>() / distances.len() as f64
    }
}

/// The last `length` samples of a sound, behind zeros if it is shorter.
pub fn lead(before: &[f64], length: usize) -> Vec<f64> {
    let known = &before[before.len().saturating_sub(length)..];
    let mut lead = vec![0.0; length - known.len()];
    lead.extend_from_slice(known);
    lead
}

/// A strike behind the last `length` samples of its lead.
fn joined(lead: &[f64], strike: &[f64], length: usize) -> Vec<f64> {
    let lead = &lead[lead.len().saturating_sub(length)..];
    lead.iter().chain(strike).copied().collect()
}
