//! The truth of a synthetic recording as a model, with the Cramer-Rao bounds of its numbers.

use nalgebra::Complex;

use super::contact::Contact;
use super::descend::{Fitted, deviations};
use super::estimate::{Estimate, of_fit};
use super::model::{Model, Strike};
use super::synthetic::{StruckOften, TrueMode, TrueStrike};
use super::whitening::Whitening;
use crate::modes::Pole;

/// The truth as the fit's model.
pub(crate) fn model_of(sound: &StruckOften) -> Model {
    let gain = |mode: &TrueMode| vec![Complex::new(mode.gain[1], -mode.gain[0]) / sound.rate_hz];
    let pole = |mode: &TrueMode| Pole::new(mode.frequency_hz, mode.decay_per_s, sound.rate_hz);
    let strike = |strike: &TrueStrike| Strike {
        contact: Contact {
            middle: strike.middle_s() * sound.rate_hz,
            time: strike.contact_time_s * sound.rate_hz,
            peak: strike.peak_force,
        },
        position: 0.0,
        striker: 0,
    };
    Model {
        poles: sound.modes.iter().map(pole).collect(),
        gains: sound.modes.iter().map(gain).collect(),
        owners: vec![None; sound.modes.len()],
        acceleration: 0.0,
        strikes: sound.strikes.iter().map(strike).collect(),
    }
}

/// The truth with the Cramer-Rao bounds of all numbers together, as standard deviations.
///
/// `None` if two modes cannot be told apart at all.
pub fn cramer_rao(sound: &StruckOften) -> Option<Estimate> {
    let white = Whitening::none();
    let fitted = Fitted::new(model_of(sound), &sound.samples, &white);
    let bounds = deviations(&fitted, &white)?;
    Some(of_fit(fitted, &bounds, sound.rate_hz))
}
