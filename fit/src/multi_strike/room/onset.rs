//! First model in a room: contacts, the time by which all are late together, and gains.
//!
//! A room turns and scales all amplitudes of a mode alike, so that the changes of amplitudes tell
//! contact times and peaks as they do in a dry recording. But turned gains move the common time of
//! all contacts. The room's answer grows from nothing within some tens of ms: the samples just
//! behind the contacts tell gains and common time without it.

use nalgebra::Complex;
use rayon::prelude::*;

use super::super::alignment::aligned;
use super::super::amplitudes::White;
use super::super::descend::Fitted;
use super::super::free::FreeModes;
use super::super::model::Model;
use super::super::start::starts;
use super::super::whitening::Whitening;

/// Time in seconds in which the weights of samples behind a contact fall to 1/e.
const FADING_S: f64 = 0.010;
/// Reach of the common time on either side, in seconds.
const REACH_S: f64 = 1e-3;
/// Steps of the common time in samples, each smaller one about the best of the last.
const STEPS: [f64; 4] = [2.0, 0.5, 0.25, 0.0625];
/// Variance of a gain's real and of its imaginary part by a room, relative to the gain squared.
const TURNED: f64 = 0.03;

/// A common time of all contacts in samples, with the gains that fit it.
#[derive(Clone, Debug)]
struct Trial {
    shift: f64,
    /// Energy that is left, with what the gains' changes cost.
    misfit: f64,
    /// Energy that is left.
    left: f64,
    model: Model,
}

/// The model of the strikes near `onsets`, with gains from the samples just behind contacts.
///
/// `None` if no strike is far enough from its neighbours.
pub(crate) fn first_model(
    samples: &[f64],
    free: &FreeModes,
    (onsets, usable): (&[usize], &[usize]),
    rate_hz: f64,
) -> Option<Fitted> {
    let whole = free.whitening.filtered(samples, 0..samples.len());
    let white = White { samples: &whole, whitening: &free.whitening, variance: free.white_variance };
    let start = starts(&white, (onsets, usable), &free.poles, rate_hz, 0).into_iter().next()?;
    let start = aligned(&start, samples, rate_hz).1;
    let mut best = trial(&start, 0.0, 0.0, samples, rate_hz)?;
    for (index, step) in STEPS.into_iter().enumerate() {
        let count = if index == 0 { (REACH_S * rate_hz / step) as i32 } else { 3 };
        let (middle, noise) = (best.shift, best.left / (0.5 * FADING_S * rate_hz));
        let tried: Vec<Trial> = (-count..=count)
            .into_par_iter()
            .filter_map(|index| trial(&start, middle + f64::from(index) * step, noise, samples, rate_hz))
            .collect();
        best = tried.into_iter().min_by(|a, b| a.misfit.total_cmp(&b.misfit))?;
    }
    Some(Fitted::new(best.model, samples, &Whitening::none()))
}

/// The start with all contacts later by `shift`, and the gains that then fit the first ms.
///
/// The room turns gains by a share that is known, so that they are tied to those of the start. All
/// strikes have one answer in common: it is noise of one strike alone, of the variance `noise`.
fn trial(start: &Model, shift: f64, noise: f64, samples: &[f64], rate_hz: f64) -> Option<Trial> {
    let fading = Whitening::fading(1.0 / (FADING_S * rate_hz));
    let fitted = Fitted::new(later(start, shift), samples, &fading);
    let mut arrow = fitted.equations(&fading);
    let mut model = fitted.model;
    for mode in 0..model.poles.len() {
        let weight = noise / (TURNED * model.gains[mode][0].norm_sqr());
        (0..2).for_each(|part| arrow.tie_shared(model.gain_column(mode) + part, weight));
    }
    let step = arrow.solve(&arrow.factor(0.0)?);
    let misfit = fitted.energy - arrow.promise(&step);
    for mode in 0..model.poles.len() {
        let first = model.gain_column(mode);
        model.gains[mode][0] += Complex::new(step.1[first], step.1[first + 1]);
    }
    let left = Fitted::new(model, samples, &fading);
    Some(Trial { shift, misfit, left: left.energy, model: left.model })
}

/// The model with all contacts later by `shift` samples, and gains with which it rings alike.
fn later(model: &Model, shift: f64) -> Model {
    let mut later = model.clone();
    later.strikes.iter_mut().for_each(|strike| strike.contact.middle += shift);
    for (mode, gains) in later.gains.iter_mut().enumerate() {
        let turn = (model.exponent(mode) * shift).exp();
        gains.iter_mut().for_each(|gain| *gain *= turn);
    }
    later
}
