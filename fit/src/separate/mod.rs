//! Separation: recordings of strikers on things become the sounds of each.
//!
//! ```text
//! recordings ─► blows ─► quiet stretches ─► common modes ─► contacts ─► gains ─► stems
//!  + labels     (rises)                      (a thing's in   (force of   (with what
//!                                             all its         each        all recordings
//!                                             recordings)     blow)       expect)
//! ```
//!
//! The task is that of DiffImpact's algorithm 2. There Adam descends on spectrograms; here modes
//! are found by maximum likelihood, and gains follow in closed form.

mod blows;
mod common;
mod contact;
mod error;
mod parts;
mod stems;
pub mod synthetic;

use rayon::prelude::*;
use serde::Serialize;

use crate::modes::{Pole, Settings};
pub use error::SeparateError;
use parts::Parts;

/// A recording, and who struck what in it.
#[derive(Clone, Copy, Debug)]
pub struct Clip<'a> {
    /// Samples, full scale 1.
    pub samples: &'a [f64],
    /// Sample rate in Hz.
    pub rate_hz: f64,
    /// Index of the thing.
    pub object: usize,
    /// Index of the striker.
    pub striker: usize,
}

/// Frequency in Hz and decay in 1/s of each known mode of a part.
pub type KnownModes = Vec<(f64, f64)>;

/// Modes that are known already: they stay, and their part gets no others.
#[derive(Clone, Debug, Default)]
pub struct Known {
    /// Modes of things, by their index; `None` if a thing's modes are searched for.
    pub objects: Vec<Option<KnownModes>>,
    /// Modes of strikers, by their index; `None` if a striker's modes are searched for.
    pub strikers: Vec<Option<KnownModes>>,
}

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

/// What a separation finds.
#[derive(Clone, Debug)]
pub struct Separation {
    /// Modes of each thing in order of frequency.
    pub objects: Vec<Vec<PartMode>>,
    /// Modes of each striker in order of frequency.
    pub strikers: Vec<Vec<PartMode>>,
    /// Stems of each recording.
    pub stems: Vec<Stems>,
}

/// Separates recordings into the sounds of things and of strikers.
///
/// A mode belongs to the thing or to the striker in all of whose recordings it is heard: one that
/// is loud with one partner only is the partner's. Every thing or striker with one partner alone
/// gets what no other part explains. `report` hears how many of [`STEPS`] steps are done.
///
/// # Errors
/// [`SeparateError`] if nothing tells thing and striker apart, or a recording cannot be used.
pub fn separate(
    clips: &[Clip<'_>],
    known: &Known,
    settings: Settings,
    report: &(dyn Fn(usize) + Sync),
) -> Result<Separation, SeparateError> {
    let first = clips.first().ok_or(SeparateError::Nothing)?;
    let rate_hz = first.rate_hz;
    if let Some((index, clip)) = clips.iter().enumerate().find(|(_, clip)| clip.rate_hz != rate_hz) {
        return Err(SeparateError::Rates { clip: index, rate_hz: clip.rate_hz, first_hz: rate_hz });
    }
    let parts = Parts::new(clips);
    let (owned, closed) = known_poles(&parts, known, rate_hz);
    let told_apart = |part: usize| closed[part] || parts.partners(part) > 1;
    if !(0..parts.count).filter(|&part| parts.partners(part) > 0).any(told_apart) {
        return Err(SeparateError::OnePair);
    }
    let blows: Vec<Vec<usize>> = clips.par_iter().map(|clip| blows::blows(clip.samples, rate_hz)).collect();
    let mut stretches = Vec::new();
    for (index, (clip, blows)) in clips.iter().zip(&blows).enumerate() {
        let peak = clip.samples.iter().fold(0.0, |peak: f64, x| peak.max(x.abs()));
        let quiet = common::quiet(index, clip.samples, blows, rate_hz);
        if quiet.is_empty() || peak < LEAST_PEAK {
            return Err(SeparateError::NoBlow { clip: index });
        }
        stretches.extend(quiet);
    }
    let owned = common::common_modes(&parts, &stretches, rate_hz, settings, owned, &closed, report)
        .ok_or(SeparateError::Unsolved)?;
    report(common::passes());
    stems::separated(clips, &parts, &blows, &owned, report).ok_or(SeparateError::Unsolved)
}

/// Number of steps of which a separation reports how many are done.
pub const STEPS: usize = 40;
/// Peak of a recording below which it is silent: -120 dBFS.
const LEAST_PEAK: f64 = 1e-6;

/// Poles of the parts that are known, and which parts these are.
fn known_poles(parts: &Parts, known: &Known, rate_hz: f64) -> (common::Owned, Vec<bool>) {
    let mut owned = common::Owned::default();
    let mut closed = vec![false; parts.count];
    let objects = known.objects.iter().enumerate().take(parts.objects);
    let strikers = known.strikers.iter().enumerate().map(|(index, modes)| (parts.objects + index, modes));
    for (part, modes) in objects.chain(strikers).filter(|(part, _)| *part < parts.count) {
        let Some(modes) = modes else { continue };
        closed[part] = true;
        for &(frequency_hz, decay_per_s) in modes.iter().filter(|mode| mode.0 < 0.49 * rate_hz) {
            owned.poles.push(Pole::new(frequency_hz, decay_per_s, rate_hz));
            owned.part.push(part);
        }
    }
    (owned, closed)
}
