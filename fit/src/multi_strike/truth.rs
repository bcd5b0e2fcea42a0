//! The truth of a synthetic recording as a model, with the Cramer-Rao bounds of its numbers.

use nalgebra::Complex;

use super::contact::Contact;
use super::descend::{Fitted, deviations};
use super::estimate::{Estimate, of_fit};
use super::model::{Model, Strike};
use super::spline::nearest;
use super::synthetic::{StruckOften, TrueMode, TrueStrike};
use super::whitening::Whitening;
use crate::modes::Pole;

/// Number of coefficients with which shapes along the object are described.
const COEFFICIENTS: usize = 10;
/// Number of positions at which a description meets its shape.
const MET_AT: usize = 60;

/// The truth as the fit's model.
pub(crate) fn model_of(sound: &StruckOften) -> Model {
    let gains = |mode: &TrueMode| {
        let gain = Complex::new(mode.gain[1], -mode.gain[0]) / sound.rate_hz;
        let at = |index: usize| gain * mode.shape_at(index as f64 / (MET_AT - 1) as f64);
        let curved = || nearest(&(0..MET_AT).map(at).collect::<Vec<_>>(), COEFFICIENTS);
        (mode.shape[0] != 0.0).then(curved).flatten().unwrap_or_else(|| vec![at(0)])
    };
    let pole = |mode: &TrueMode| Pole::new(mode.frequency_hz, mode.decay_per_s, sound.rate_hz);
    let strike = |strike: &TrueStrike| Strike {
        contact: Contact {
            middle: strike.middle_s() * sound.rate_hz,
            time: strike.contact_time_s * sound.rate_hz,
            peak: strike.peak_force,
        },
        position: strike.position,
        striker: strike.striker,
    };
    Model {
        poles: sound.modes.iter().map(pole).collect(),
        gains: sound.modes.iter().map(gains).collect(),
        owners: sound.modes.iter().map(|mode| mode.striker).collect(),
        acceleration: 0.0,
        contact_times_are_held: false,
        shapes_are_real: true,
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
