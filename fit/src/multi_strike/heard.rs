//! Contact times from the sound of each strike alone.
//!
//! Where a thing is struck a little elsewhere each time, its modes' amplitudes differ from strike
//! to strike, and a fit with one place takes that for other contact times: on an impact hammer's
//! strikes it ended at twelve times the measured one. The spectrum of each strike tells them to a
//! fifth ([`crate::contact`]), and they are held there. Peaks follow from the energy behind each
//! strike.

use super::amplitudes::{Told, White, changes_of};
use super::contact::{Contact, strength};
use super::descend::Fitted;
use super::model::{Model, Strike};
use super::whitening::Whitening;
use crate::contact::{PULSE_FWHM, contact_interval_s, contact_time_s};

/// Width at half maximum of a half-sine, as a share of its length.
const HALF_SINE_FWHM: f64 = 2.0 / 3.0;
/// Ratio of a contact time to the heard one from which it is far longer.
///
/// Heard ones are good to a fifth.
const FAR: f64 = 1.5;
/// Standard deviations on either side that an interval of 90 % holds.
const DEVIATIONS: f64 = 1.645;

/// True if more than half of a model's contact times are far longer than those that are heard.
pub(crate) fn contradicts_sound(model: &Model, samples: &[f64], rate_hz: f64) -> bool {
    let is_far = |index: &usize| {
        let heard = heard_time(model, *index, samples, rate_hz);
        heard.is_some_and(|heard| model.strikes[*index].contact.time > FAR * heard)
    };
    2 * (0..model.strikes.len()).filter(is_far).count() > model.strikes.len()
}

/// Contact time in samples of the half-sine that is as wide as a strike's contact is heard to be.
fn heard_time(model: &Model, index: usize, samples: &[f64], rate_hz: f64) -> Option<f64> {
    Some(contact_time_s(alone(model, index, samples), rate_hz)? * rate_hz * PULSE_FWHM / HALF_SINE_FWHM)
}

/// The model with all contact times as they are heard, and held. `None` if one strike is too short.
pub(crate) fn with_heard_times(model: &Model, samples: &[f64], rate_hz: f64) -> Option<Model> {
    let mut held = model.clone();
    held.contact_times_are_held = true;
    for (index, strike) in held.strikes.iter_mut().enumerate() {
        strike.contact = Contact { time: heard_time(model, index, samples, rate_hz)?, ..strike.contact };
    }
    Some(held)
}

/// The fit with peaks by which each strike's modes have the energy that is heard behind it.
///
/// Strikes at several places ring the modes in other proportions than their common gains, so that a
/// fit of amplitudes finds too little in them, and in soft ones nothing. The variances of the
/// amplitudes count that error as noise: taken off, they leave nothing of soft strikes, either.
pub(crate) fn with_heard_peaks(fitted: Fitted, samples: &[f64], whitening: &Whitening, rate_hz: f64) -> Fitted {
    let mut model = fitted.model.clone();
    let onsets: Vec<usize> =
        model.strikes.iter().map(|strike| strike.contact.first_sample().max(0.0) as usize).collect();
    let whole = whitening.filtered(samples, 0..samples.len());
    let white = White { samples: &whole, whitening, variance: fitted.noise_rms().powi(2) };
    for change in changes_of(&white, &onsets, &model.poles, rate_hz, Told::Together) {
        let Some(index) = onsets.iter().position(|onset| *onset == change.at) else { continue };
        let Strike { contact, position, .. } = model.strikes[index];
        let own = |mode: usize| model.gain(mode, position) * strength(model.exponent(mode), contact.time).value;
        let modelled: f64 = (0..model.poles.len()).map(|mode| own(mode).norm_sqr()).sum();
        let heard: f64 = change.amplitudes.iter().map(|amplitude| amplitude.norm_sqr()).sum();
        if heard > 0.0 && modelled > 0.0 {
            model.strikes[index].contact.peak = (heard / modelled).sqrt();
        }
    }
    Fitted::new(model, samples, whitening)
}

/// Standard deviation of the logarithm of a contact time that is heard; `None` if the strike is too
/// short.
pub(crate) fn log_deviation(model: &Model, index: usize, samples: &[f64], rate_hz: f64) -> Option<f64> {
    let [low, high] = contact_interval_s(alone(model, index, samples), rate_hz)?;
    Some((high / low).ln() / (2.0 * DEVIATIONS))
}

/// Sound from a strike's beginning to the next one's.
fn alone<'a>(model: &Model, index: usize, samples: &'a [f64]) -> &'a [f64] {
    let first = |strike: &Strike| (strike.contact.first_sample().max(0.0) as usize).min(samples.len());
    let begin = first(&model.strikes[index]);
    let end = model.strikes.get(index + 1).map_or(samples.len(), first);
    &samples[begin..end.max(begin)]
}
