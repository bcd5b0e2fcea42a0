//! The question whether a recording has a room, and its modes and strikes if it has one.
//!
//! A room answers a mode with a sound of the mode's frequencies that is not the mode's: its
//! amplitude wanders. Between the strikes of a dry recording nothing is left near a loud mode.

use super::super::changes::changes;
use super::super::free::{FreeModes, Guard, Surroundings, free_modes};
use crate::modes::Settings;

/// Least energy left near a mode, as a share of the mode's, from which there is a room: -36 dB.
///
/// Short sets in rooms leave -19 to -29 dB, dry ones -46 dB and less.
const WANDERING: f64 = 2.5e-4;
/// Share of the energy about a moment that a strike changes at least.
const CHANGE: f64 = 0.05;
/// Number of rounds of strikes and modes in turn.
const ROUNDS: usize = 2;
/// Maximum number of modes.
const MOST_MODES: usize = 32;

/// Modes and moments near which strikes begin, in a room; `None` if there is no room.
///
/// `first` are the modes between the rises of the sound. Too few of them, and missed strikes, leave
/// energy near modes too, so that strikes and modes are found anew before the room is believed.
pub(crate) fn in_a_room(
    samples: &[f64],
    first: &FreeModes,
    rate_hz: f64,
    settings: Settings,
) -> Option<(FreeModes, Vec<usize>)> {
    let settings = Settings { most_modes: settings.most_modes.min(MOST_MODES), ..settings };
    let (mut free, mut onsets) = (first.clone(), Vec::new());
    for round in 0..ROUNDS {
        if free.wandering < WANDERING || free.poles.is_empty() {
            return None;
        }
        let white = free.whitening.filtered(samples, 0..samples.len());
        let found = changes(&white, &free.poles, rate_hz, free.white_variance, CHANGE);
        onsets = found.into_iter().map(|(at, _)| at).collect();
        // The first search took the room's answer for modes.
        let known = if round == 0 { &[] } else { free.poles.as_slice() };
        free = free_modes(samples, &onsets, Guard::OF_CHANGE, rate_hz, settings, known, Surroundings::Room)?;
    }
    if free.poles.is_empty() {
        return None;
    }
    // A search that takes an answer for modes leaves nothing of a dry recording, but much of one
    // in a room.
    let (guard, dry) = (Guard::OF_CHANGE, Surroundings::Dry);
    let most = free_modes(samples, &onsets, guard, rate_hz, settings, &free.poles, dry)?;
    (most.wandering >= WANDERING).then_some((free, onsets))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::multi_strike::rises::rises;
    use crate::multi_strike::synthetic::{StruckOften, in_room, plain};

    #[test]
    fn a_room_is_found_in_a_room_and_in_no_dry_recording() {
        let is_in_room = |sound: &StruckOften| {
            let onsets = rises(&sound.samples, sound.rate_hz);
            let dry = Surroundings::Dry;
            let few = Settings { most_modes: 16, ..Settings::default() };
            let first = free_modes(&sound.samples, &onsets, Guard::OF_RISE, sound.rate_hz, few, &[], dry);
            let first = first.expect("there is time between strikes");
            in_a_room(&sound.samples, &first, sound.rate_hz, Settings::default()).is_some()
        };
        let rooms: Vec<u64> = [8, 9, 10].into_iter().filter(|seed| is_in_room(&in_room(*seed, 6.0, 10))).collect();
        let dry: Vec<u64> = [8, 9, 10].into_iter().filter(|seed| !is_in_room(&plain(*seed, 6.0, 10, -60.0))).collect();
        assert_eq!((rooms.as_slice(), dry.as_slice()), (&[8, 9, 10][..], &[8, 9, 10][..]));
    }
}
