//! The joint fit: from samples to modes, gains and contacts with their standard deviations.

use super::amplitudes::{Told, White, changes_of};
use super::begin::{at_best_time, begun};
use super::changes::changes;
use super::completion::{completed, worthy};
use super::descend::{Deviations, Ending, Fitted, descend, deviations};
use super::equations::energy;
use super::error::StrikesError;
use super::free::{FreeModes, Guard, free_modes};
use super::heard::{log_deviation, with_heard_peaks};
use super::layout::Layout;
use super::rises::rises;
use super::strikers::assigned;
use super::whitening::Whitening;
use crate::modes::Settings;

/// Order of the whitening filter.
const ORDER: usize = 12;
/// Maximum number of rounds of modes and strikes in turn.
const ROUNDS: usize = 4;
/// Time in seconds by which no strike moves in a round that ends them.
const SETTLED_S: f64 = 0.0025;
/// Maximum number of passes that look for what the model lacks.
const COMPLETIONS: usize = 5;
/// Maximum number of times that modes and strikes are dropped in a pass.
const PRUNINGS: usize = 6;
/// Ratio by which dropped parts may let what is left grow; they are kept where it grows more.
///
/// Worth is judged as if the energy about a fit were a parabola.
const MOST_GROWN: f64 = 2.0;
/// Number of passes in a row that change no number of modes and strikes, and end them.
const MOST_STALLED: usize = 2;
/// Share of the recording's energy that is left from which nothing is explained: -6 dB.
const UNEXPLAINED: f64 = 0.25;
/// Share of the energy that the first fit leaves from which no completion helps: -0.5 dB.
const UNEXPLAINED_AT_FIRST: f64 = 0.89;
/// Number of rises of the sound from which on too few strikes are not for want of strikes.
const MANY_RISES: usize = 5;
/// Maximum number of strikes a second, in the mean of a recording.
const MOST_PER_S: f64 = 9.0;
/// Least number of strikes that are fitted together.
pub(crate) const LEAST_STRIKES: usize = 2;
/// Least length of a recording in seconds.
const SHORTEST_S: f64 = 0.2;
/// Maximum number of modes with which strikes are looked for.
const FIRST_MODES: usize = 16;

/// A fitted recording with the bounds of its numbers.
#[derive(Clone, Debug)]
pub(crate) struct JointFit {
    pub(crate) fitted: Fitted,
    pub(crate) deviations: Deviations,
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
    let is_short = samples.len() < (SHORTEST_S * rate_hz) as usize;
    if is_short {
        return Err(StrikesError::TooShort { seconds: samples.len() as f64 / rate_hz });
    }
    let (free, all) = between_strikes(samples, rate_hz, settings, &|share| told(0.25 * share))?;
    let largest = samples.iter().fold(0.0, |most: f64, x| most.max(x.abs()));
    // Clipped strikes tell no contacts; what they ring is found in what the others leave.
    let clipped = |onset: usize| is_clipped(samples, onset, rate_hz, largest);
    let sound: Vec<usize> = all.iter().copied().filter(|onset| !clipped(*onset)).collect();
    let usable = if sound.len() < LEAST_STRIKES { &all } else { &sound };
    let first = begun(samples, &free, (&all, usable), rate_hz, layout, &|share| told(0.25 + 0.25 * share))?;
    if usable.len() == all.len() {
        refuse_unexplained(&first, samples, UNEXPLAINED_AT_FIRST)?;
    }
    let (mut fitted, whitening) =
        with_all(first, samples, rate_hz, settings, layout, &|share| told(0.5 + 0.35 * share))?;
    let found = fitted.model.strikes.len();
    if found < LEAST_STRIKES && all.len() > MANY_RISES {
        return Err(StrikesError::Unclear { found, rises: all.len() });
    }
    if found < LEAST_STRIKES {
        return Err(StrikesError::TooFew { found });
    }
    refuse_unexplained(&fitted, samples, UNEXPLAINED)?;
    fitted = descend(fitted, samples, &whitening, Ending::FINE);
    told(0.9);
    fitted = at_best_time(fitted, samples, &whitening);
    told(0.95);
    fitted = with_acceleration(fitted, samples, &whitening);
    if fitted.model.contact_times_are_held {
        fitted = with_heard_peaks(fitted, samples, &whitening, rate_hz);
    }
    fitted.model.normalise();
    let mut deviations = deviations(&fitted, &whitening).ok_or(StrikesError::Untold)?;
    if fitted.model.contact_times_are_held {
        for (index, covariance) in deviations.strikes.iter_mut().enumerate() {
            let heard = log_deviation(&fitted.model, index, samples, rate_hz).ok_or(StrikesError::Untold)?;
            covariance[(1, 1)] = heard * heard;
        }
    }
    told(1.0);
    Ok(JointFit { fitted, deviations })
}

/// Modes between strikes, and moments near which strikes begin, in turn.
fn between_strikes(
    samples: &[f64],
    rate_hz: f64,
    settings: Settings,
    told: &dyn Fn(f64),
) -> Result<(FreeModes, Vec<usize>), StrikesError> {
    let mut onsets = rises(samples, rate_hz);
    let rising = onsets.len();
    let few = Settings { most_modes: settings.most_modes.min(FIRST_MODES), ..settings };
    let mut free = free_modes(samples, &onsets, Guard::OF_RISE, rate_hz, few, &[])
        .ok_or(StrikesError::TooFew { found: onsets.len() })?;
    for round in 0..ROUNDS {
        told((round as f64 + 1.0) / (ROUNDS as f64 + 1.0));
        let white = free.whitening.filtered(samples, 0..samples.len());
        let changed: Vec<usize> =
            changes(&white, &free.poles, rate_hz, free.white_variance).into_iter().map(|change| change.0).collect();
        refuse_too_many(&changed, samples.len(), rate_hz)?;
        let is_settled = changed.len() == onsets.len()
            && changed.iter().zip(&onsets).all(|(a, b)| (a.abs_diff(*b) as f64) < SETTLED_S * rate_hz);
        onsets = changed;
        if is_settled {
            break;
        }
        let next = free_modes(samples, &onsets, Guard::OF_CHANGE, rate_hz, settings, &free.poles);
        match next.filter(|next| !next.poles.is_empty()) {
            Some(next) => free = next,
            None if free.poles.is_empty() => return Err(StrikesError::NoModes),
            // Strikes that are found anew may leave too little time between them: the modes stay.
            None => break,
        }
    }
    if onsets.len() < LEAST_STRIKES && rising > MANY_RISES {
        return Err(StrikesError::Unclear { found: onsets.len(), rises: rising });
    }
    if onsets.len() < LEAST_STRIKES {
        return Err(StrikesError::TooFew { found: onsets.len() });
    }
    Ok((free, onsets))
}

fn refuse_too_many(onsets: &[usize], length: usize, rate_hz: f64) -> Result<(), StrikesError> {
    let seconds = length as f64 / rate_hz;
    if onsets.len() as f64 > MOST_PER_S * seconds {
        return Err(StrikesError::TooMany { found: onsets.len(), seconds });
    }
    Ok(())
}

fn refuse_unexplained(fitted: &Fitted, samples: &[f64], most: f64) -> Result<(), StrikesError> {
    let energy = |sound: &[f64]| sound.iter().map(|x| x * x).sum::<f64>();
    let left = energy(&fitted.residual) / energy(samples);
    if left > most {
        return Err(StrikesError::Unexplained { left_db: 10.0 * left.log10() });
    }
    Ok(())
}

/// True if the sound stands still at its largest value near a moment at which a strike begins.
pub(crate) fn is_clipped(samples: &[f64], onset: usize, rate_hz: f64, largest: f64) -> bool {
    let [before, behind] = CLIPPED_S.map(|seconds| (seconds * rate_hz) as usize);
    let attack = &samples[onset.saturating_sub(before).min(samples.len())..(onset + behind).min(samples.len())];
    let stands = |three: &[f64]| three.iter().all(|x| *x == three[0] && x.abs() >= 0.999 * largest);
    attack.windows(3).any(stands)
}

/// Time in seconds before and behind a strike's beginning in which it may be clipped.
const CLIPPED_S: [f64; 2] = [0.003, 0.02];

/// The fit with what it lacks and without what explains too little, and the filter of its noise.
fn with_all(
    first: Fitted,
    samples: &[f64],
    rate_hz: f64,
    settings: Settings,
    layout: Layout,
    told: &dyn Fn(f64),
) -> Result<(Fitted, Whitening), StrikesError> {
    let (mut fitted, mut whitening) = (first, Whitening::none());
    let mut stalled = 0;
    for pass in 0..COMPLETIONS {
        let before = (fitted.model.poles.len(), fitted.model.strikes.len());
        whitening = Whitening::of_residual(&fitted.residual, ORDER);
        fitted = Fitted::new(fitted.model, samples, &whitening);
        fitted = with_strikers(fitted, samples, &whitening, rate_hz, layout);
        let more = completed(&fitted, samples, &whitening, rate_hz, settings);
        let is_complete = more == fitted.model;
        fitted = descend(Fitted::new(more, samples, &whitening), samples, &whitening, Ending::COMPLETION);
        for _ in 0..PRUNINGS {
            let fastest = settings.fastest_decay_per_s / rate_hz;
            let kept = worthy(&fitted, &whitening, fastest).ok_or(StrikesError::Untold)?;
            if kept == fitted.model {
                break;
            }
            let pruned = descend(Fitted::new(kept, samples, &whitening), samples, &whitening, Ending::COMPLETION);
            if pruned.energy > MOST_GROWN * fitted.energy {
                break;
            }
            fitted = pruned;
        }
        told((pass as f64 + 1.0) / COMPLETIONS as f64);
        let is_stalled = before == (fitted.model.poles.len(), fitted.model.strikes.len());
        stalled = if is_stalled { stalled + 1 } else { 0 };
        if is_complete || stalled == MOST_STALLED {
            break;
        }
    }
    Ok((fitted, whitening))
}

/// The fit with strikers told apart by its contacts, and with their own modes.
fn with_strikers(fitted: Fitted, samples: &[f64], whitening: &Whitening, rate_hz: f64, layout: Layout) -> Fitted {
    if layout.strikers < 2 {
        return fitted;
    }
    let model = &fitted.model;
    let onsets: Vec<usize> =
        model.strikes.iter().map(|strike| strike.contact.first_sample().max(0.0) as usize).collect();
    let whole = whitening.filtered(samples, 0..samples.len());
    let white = White { samples: &whole, whitening, variance: fitted.noise_rms().powi(2) };
    let changes = changes_of(&white, &onsets, &model.poles, rate_hz, Told::Together);
    let next = assigned(model, &changes, layout.strikers, layout.positions, rate_hz);
    if next == *model {
        return fitted;
    }
    let other = Fitted::new(next, samples, whitening);
    // Gains told by few strikes may be wrong by any factor.
    if other.energy < energy(samples, whitening) { other } else { fitted }
}

/// The fit with acceleration sound, if that explains more than its number costs.
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
