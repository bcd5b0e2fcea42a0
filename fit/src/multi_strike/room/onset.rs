//! First model in a room: contacts, the time by which all are late together, and gains.
//!
//! A room turns and scales all amplitudes of a mode alike, so that the changes of amplitudes tell
//! contact times and peaks as they do in a dry recording. But turned gains move the common time of
//! all contacts. The room's answer grows from nothing within some tens of ms: the samples just
//! behind the contacts tell gains and common time without it.

use rayon::prelude::*;

use super::super::alignment::aligned;
use super::super::descend::{Ending, Fitted, descend};
use super::super::free::FreeModes;
use super::super::model::Model;
use super::super::start::{White, starts};
use super::super::whitening::Whitening;

/// Time in seconds in which the weights of samples behind a contact fall to 1/e.
const FADING_S: f64 = 0.010;
/// Reach of the common time on either side, in seconds.
const REACH_S: f64 = 1.5e-4;
/// Steps of the common time in samples, each smaller one about the best of the last.
const STEPS: [f64; 3] = [1.0, 0.25, 0.0625];

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
    let start = starts(&white, (onsets, usable), &free.poles, rate_hz).into_iter().next()?;
    let start = aligned(&start, samples, rate_hz).1;
    let fading = Whitening::fading(1.0 / (FADING_S * rate_hz));
    let at = |shift: f64| {
        let later = later(&start, shift);
        descend(Fitted::new(later, samples, &fading), samples, &fading, Ending { steps: 4, gain: 1.0 })
    };
    let mut tried: Vec<(f64, Fitted)> = vec![(0.0, at(0.0))];
    for step in STEPS {
        let best = tried.first().map_or(0.0, |(shift, _)| *shift);
        let count = if tried.len() > 1 { 3 } else { (REACH_S * rate_hz / step) as i32 };
        let shifts: Vec<f64> =
            (-count..=count).filter(|index| *index != 0).map(|index| best + f64::from(index) * step).collect();
        tried.extend(shifts.into_par_iter().map(|shift| (shift, at(shift))).collect::<Vec<_>>());
        tried.sort_by(|a, b| a.1.energy.total_cmp(&b.1.energy));
    }
    tried.into_iter().next().map(|(_, fitted)| fitted)
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
