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
mod clip;
mod common;
mod contact;
mod error;
mod parts;
mod separation;
mod stems;
pub mod synthetic;

use rayon::prelude::*;

use crate::modes::{Pole, Settings};
pub use clip::Clip;
pub use error::SeparateError;
use parts::Parts;
pub use separation::{Blow, PartMode, STEPS, Separation, Stems, clipped_at_s};

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
        return Err(if parts.count > 2 { SeparateError::DisjointPairs } else { SeparateError::OnePair });
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

#[cfg(test)]
mod tests {
    use super::*;
    use synthetic::{RATE_HZ, set};

    fn clips(set: &[synthetic::Blow]) -> Vec<Clip<'_>> {
        let clip = |blow: &synthetic::Blow| (blow.object, blow.striker);
        set.iter()
            .map(|blow| Clip { samples: &blow.samples, rate_hz: RATE_HZ, object: clip(blow).0, striker: clip(blow).1 })
            .collect()
    }

    /// Energy of a distance relative to a sound, in dB.
    fn distance_db(found: &[f64], truth: &[f64]) -> f64 {
        let off: f64 = found.iter().zip(truth).map(|(a, b)| (a - b).powi(2)).sum();
        10.0 * (off / truth.iter().map(|x| x * x).sum::<f64>()).log10()
    }

    #[test]
    fn stems_of_two_strikers_on_two_things_are_near_the_true_ones_and_add_up() {
        let set = set(5, 2, 2, 2);
        let separation =
            separate(&clips(&set), &Known::default(), Settings::default(), &|_| {}).expect("it can be separated");
        let (mut things, mut strikers) = (Vec::new(), Vec::new());
        for (stems, blow) in separation.stems.iter().zip(&set) {
            things.push(distance_db(&stems.object, &blow.of_object));
            strikers.push(distance_db(&stems.striker, &blow.of_striker));
            for (n, x) in blow.samples.iter().enumerate() {
                assert!((x - stems.object[n] - stems.striker[n] - stems.rest[n]).abs() < 1e-12);
            }
            let near = stems.blows.iter().any(|found| (found.at_s - blow.at_s).abs() < 1e-3);
            assert!(near, "{:?} {}", stems.blows, blow.at_s);
        }
        let median = |values: &[f64]| crate::score::quantile(values, 0.5);
        let (thing_db, striker_db) = (median(&things), median(&strikers));
        assert!(thing_db < -18.0 && striker_db < -8.0, "{thing_db} dB, {striker_db} dB");
    }

    #[test]
    fn one_pair_alone_is_refused_unless_one_of_both_is_known() {
        let set = set(6, 1, 1, 2);
        let clips = clips(&set);
        let unknown = separate(&clips, &Known::default(), Settings::default(), &|_| {});
        assert_eq!(unknown.map(|_| ()), Err(SeparateError::OnePair));
        let known = Known { objects: vec![Some(vec![(440.0, 5.0)])], strikers: vec![None] };
        let separation = separate(&clips, &known, Settings::default(), &|_| {}).expect("the thing is known");
        assert_eq!(separation.objects[0].len(), 1);
        assert!((separation.objects[0][0].frequency_hz - 440.0).abs() < 1e-9 && !separation.strikers[0].is_empty());
    }

    #[test]
    fn pairs_that_share_neither_thing_nor_striker_are_refused_by_name() {
        let set = set(6, 2, 2, 1);
        let clips: Vec<Clip<'_>> = clips(&set).into_iter().filter(|clip| clip.object == clip.striker).collect();
        let refused = separate(&clips, &Known::default(), Settings::default(), &|_| {}).err();
        assert_eq!((clips.len(), refused), (2, Some(SeparateError::DisjointPairs)));
    }

    #[test]
    fn silence_and_other_rates_are_refused_with_the_recording() {
        let set = set(7, 2, 1, 1);
        let mut clips = clips(&set);
        let silence = vec![0.0; 20_000];
        let refused = |clips: &[Clip<'_>]| separate(clips, &Known::default(), Settings::default(), &|_| {}).err();
        clips[1].rate_hz = 48_000.0;
        assert_eq!(refused(&clips), Some(SeparateError::Rates { clip: 1, rate_hz: 48_000.0, first_hz: RATE_HZ }));
        clips[1] = Clip { samples: &silence, rate_hz: RATE_HZ, ..clips[1] };
        assert_eq!(refused(&clips), Some(SeparateError::NoBlow { clip: 1 }));
        assert_eq!(refused(&[]), Some(SeparateError::Nothing));
    }
}
