//! Strikes of a recording without its room, and the room's answer, in turn.

use super::super::descend::{Deviations, Ending, Fitted, descend, deviations};
use super::super::error::StrikesError;
use super::super::whitening::Whitening;
use super::answer::Answer;

/// Number of rounds of answer and strikes in turn.
const ROUNDS: usize = 2;

/// Strikes and modes that a room is heard with, its answer, and the deviations of all numbers.
#[derive(Clone, Debug)]
pub(crate) struct InRoom {
    /// Fit of the sound without the answer.
    pub(crate) fitted: Fitted,
    pub(crate) deviations: Deviations,
    pub(crate) answer: Answer,
}

/// The fit of a recording in a room, from a first one whose room is still in the residual.
///
/// `complete` adds to a fit of the sound what it lacks, and drops what explains too little; it
/// gives the filter of the noise as well.
///
/// # Errors
/// Those of `complete`, and [`StrikesError::Untold`].
pub(crate) fn in_room(
    first: Fitted,
    samples: &[f64],
    rate_hz: f64,
    complete: impl Fn(Fitted, &[f64], usize) -> Result<(Fitted, Whitening), StrikesError>,
) -> Result<InRoom, StrikesError> {
    let none = Whitening::none();
    let mut model = first.model;
    let mut answer = Answer::none();
    for round in 0..ROUNDS {
        let heard = Fitted::new(model, samples, &none);
        answer = Answer::of(&heard, rate_hz);
        let dried = answer.taken_off(samples, &heard.model.strikes);
        let whitening = Whitening::of_residual(&Fitted::new(heard.model.clone(), &dried, &none).residual, ORDER);
        let fitted = descend(Fitted::new(heard.model, &dried, &whitening), &dried, &whitening, Ending::COMPLETION);
        model = complete(fitted, &dried, round)?.0.model;
    }
    let dried = answer.taken_off(samples, &model.strikes);
    let left = Fitted::new(model.clone(), &dried, &none);
    let whitening = Whitening::of_residual(&left.residual, ORDER);
    let mut fitted = descend(Fitted::new(model, &dried, &whitening), &dried, &whitening, Ending::COMPLETION);
    fitted.model.normalise();
    answer = Answer::of(&Fitted::new(fitted.model.clone(), samples, &none), rate_hz);
    let dried = answer.taken_off(samples, &fitted.model.strikes);
    let fitted = Fitted::new(fitted.model, &dried, &whitening);
    let deviations = deviations(&fitted, &whitening).ok_or(StrikesError::Untold)?;
    Ok(InRoom { fitted, deviations, answer })
}

/// Order of the whitening filter.
const ORDER: usize = 12;

#[cfg(test)]
mod tests {
    use super::super::super::estimate::{Estimate, estimate};
    use super::super::super::layout::Layout;
    use super::super::super::synthetic::{StruckOften, in_room, plain};
    use crate::modes::Settings;
    use crate::score::quantile;

    fn fitted(sound: &StruckOften) -> Estimate {
        estimate(&sound.samples, sound.rate_hz, Settings::default(), Layout::default(), |_| {})
            .expect("strikes are told")
    }

    #[test]
    fn strikes_and_modes_are_found_in_a_room_and_the_room_beside_them() {
        let sound = in_room(ROOM_SEED, 12.0, 20);
        let found = fitted(&sound);
        let near = |at_s: f64| found.strikes.iter().find(|strike| (strike.middle_s - at_s).abs() < 0.002);
        let pairs: Vec<_> = sound.strikes.iter().filter_map(|truth| Some((truth, near(truth.middle_s())?))).collect();
        assert!(pairs.len() >= 19 && found.strikes.len() <= pairs.len() + 3, "{} {}", pairs.len(), found.strikes.len());
        let contact_errors: Vec<f64> = pairs
            .iter()
            .map(|(truth, strike)| 100.0 * (strike.contact_time_s / truth.contact_time_s - 1.0).abs())
            .collect();
        let cents = |hz: f64| {
            let apart = found.modes.iter().map(|mode| 1200.0 * (mode.frequency_hz / hz).log2().abs());
            apart.fold(f64::INFINITY, f64::min)
        };
        let known = sound.modes.iter().filter(|mode| cents(mode.frequency_hz) < 3.0).count();
        let room = found.room.expect("a room is heard");
        let truth = sound.room.expect("a room answers");
        println!(
            "contact {:.2} %, modes {known} of {}, {} reported, T60 {:.3} of {:.3} s, level {:.1} of {:.1} dB",
            quantile(&contact_errors, 0.5),
            sound.modes.len(),
            found.modes.len(),
            room.t60_s,
            truth.t60_s,
            room.gain_db,
            truth.gain_db
        );
        assert!(quantile(&contact_errors, 0.5) < 0.4, "{contact_errors:?}");
        // Of 20, of which some are hardly heard in 12 s; 17 are reported.
        assert!(known >= 11 && found.modes.len() <= 20, "{known}");
        assert!((room.t60_s / truth.t60_s - 1.0).abs() < 0.08, "{room:?}, {truth:?}");
        assert!((room.gain_db - truth.gain_db).abs() < 3.6, "{room:?}, {truth:?}");
    }

    #[test]
    fn a_dry_recording_has_a_background_and_no_room() {
        let sound = plain(8, 6.0, 10, -60.0);
        let found = fitted(&sound);
        assert_eq!(found.room, None);
        // White noise has half of its power in the upper half of the spectrum.
        let upper = found.background.iter().find(|band| band.edges_hz[0] > 11_000.0).expect("22 kHz are heard");
        let share = (upper.edges_hz[1] - upper.edges_hz[0]) / (0.5 * sound.rate_hz);
        let expected = 20.0 * sound.noise_rms.log10() + 10.0 * share.log10();
        assert!((upper.level_dbfs - expected).abs() < 0.5, "{upper:?}, {expected}");
    }

    /// Seed of a set that was not used to build the fit.
    const ROOM_SEED: u64 = 21;
}
