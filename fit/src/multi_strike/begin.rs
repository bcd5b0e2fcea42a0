//! The first fit: from starting models of the contacts to the one that explains most.

use rayon::prelude::*;

use super::alignment::{aligned, alternatives};
use super::amplitudes::{Told, White, changes_of};
use super::contact::Contact;
use super::descend::{Ending, Fitted, descend};
use super::error::StrikesError;
use super::free::FreeModes;
use super::heard::{contradicts_sound, heard_times, with_held_times};
use super::layout::Layout;
use super::model::Model;
use super::places::starts_at_places;
use super::start::{StartSearch, starts};
use super::whitening::Whitening;

/// Number of aligned models from which the descent begins.
const DESCENDED: usize = 3;
/// Ratio to the noise between strikes of what a model leaves of the recording up to which it is
/// explained.
const EXPLAINED: f64 = 1.1;
/// Ratio to that noise of what a model leaves within the contacts up to which they are explained.
///
/// The ringing behind contacts is nearly the same for other contact times with other gains, and a
/// recording has far more samples of it.
const CONTACTS_EXPLAINED: f64 = 2.0;
/// Ratio to the noise between strikes of what a model leaves up to which no other start is made in
/// a room.
const POOR: f64 = 4.0;
/// Number of starts, each from the gains of another strike.
const STARTS: usize = 3;
/// Relative difference of what two starting models leave up to which they are one.
const SAME: f64 = 1e-6;
/// Ratio of the contact times of two models' strongest strikes up to which the models are one, if
/// their middles are near as well.
const APART: f64 = 1.1;
/// Distance in samples of these middles up to which they are near. Nearer times are tried behind
/// the descent.
const APART_SAMPLES: f64 = 4.0;
/// Distance in samples up to which two descents ended at one common time.
const ONE_TIME: f64 = 0.05;
/// Largest energy over that of the best fit, in units of the noise, at which a coarse descent is
/// continued.
const FAR_OFF: f64 = 50.0;

/// First fit, from the start that explains most.
///
/// If the contacts of a start leave more than noise, the next one begins with the gains of another
/// strike. If the contact times are far longer than those heard, the latter are held.
pub(super) fn begun(
    samples: &[f64],
    free: &FreeModes,
    onsets: &[usize],
    rate_hz: f64,
    layout: Layout,
    search: StartSearch,
    told: &dyn Fn(f64),
) -> Result<Fitted, StrikesError> {
    let mut best: Option<Fitted> = None;
    for attempt in 0..STARTS {
        let told = |share: f64| told((attempt as f64 + share) / STARTS as f64);
        let starts = started(samples, free, onsets, rate_hz, (layout, attempt), search);
        told(0.2);
        let Some(next) = nearest(&starts, samples, free.variance, rate_hz, search, &told) else { break };
        if best.as_ref().is_none_or(|best| next.energy < best.energy) {
            best = Some(next);
        }
        let is_enough = |best: &Fitted| explains(best, free.variance, POOR, search);
        if best.as_ref().is_some_and(is_enough) {
            break;
        }
    }
    let best = best.ok_or(StrikesError::TooFew { found: 0 })?;
    let is_explained = best.noise_rms().powi(2) < EXPLAINED * free.variance;
    if is_explained || layout != Layout::default() || !contradicts_sound(&best.model, samples, rate_hz) {
        return Ok(at_best_time(best, samples, &Whitening::none()).fitted);
    }
    let starts = started(samples, free, onsets, rate_hz, (layout, 0), search);
    // Times are heard alike near the beginnings of all starts.
    let heard = apart(&starts, samples, rate_hz, search)
        .into_iter()
        .next()
        .and_then(|start| heard_times(&start, samples, rate_hz));
    let held: Vec<Model> =
        heard.iter().flat_map(|times| starts.iter().map(|start| with_held_times(start, times))).collect();
    let held = nearest(&held, samples, free.variance, rate_hz, search, &|_| {}).unwrap_or(best);
    Ok(at_best_time(held, samples, &Whitening::none()).fitted)
}

/// Models of the contacts that explain the changes of amplitudes best.
///
/// The gains are at first those of the strongest strike, or in later attempts of the next strong
/// ones. Empty if there is no such strike.
fn started(
    samples: &[f64],
    free: &FreeModes,
    onsets: &[usize],
    rate_hz: f64,
    (layout, attempt): (Layout, usize),
    search: StartSearch,
) -> Vec<Model> {
    let whole = free.whitening.filtered(samples, 0..samples.len());
    let white = White { samples: &whole, whitening: &free.whitening, variance: free.white_variance };
    if layout == Layout::default() {
        return starts(&white, onsets, &free.poles, rate_hz, (attempt, search));
    }
    let changes = changes_of(&white, onsets, &free.poles, rate_hz, Told::Together);
    starts_at_places(&changes, &free.poles, rate_hz, layout, attempt)
}

/// The best descent of starting models; `None` if there are none.
fn nearest(
    starts: &[Model],
    samples: &[f64],
    variance: f64,
    rate_hz: f64,
    search: StartSearch,
    told: &dyn Fn(f64),
) -> Option<Fitted> {
    let starts = apart(starts, samples, rate_hz, search);
    told(0.4);
    let none = Whitening::none();
    let mut best: Option<Fitted> = None;
    for (index, start) in starts.into_iter().take(DESCENDED).enumerate() {
        let ending = if start.places() > 1 { Ending::COARSE_AT_PLACES } else { Ending::COARSE };
        let done = descend(Fitted::new(start, samples, &none), samples, &none, ending);
        let is_good = explains(&done, variance, EXPLAINED, search);
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

/// Aligned starting models, the one that leaves least first, whose strongest contacts lie apart:
/// others descend to one model.
///
/// Models with positions differ in more than their contacts, and all are kept: without this,
/// `cargo bench -p fit --bench strikes -- 1 306 places` left 4 dB over the noise, and 0.4 dB where
/// one of two that leave the same was dropped.
fn apart(starts: &[Model], samples: &[f64], rate_hz: f64, search: StartSearch) -> Vec<Model> {
    let mut aligned: Vec<(f64, Model)> =
        starts.par_iter().take(search.aligned).map(|start| aligned(start, samples, rate_hz)).collect();
    aligned.sort_by(|a, b| a.0.total_cmp(&b.0));
    // Starts from different contact times may have ended in one model.
    aligned.dedup_by(|a, b| a.1.places() == 1 && (a.0 / b.0 - 1.0).abs() < SAME);
    let is_near = |a: Contact, b: Contact| {
        (a.time / b.time).ln().abs() < APART.ln() && (a.middle - b.middle).abs() < APART_SAMPLES
    };
    let mut kept: Vec<Model> = Vec::new();
    for (_, model) in aligned {
        let Some(contact) = strongest_contact(&model) else { continue };
        let is_known = kept.iter().filter_map(strongest_contact).any(|other| is_near(contact, other));
        if model.places() > 1 || !search.leaves_noise || !is_known {
            kept.push(model);
        }
    }
    kept
}

fn strongest_contact(model: &Model) -> Option<Contact> {
    model.strikes.get(model.strongest()).map(|strike| strike.contact)
}

/// True if a fit leaves little more than noise, within the contacts too.
///
/// In a room contacts leave reflections: there it may leave `most_in_room` times the noise.
fn explains(fitted: &Fitted, variance: f64, most_in_room: f64, search: StartSearch) -> bool {
    let left = fitted.noise_rms().powi(2) / variance;
    if search.leaves_noise {
        left < EXPLAINED && fitted.left_in_contacts() < CONTACTS_EXPLAINED * variance
    } else {
        left < most_in_room
    }
}

/// A fit with all contacts at the time that explains most.
pub(super) struct AtBestTime {
    pub(super) fitted: Fitted,
    /// Variance of the common time in samples squared, by times that explain nearly as much.
    ///
    /// Of two times half a sample apart the noise often decides which explains more, and the
    /// deviation about either is far shorter than the way between them.
    pub(super) time_variance: f64,
}

/// The best of a fit and of those with all contacts at another time.
pub(super) fn at_best_time(fitted: Fitted, samples: &[f64], whitening: &Whitening) -> AtBestTime {
    let time = |fitted: &Fitted| strongest_contact(&fitted.model).map_or(0.0, |contact| contact.middle);
    let mut best = fitted;
    let mut minima = vec![(best.energy, time(&best))];
    for other in alternatives(&best.model, &best.residual) {
        let other = descend(Fitted::new(other, samples, whitening), samples, whitening, Ending::COARSE);
        if other.energy > best.energy + FAR_OFF * best.noise_rms().powi(2) {
            continue;
        }
        let other = descend(other, samples, whitening, Ending::FINE);
        if minima.iter().all(|(_, known)| (known - time(&other)).abs() > ONE_TIME) {
            minima.push((other.energy, time(&other)));
        }
        if other.energy < best.energy {
            best = other;
        }
    }
    // Likelihoods relative to the best.
    let weight = |energy: f64| (0.5 * (best.energy - energy) / best.noise_rms().powi(2)).exp();
    let middle = time(&best);
    let weights: f64 = minima.iter().map(|(energy, _)| weight(*energy)).sum();
    let squares: f64 = minima.iter().map(|(energy, time)| weight(*energy) * (time - middle).powi(2)).sum();
    AtBestTime { time_variance: squares / weights, fitted: best }
}
