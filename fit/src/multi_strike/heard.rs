//! Contact times from the sound of each strike alone.
//!
//! Where a thing is struck a little elsewhere each time, its modes' amplitudes differ from strike
//! to strike, and a fit with one place takes that for other contact times: on an impact hammer's
//! strikes it ended at twelve times the measured one. The spectrum of each strike tells them to a
//! fifth ([`crate::contact`]), and they are held there. Peaks follow from the energy behind each
//! strike.

use std::ops::Range;

use super::descend::Fitted;
use super::equations::of_one_strike;
use super::model::{Model, Strike};
use super::whitening::Whitening;
use crate::contact::{PULSE_FWHM, contact_interval_s, contact_time_s};
use crate::segment::onset_sample;

/// Width at half maximum of a half-sine, as a share of its length.
const HALF_SINE_FWHM: f64 = 2.0 / 3.0;
/// Ratio of contact times to those heard.
///
/// Measured widths of an impact hammer are longer than heard ones by 5 % on a mug and by 18 % on
/// wood, in the geometric mean; half of what both have in the mean is made up for.
const HEARD_SHORT: f64 = 1.06;
/// Ratio of a contact time to the heard one from which it is far longer.
///
/// Heard ones are good to a fifth.
const FAR: f64 = 1.5;
/// Time in seconds about a strike's beginning within which its onset is heard.
const ONSET_S: f64 = 0.005;
/// Time in seconds from a strike's begin in which its energy is heard.
const HEARD_S: f64 = 0.03;
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
    let heard_s = contact_time_s(from_onset(model, index, samples, rate_hz), rate_hz)?;
    Some(HEARD_SHORT * heard_s * rate_hz * PULSE_FWHM / HALF_SINE_FWHM)
}

/// Contact times in samples as they are heard near a model's strikes. `None` if one strike is too
/// short.
pub(crate) fn heard_times(model: &Model, samples: &[f64], rate_hz: f64) -> Option<Vec<f64>> {
    (0..model.strikes.len()).map(|index| heard_time(model, index, samples, rate_hz)).collect()
}

/// The model with contact times that are held, in samples, one for each strike.
pub(crate) fn with_held_times(model: &Model, times: &[f64]) -> Model {
    let mut held = model.clone();
    held.contact_times_are_held = true;
    held.strikes.iter_mut().zip(times).for_each(|(strike, time)| strike.contact.time = *time);
    held
}

/// The fit with peaks by which each strike's sound has the energy that is heard in its first
/// [`HEARD_S`].
///
/// Strikes at several places ring the modes in other proportions than their common gains, so that a
/// fit of amplitudes finds too little in them, and in soft ones nothing. Energies are those of the
/// sounds, not those of single modes: of modes that fade within the contact, or of two in one
/// place, a single strike tells the sum alone.
pub(crate) fn with_heard_peaks(fitted: Fitted, samples: &[f64], whitening: &Whitening, rate_hz: f64) -> Fitted {
    let mut model = fitted.model.clone();
    for (index, strike) in model.strikes.iter_mut().enumerate() {
        let [own, recorded] = beginning(&fitted, index, rate_hz);
        let ratio = recorded / own;
        if ratio.is_finite() && ratio > 0.0 {
            strike.contact.peak *= ratio.sqrt();
        }
    }
    Fitted::new(model, samples, whitening)
}

/// Energies of a strike's begin: of the model's sound, and of the recording without what the model
/// has of all other strikes.
fn beginning(fitted: &Fitted, index: usize, rate_hz: f64) -> [f64; 2] {
    let Fitted { model, residual, .. } = fitted;
    let left = &residual[alone(model, index, residual.len())];
    let left = &left[..left.len().min((HEARD_S * rate_hz) as usize)];
    let strike = &model.strikes[index];
    let turned = of_one_strike(model, strike, strike.contact.first_sample().max(0.0) as usize, left.len());
    let own = turned.iter().map(|x| x * x).sum();
    [own, left.iter().zip(&turned).map(|(left, turned)| (left - turned).powi(2)).sum()]
}

/// Standard deviation of the logarithm of a contact time that is heard; `None` if the strike is too
/// short.
pub(crate) fn log_deviation(model: &Model, index: usize, samples: &[f64], rate_hz: f64) -> Option<f64> {
    let [low, high] = contact_interval_s(from_onset(model, index, samples, rate_hz), rate_hz)?;
    Some((high / low).ln() / (2.0 * DEVIATIONS))
}

/// Sound from a strike's onset to the next strike's beginning.
///
/// The onset is looked for in the sound: a model's contact of wrong length begins beside it, and
/// without its first 0.2 ms a strike is heard as up to a third shorter.
fn from_onset<'a>(model: &Model, index: usize, samples: &'a [f64], rate_hz: f64) -> &'a [f64] {
    let Range { start, end } = alone(model, index, samples.len());
    let reach = (ONSET_S * rate_hz) as usize;
    let onset = onset_sample(&samples[..end], start, reach).clamp(start.saturating_sub(reach), start + reach);
    &samples[onset.min(end)..end]
}

/// Samples from a strike's beginning to the next one's, in a recording of `length` samples.
fn alone(model: &Model, index: usize, length: usize) -> Range<usize> {
    let first = |strike: &Strike| (strike.contact.first_sample().max(0.0) as usize).min(length);
    let begin = first(&model.strikes[index]);
    let end = model.strikes.get(index + 1).map_or(length, first);
    begin..end.max(begin)
}

#[cfg(test)]
mod tests {
    use nalgebra::Complex;

    use super::*;
    use crate::modes::Pole;
    use crate::multi_strike::synthetic::plain;
    use crate::multi_strike::truth::model_of;

    #[test]
    fn peaks_are_those_heard_beside_fast_modes_that_cancel_each_other() {
        let sound = plain(8, 3.0, 5, -60.0);
        let truth = model_of(&sound);
        let mut model = truth.clone();
        let decay = 11_400.0 / sound.rate_hz;
        model.push(Pole { decay, angular: 0.35 }, Complex::new(50.0, 0.0), None);
        model.push(Pole { decay: decay * (1.0 + 1e-6), angular: 0.35 }, Complex::new(-50.0, 0.0), None);
        let whitening = Whitening::none();
        let fitted = Fitted::new(model, &sound.samples, &whitening);
        let heard = with_heard_peaks(fitted, &sound.samples, &whitening, sound.rate_hz);
        for (found, truth) in heard.model.strikes.iter().zip(&truth.strikes) {
            let ratio = found.contact.peak / truth.contact.peak;
            assert!((ratio - 1.0).abs() < 0.02, "{ratio} of the peak at {}", truth.contact.middle);
        }
        assert!(heard.noise_rms() < 3.0 * sound.noise_rms, "{}", heard.noise_rms());
    }
}
