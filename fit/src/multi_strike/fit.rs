//! The joint fit: from samples to modes, gains and contacts with their standard deviations.

use rayon::prelude::*;

use super::Layout;
use super::alignment::{aligned, alternatives};
use super::changes::changes;
use super::completion::{completed, worthy};
use super::descend::{Deviations, Ending, Fitted, descend, deviations};
use super::error::StrikesError;
use super::free::{Guard, free_modes};
use super::model::Model;
use super::places::starts_at_places;
use super::rises::rises;
use super::start::{White, changes_of, starts};
use super::strikers::assigned;
use super::whitening::Whitening;
use crate::modes::Settings;

/// Order of the whitening filter.
const ORDER: usize = 12;
/// Number of starting models whose contacts are aligned.
const ALIGNED: usize = 14;
/// Number of aligned models from which the descent begins.
const DESCENDED: usize = 3;
/// Ratio to the noise between strikes of what a model leaves from which no other start is tried.
const EXPLAINED: f64 = 1.1;
/// Energy in units of the noise by which a coarse descent may be worse than the best fit, and still
/// be continued.
const FAR_OFF: f64 = 50.0;
/// Relative difference of what two starting models leave up to which they are one.
const SAME: f64 = 1e-6;
/// Maximum number of rounds of modes and strikes in turn.
const ROUNDS: usize = 4;
/// Time in seconds by which no strike moves in a round that ends them.
const SETTLED_S: f64 = 0.0025;
/// Maximum number of passes that look for what the model lacks.
const COMPLETIONS: usize = 5;
/// Maximum number of times that modes and strikes are dropped in a pass.
const PRUNINGS: usize = 6;
/// Number of passes in a row that change no number of modes and strikes, and end them.
const MOST_STALLED: usize = 2;
/// Share of the recording's energy that is left from which nothing is explained: -6 dB.
const UNEXPLAINED: f64 = 0.25;
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

/// Fits all strikes of a recording together.
///
/// # Errors
/// [`StrikesError`] if there are too few strikes, or if they cannot be told apart.
pub(crate) fn fit(samples: &[f64], rate_hz: f64, settings: Settings, layout: Layout) -> Result<JointFit, StrikesError> {
    let is_short = samples.len() < (SHORTEST_S * rate_hz) as usize;
    if is_short {
        return Err(StrikesError::TooShort { seconds: samples.len() as f64 / rate_hz });
    }
    let onsets = rises(samples, rate_hz);
    let few = Settings { most_modes: settings.most_modes.min(FIRST_MODES), ..settings };
    let free = free_modes(samples, &onsets, Guard::OF_RISE, rate_hz, few, &[])
        .ok_or(StrikesError::TooFew { found: onsets.len() })?;
    let (mut free, mut onsets) = (free, onsets);
    for _ in 0..ROUNDS {
        let changed: Vec<usize> =
            changes(&filtered(samples, &free.whitening), &free.poles, rate_hz, free.white_variance)
                .into_iter()
                .map(|change| change.0)
                .collect();
        let is_settled = changed.len() == onsets.len()
            && changed.iter().zip(&onsets).all(|(a, b)| (a.abs_diff(*b) as f64) < SETTLED_S * rate_hz);
        onsets = changed;
        if is_settled {
            break;
        }
        free = free_modes(samples, &onsets, Guard::OF_CHANGE, rate_hz, settings, &free.poles)
            .filter(|free| !free.poles.is_empty())
            .ok_or(StrikesError::NoModes)?;
    }
    if onsets.len() < LEAST_STRIKES {
        return Err(StrikesError::TooFew { found: onsets.len() });
    }
    let whole = filtered(samples, &free.whitening);
    let white = White { samples: &whole, whitening: &free.whitening, variance: free.white_variance };
    let starts = if layout == Layout::default() {
        starts(&white, &onsets, &free.poles, rate_hz)
    } else {
        let changes = changes_of(&white, &onsets, &free.poles, rate_hz);
        starts_at_places(&changes, &free.poles, rate_hz, layout)
    };
    let mut aligned: Vec<(f64, Model)> =
        starts.par_iter().take(ALIGNED).map(|start| aligned(start, samples, rate_hz)).collect();
    aligned.sort_by(|a, b| a.0.total_cmp(&b.0));
    // Trials that ended in one model.
    aligned.dedup_by(|a, b| (a.0 / b.0 - 1.0).abs() < SAME);
    let none = Whitening::none();
    let mut best: Option<Fitted> = None;
    for (_, start) in aligned.into_iter().take(DESCENDED) {
        let done = descend(Fitted::new(start, samples, &none), samples, &none, Ending::COARSE);
        let is_good = done.noise_rms().powi(2) < EXPLAINED * free.variance;
        if best.as_ref().is_none_or(|best| done.energy < best.energy) {
            best = Some(done);
        }
        if is_good {
            break;
        }
    }
    let best = best.ok_or(StrikesError::TooFew { found: 0 })?;
    let (mut fitted, mut whitening) = (at_best_time(best, samples, &none), none);
    let mut stalled = 0;
    for _ in 0..COMPLETIONS {
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
            fitted = descend(Fitted::new(kept, samples, &whitening), samples, &whitening, Ending::COMPLETION);
        }
        let is_stalled = before == (fitted.model.poles.len(), fitted.model.strikes.len());
        stalled = if is_stalled { stalled + 1 } else { 0 };
        if is_complete || stalled == MOST_STALLED {
            break;
        }
    }
    if fitted.model.strikes.len() < LEAST_STRIKES {
        return Err(StrikesError::TooFew { found: fitted.model.strikes.len() });
    }
    let energy = |sound: &[f64]| sound.iter().map(|x| x * x).sum::<f64>();
    let left = energy(&fitted.residual) / energy(samples);
    if left > UNEXPLAINED {
        return Err(StrikesError::Unexplained { left_db: 10.0 * left.log10() });
    }
    fitted = descend(fitted, samples, &whitening, Ending::FINE);
    fitted = at_best_time(fitted, samples, &whitening);
    fitted = with_acceleration(fitted, samples, &whitening);
    fitted.model.normalise();
    let deviations = deviations(&fitted, &whitening).ok_or(StrikesError::Untold)?;
    Ok(JointFit { fitted, deviations })
}

fn filtered(samples: &[f64], whitening: &Whitening) -> Vec<f64> {
    whitening.filtered(samples, 0..samples.len())
}

/// The fit with strikers told apart by its contacts, and with their own modes.
fn with_strikers(fitted: Fitted, samples: &[f64], whitening: &Whitening, rate_hz: f64, layout: Layout) -> Fitted {
    if layout.strikers < 2 {
        return fitted;
    }
    let model = &fitted.model;
    let onsets: Vec<usize> =
        model.strikes.iter().map(|strike| strike.contact.first_sample().max(0.0) as usize).collect();
    let whole = filtered(samples, whitening);
    let white = White { samples: &whole, whitening, variance: fitted.noise_rms().powi(2) };
    let changes = changes_of(&white, &onsets, &model.poles, rate_hz);
    let next = assigned(model, &changes, layout.strikers, layout.positions, rate_hz);
    if next == *model { fitted } else { Fitted::new(next, samples, whitening) }
}

/// The best of a fit and of those with all contacts at another time.
fn at_best_time(fitted: Fitted, samples: &[f64], whitening: &Whitening) -> Fitted {
    let mut best = fitted;
    for other in alternatives(&best.model, &best.residual) {
        let other = descend(Fitted::new(other, samples, whitening), samples, whitening, Ending::COARSE);
        if other.energy > best.energy + FAR_OFF * best.noise_rms().powi(2) {
            continue;
        }
        let other = descend(other, samples, whitening, Ending::FINE);
        if other.energy < best.energy {
            best = other;
        }
    }
    best
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
        let joint =
            fit(&sound.samples, sound.rate_hz, Settings::default(), Layout::default()).expect("strikes are told");
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
            pool.install(|| fit(&sound.samples, sound.rate_hz, Settings::default(), Layout::default()))
        };
        let (one, two) = (on(1).expect("strikes are told"), on(2).expect("strikes are told"));
        assert_eq!(one.fitted.model, two.fitted.model);
        assert_eq!(one.fitted.energy.to_bits(), two.fitted.energy.to_bits());
    }

    #[test]
    fn noise_and_a_single_strike_are_refused_by_name() {
        let mut random = crate::random::SplitMix64(4);
        let noise: Vec<f64> = (0..44_100).map(|_| 1e-3 * random.normal()).collect();
        let refused = fit(&noise, 44_100.0, Settings::default(), Layout::default());
        assert!(matches!(refused, Err(StrikesError::TooFew { .. } | StrikesError::NoModes)), "{refused:?}");
        let once = plain(8, 1.5, 1, -60.0);
        let refused = fit(&once.samples, once.rate_hz, Settings::default(), Layout::default());
        assert!(matches!(refused, Err(StrikesError::TooFew { .. } | StrikesError::NoModes)), "{refused:?}");
        let refused = fit(&noise[..100], 44_100.0, Settings::default(), Layout::default());
        assert!(matches!(refused, Err(StrikesError::TooShort { .. })), "{refused:?}");
    }
}
