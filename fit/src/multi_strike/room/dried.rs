//! Strikes of a recording without its room, and the room's answer, in turn.

use super::super::descend::{Deviations, Ending, Fitted, descend, deviations};
use super::super::error::StrikesError;
use super::super::whitening::Whitening;
use super::answer::Answer;

/// Number of rounds of answer and strikes in turn.
const ROUNDS: usize = 2;

/// Strikes and modes that a room is heard with, its answer, and the deviations of all numbers.
#[derive(Clone, Debug)]
pub(crate) struct InRoom {
    /// Fit of the sound without the answer.
    pub(crate) fitted: Fitted,
    pub(crate) deviations: Deviations,
    pub(crate) answer: Answer,
}

/// The fit of a recording in a room, from a first one whose room is still in the residual.
///
/// `complete` adds to a fit of the sound what it lacks, and drops what explains too little; it
/// gives the filter of the noise as well.
///
/// # Errors
/// Those of `complete`, and [`StrikesError::Untold`].
pub(crate) fn in_room(
    first: Fitted,
    samples: &[f64],
    rate_hz: f64,
    complete: impl Fn(Fitted, &[f64], usize) -> Result<(Fitted, Whitening), StrikesError>,
) -> Result<InRoom, StrikesError> {
    let none = Whitening::none();
    let mut model = first.model;
    let mut answer = Answer::none();
    for round in 0..ROUNDS {
        let heard = Fitted::new(model, samples, &none);
        answer = Answer::of(&heard, rate_hz);
        let dried = answer.taken_off(samples, &heard.model.strikes);
        let whitening = Whitening::of_residual(&Fitted::new(heard.model.clone(), &dried, &none).residual, ORDER);
        let fitted =
            descend(Fitted::new(heard.model, &dried, &whitening), &dried, &whitening, Ending::COMPLETION);
        model = complete(fitted, &dried, round)?.0.model;
    }
    let dried = answer.taken_off(samples, &model.strikes);
    let left = Fitted::new(model.clone(), &dried, &none);
    let whitening = Whitening::of_residual(&left.residual, ORDER);
    let mut fitted = descend(Fitted::new(model, &dried, &whitening), &dried, &whitening, Ending::COMPLETION);
    fitted.model.normalise();
    answer = Answer::of(&Fitted::new(fitted.model.clone(), samples, &none), rate_hz);
    let dried = answer.taken_off(samples, &fitted.model.strikes);
    let fitted = Fitted::new(fitted.model, &dried, &whitening);
    let deviations = deviations(&fitted, &whitening).ok_or(StrikesError::Untold)?;
    Ok(InRoom { fitted, deviations, answer })
}

/// Order of the whitening filter.
const ORDER: usize = 12;
