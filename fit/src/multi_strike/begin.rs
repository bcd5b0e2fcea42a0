//! The first fit: from starting models of the contacts to the one that explains most.

use super::alignment::{aligned, alternatives};
use super::amplitudes::{Told, White, changes_of};
use super::descend::{Ending, Fitted, descend};
use super::error::StrikesError;
use super::free::FreeModes;
use super::heard::{contradicts_sound, with_heard_times};
use super::layout::Layout;
use super::model::Model;
use super::places::starts_at_places;
use super::start::starts;
use super::whitening::Whitening;

/// Number of starting models whose contacts are aligned.
const ALIGNED: usize = 14;
/// Number of aligned models from which the descent begins.
const DESCENDED: usize = 3;
/// Ratio to the noise between strikes of what a model leaves from which no other model is tried.
const EXPLAINED: f64 = 1.1;
/// Ratio to the noise between strikes of what a model leaves up to which no other start is made.
const POOR: f64 = 4.0;
/// Number of starts, each from the gains of another strike.
const STARTS: usize = 3;
/// Relative difference of what two starting models leave up to which they are one.
const SAME: f64 = 1e-6;
/// Largest energy over that of the best fit, in units of the noise, at which a coarse descent is
/// continued.
const FAR_OFF: f64 = 50.0;

/// First fit, from the start that explains most.
///
/// If the contacts of a start explain the recording poorly, the next one begins with the gains of
/// another strike. If the contact times are far longer than those heard, the latter are held.
pub(super) fn begun(
    samples: &[f64],
    free: &FreeModes,
    (onsets, usable): (&[usize], &[usize]),
    rate_hz: f64,
    layout: Layout,
    told: &dyn Fn(f64),
) -> Result<Fitted, StrikesError> {
    let mut best: Option<Fitted> = None;
    for attempt in 0..STARTS {
        let told = |share: f64| told((attempt as f64 + share) / STARTS as f64);
        let starts = started(samples, free, (onsets, usable), rate_hz, (layout, attempt));
        told(0.2);
        let Some(next) = nearest(&starts, samples, free.variance, rate_hz, &told) else { break };
        if best.as_ref().is_none_or(|best| next.energy < best.energy) {
            best = Some(next);
        }
        let is_fair = |best: &Fitted| best.noise_rms().powi(2) < POOR * free.variance;
        if best.as_ref().is_some_and(is_fair) {
            break;
        }
    }
    let best = best.ok_or(StrikesError::TooFew { found: 0 })?;
    let is_explained = best.noise_rms().powi(2) < EXPLAINED * free.variance;
    if is_explained || layout != Layout::default() || !contradicts_sound(&best.model, samples, rate_hz) {
        return Ok(at_best_time(best, samples, &Whitening::none()));
    }
    let starts = started(samples, free, (onsets, usable), rate_hz, (layout, 0));
    let held: Vec<Model> = starts.iter().filter_map(|start| with_heard_times(start, samples, rate_hz)).collect();
    let held = nearest(&held, samples, free.variance, rate_hz, &|_| {}).unwrap_or(best);
    Ok(at_best_time(held, samples, &Whitening::none()))
}

/// Models of the contacts of the usable strikes that explain the changes of amplitudes best.
///
/// The gains are at first those of the strongest strike, or in later attempts of the next strong
/// ones. Empty if there is no such strike.
fn started(
    samples: &[f64],
    free: &FreeModes,
    (onsets, usable): (&[usize], &[usize]),
    rate_hz: f64,
    (layout, attempt): (Layout, usize),
) -> Vec<Model> {
    let whole = free.whitening.filtered(samples, 0..samples.len());
    let white = White { samples: &whole, whitening: &free.whitening, variance: free.white_variance };
    if layout == Layout::default() {
        return starts(&white, (onsets, usable), &free.poles, rate_hz, attempt);
    }
    let mut changes = changes_of(&white, onsets, &free.poles, rate_hz, Told::Together);
    changes.retain(|change| usable.contains(&change.at));
    starts_at_places(&changes, &free.poles, rate_hz, layout, attempt)
}

/// The best descent of starting models; `None` if there are none.
fn nearest(starts: &[Model], samples: &[f64], variance: f64, rate_hz: f64, told: &dyn Fn(f64)) -> Option<Fitted> {
    // One at a time: each takes as much memory as the recording.
    let mut aligned: Vec<(f64, Model)> =
        starts.iter().take(ALIGNED).map(|start| aligned(start, samples, rate_hz)).collect();
    aligned.sort_by(|a, b| a.0.total_cmp(&b.0));
    // Trials that ended in one model.
    aligned.dedup_by(|a, b| (a.0 / b.0 - 1.0).abs() < SAME);
    told(0.4);
    let none = Whitening::none();
    let mut best: Option<Fitted> = None;
    for (index, (_, start)) in aligned.into_iter().take(DESCENDED).enumerate() {
        let done = descend(Fitted::new(start, samples, &none), samples, &none, Ending::COARSE);
        let is_good = done.noise_rms().powi(2) < EXPLAINED * variance;
        if best.as_ref().is_none_or(|best| done.energy < best.energy) {
            best = Some(done);
        }
        told(0.4 + 0.15 * (index as f64 + 1.0));
        if is_good {
            break;
        }
    }
    best
}

/// The best of a fit and of those with all contacts at another time.
pub(super) fn at_best_time(fitted: Fitted, samples: &[f64], whitening: &Whitening) -> Fitted {
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
