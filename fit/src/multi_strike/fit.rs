//! The joint fit: from samples to modes, gains and contacts with their standard deviations.

use std::borrow::Cow;

use super::begin::{AtBestTime, at_best_time, begun};
use super::descend::{Deviations, Ending, Fitted, descend, deviations};
use super::dry::dry;
use super::error::StrikesError;
use super::free::{FreeModes, Guard, MORE_MODES, free_modes};
use super::heard::{log_deviation, with_heard_peaks};
use super::in_room::{InRoom, energy, in_room};
use super::layout::Layout;
use super::rises::rises;
use super::start::StartSearch;
use super::whitening::Whitening;
use super::zeros::modes_at_zeros;
use crate::modes::Settings;
use crate::room::Room;

/// Share of the recording's energy that is left from which nothing is explained: -6 dB.
const UNEXPLAINED: f64 = 0.25;
/// Least length of a recording in seconds.
const SHORTEST_S: f64 = 0.2;
/// Maximum number of modes with which strikes are looked for.
const FIRST_MODES: usize = 16;

/// Ratio of the power that modes leave between strikes to that of its innovation from which a room
/// may have coloured it: 5 dB. Clips of 12 s in rooms have 5.2 dB or more.
const COLOURED: f64 = 3.2;
/// Share of the recording's energy that modes at zeros must carry for the others to be fitted anew
/// without them: -20 dB.
const HEARD_AT_ZEROS: f64 = 0.01;

/// A fitted recording with the bounds of its numbers.
#[derive(Clone, Debug)]
pub(crate) struct JointFit {
    pub(crate) fitted: Fitted,
    pub(crate) deviations: Deviations,
    /// Room, if one is heard.
    pub(crate) room: Option<Room>,
}

/// Fits all strikes of a recording together; `told` gets the share of the work that is done.
///
/// # Errors
/// [`StrikesError`] if there are too few strikes, or too many, if they cannot be told apart, or if
/// one thing and its strikes explain too little.
pub(crate) fn fit(
    samples: &[f64],
    rate_hz: f64,
    settings: Settings,
    layout: Layout,
    told: &dyn Fn(f64),
) -> Result<JointFit, StrikesError> {
    let seconds = samples.len() as f64 / rate_hz;
    let is_short = samples.len() < (SHORTEST_S * rate_hz) as usize;
    if is_short {
        return Err(StrikesError::TooShort { seconds });
    }
    let onsets = rises(samples, rate_hz);
    let rising = onsets.len();
    let modes = |most: usize| {
        let few = Settings { most_modes: settings.most_modes.min(most), ..settings };
        let modes = |guard: Guard| free_modes(samples, &onsets, guard, rate_hz, few, &[]);
        let guard = Guard::OF_RISE.of_layout(layout);
        let found = modes(guard)?;
        let is_found = layout == Layout::default() || !found.poles.is_empty();
        if is_found { Some(found) } else { modes(guard.with_short_stretches()) }
    };
    let mut free = modes(FIRST_MODES).ok_or(StrikesError::TooFew { found: onsets.len() })?;
    let is_coloured = |free: &FreeModes| free.variance > COLOURED * free.white_variance;
    // The fast strikes of a roll are no echoes.
    let is_roll = StrikesError::refuse_too_many(rising, seconds).is_err();
    let is_one_place = layout == Layout::default() && !is_roll;
    if is_one_place && is_coloured(&free) {
        // Modes that are missing colour the residual as a room does.
        free = modes(MORE_MODES).unwrap_or(free);
    }
    let may_have_room = is_one_place && is_coloured(&free);
    let found = thing(samples, (onsets, free), may_have_room, rate_hz, settings, layout, told)?;
    let Thing { mut fitted, whitening, dry: sound, room } = found;
    let samples = &*sound;
    StrikesError::refuse_few(fitted.model.strikes.len(), rising)?;
    StrikesError::refuse_few_for(layout, fitted.model.strikes.len())?;
    StrikesError::refuse_unexplained(&fitted.residual, samples, UNEXPLAINED)?;
    fitted = descend(fitted, samples, &whitening, Ending::FINE);
    told(0.9);
    let AtBestTime { mut fitted, time_variance } = at_best_time(fitted, samples, &whitening);
    told(0.95);
    if room.is_none() {
        fitted = with_acceleration(fitted, samples, &whitening);
    }
    fitted = without_zeros(fitted, samples, &whitening);
    if fitted.model.contact_times_are_held {
        fitted = with_heard_peaks(fitted, samples, &whitening, rate_hz);
    }
    // The steps since the first check may have made the fit worse.
    StrikesError::refuse_unexplained(&fitted.residual, samples, UNEXPLAINED)?;
    fitted.model.normalise();
    let mut deviations = deviations(&fitted, &whitening).ok_or(StrikesError::Untold)?;
    deviations.strikes.iter_mut().for_each(|covariance| covariance[(0, 0)] += time_variance);
    if fitted.model.contact_times_are_held {
        for (index, covariance) in deviations.strikes.iter_mut().enumerate() {
            let heard = log_deviation(&fitted.model, index, samples, rate_hz).ok_or(StrikesError::Untold)?;
            covariance[(1, 1)] = heard * heard;
        }
    }
    told(1.0);
    Ok(JointFit { fitted, deviations, room })
}

/// Thing whose strikes are fitted, and the filter of its noise.
struct Thing<'a> {
    fitted: Fitted,
    whitening: Whitening,
    /// Recording without the room's sound.
    dry: Cow<'a, [f64]>,
    /// Room, if one is heard.
    room: Option<Room>,
}

/// Fit of the thing, in a room if it may have one and if one is heard.
///
/// It begins with moments near which strikes begin, and modes between strikes. `told` gets up to
/// 0.85.
fn thing<'a>(
    samples: &'a [f64],
    (onsets, free): (Vec<usize>, FreeModes),
    may_have_room: bool,
    rate_hz: f64,
    settings: Settings,
    layout: Layout,
    told: &dyn Fn(f64),
) -> Result<Thing<'a>, StrikesError> {
    let wet = |InRoom { fitted, whitening, dry, room, .. }| Thing { fitted, whitening, dry: Cow::Owned(dry), room };
    let begun_in_room = || {
        let first =
            begun(samples, &free, &onsets, rate_hz, layout, StartSearch::IN_ROOM, &|share| told(0.2 * share)).ok()?;
        in_room(first, samples, rate_hz, settings, &|share| told(0.2 + 0.65 * share))
    };
    if let Some(found) = may_have_room.then(begun_in_room).flatten() {
        return Ok(wet(found));
    }
    let [from, to] = if may_have_room { [0.25, 0.5] } else { [0.0, 0.85] };
    let told_dry = |share: f64| told(from + (to - from) * share);
    let (fitted, whitening) = dry(samples, (onsets, free), rate_hz, settings, (layout, StartSearch::DRY), &told_dry)?;
    // A room that a poor start hides is heard behind a whole fit.
    if may_have_room && energy(&fitted.residual) > COLOURED * fitted.energy {
        let told = |share: f64| told(to + (0.85 - to) * share);
        if let Some(found) = in_room(fitted.clone(), samples, rate_hz, settings, &told) {
            return Ok(wet(found));
        }
    }
    Ok(Thing { fitted, whitening, dry: Cow::Borrowed(samples), room: None })
}

/// The fit without modes at zeros of all contacts.
///
/// All else stays as it is if those modes are quiet, because other modes would bend to make up for
/// them. If they are loud, it is fitted anew: a fit of strikes on a hammer's wooden holder had all
/// its contacts' zeros at one mode that carried a third of the energy.
fn without_zeros(fitted: Fitted, samples: &[f64], whitening: &Whitening) -> Fitted {
    let at_zeros = modes_at_zeros(&fitted.model);
    if at_zeros.is_empty() {
        return fitted;
    }
    let mut model = fitted.model;
    model.drop_modes(&at_zeros);
    let without = Fitted::new(model, samples, whitening);
    let carried = energy(&without.residual) - energy(&fitted.residual);
    if carried > HEARD_AT_ZEROS * energy(samples) {
        descend(without, samples, whitening, Ending::FINE)
    } else {
        without
    }
}

/// The fit with acceleration sound, if that explains more than its number costs.
///
/// In a room the first reflections look like acceleration sound, and a common time with it.
fn with_acceleration(fitted: Fitted, samples: &[f64], whitening: &Whitening) -> Fitted {
    let mut model = fitted.model.clone();
    model.acceleration = 1e-9 * model.gains.iter().flatten().map(|gain| gain.norm()).fold(f64::MIN_POSITIVE, f64::max);
    let more = descend(Fitted::new(model, samples, whitening), samples, whitening, Ending::FINE);
    let least = (samples.len() as f64).ln() * fitted.noise_rms().powi(2);
    if fitted.energy - more.energy > least { more } else { fitted }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::multi_strike::synthetic::plain;
    use crate::multi_strike::truth::model_of;

    #[test]
    fn a_set_of_known_strikes_is_found_whole_and_to_the_noise() {
        let sound = plain(8, 6.0, 10, -60.0);
        let truth = model_of(&sound);
        let joint = fit(&sound.samples, sound.rate_hz, Settings::default(), Layout::default(), &|_| {})
            .expect("strikes are told");
        let model = &joint.fitted.model;
        assert_eq!((model.strikes.len(), model.acceleration), (10, 0.0));
        assert!(model.poles.len() <= truth.poles.len() && model.poles.len() + 1 >= truth.poles.len());
        assert!((joint.fitted.noise_rms() / sound.noise_rms - 1.0).abs() < 0.01, "{}", joint.fitted.noise_rms());
        for (found, truth) in model.strikes.iter().zip(&truth.strikes) {
            let (found, truth) = (found.contact, truth.contact);
            assert!((found.middle - truth.middle).abs() < 0.2, "{found:?} {truth:?}");
            assert!((found.time / truth.time - 1.0).abs() < 0.02, "{found:?} {truth:?}");
            assert!((found.peak / truth.peak - 1.0).abs() < 0.02, "{found:?} {truth:?}");
        }
    }

    #[test]
    fn a_fit_has_the_same_bits_on_one_thread_and_on_two() {
        let sound = plain(8, 3.0, 5, -60.0);
        let on = |threads: usize| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads start");
            pool.install(|| fit(&sound.samples, sound.rate_hz, Settings::default(), Layout::default(), &|_| {}))
        };
        let (one, two) = (on(1).expect("strikes are told"), on(2).expect("strikes are told"));
        assert_eq!(one.fitted.model, two.fitted.model);
        assert_eq!(one.fitted.energy.to_bits(), two.fitted.energy.to_bits());
    }

    #[test]
    fn positions_and_strikers_that_so_few_strikes_cannot_tell_are_refused_by_name() {
        let sound = plain(8, 1.5, 3, -60.0);
        for (positions, strikers, needed) in [(16, 1, 17), (4, 2, 5), (1, 2, 4), (1, 4, 8)] {
            let layout = Layout { positions, strikers };
            let refused = fit(&sound.samples, sound.rate_hz, Settings::default(), layout, &|_| {}).err();
            let expected = StrikesError::TooFewForLayout { found: 3, needed, positions, strikers };
            assert_eq!(refused, Some(expected));
        }
    }

    #[test]
    fn noise_and_a_single_strike_are_refused_by_name() {
        let mut random = crate::random::SplitMix64(4);
        let noise: Vec<f64> = (0..44_100).map(|_| 1e-3 * random.normal()).collect();
        let refused = fit(&noise, 44_100.0, Settings::default(), Layout::default(), &|_| {});
        assert!(matches!(refused, Err(StrikesError::TooFew { .. } | StrikesError::NoModes)), "{refused:?}");
        let once = plain(8, 1.5, 1, -60.0);
        let refused = fit(&once.samples, once.rate_hz, Settings::default(), Layout::default(), &|_| {});
        assert!(matches!(refused, Err(StrikesError::TooFew { .. } | StrikesError::NoModes)), "{refused:?}");
        let refused = fit(&noise[..100], 44_100.0, Settings::default(), Layout::default(), &|_| {});
        assert!(matches!(refused, Err(StrikesError::TooShort { .. })), "{refused:?}");
    }
}
