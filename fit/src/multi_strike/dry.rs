//! Strikes without a room: modes between them and moments near which they begin in turn, then
//! contacts, then what is missing.

use super::begin::begun;
use super::changes::changes;
use super::descend::Fitted;
use super::error::StrikesError;
use super::free::{FreeModes, Guard, free_modes};
use super::layout::Layout;
use super::passes::completed_fit;
use super::start::StartSearch;
use super::whitening::Whitening;
use crate::modes::Settings;

/// Maximum number of rounds of modes and strikes in turn.
const ROUNDS: usize = 4;
/// Time in seconds by which no strike moves in a round that ends them.
const SETTLED_S: f64 = 0.0025;
/// Share of the energy that the first fit leaves from which no completion helps: -0.5 dB.
const UNEXPLAINED_AT_FIRST: f64 = 0.89;

/// Fit of a recording without a room, and the filter of its noise, from moments near which strikes
/// begin and modes between them.
pub(super) fn dry(
    samples: &[f64],
    from: (Vec<usize>, FreeModes),
    rate_hz: f64,
    settings: Settings,
    (layout, search): (Layout, StartSearch),
    told: &dyn Fn(f64),
) -> Result<(Fitted, Whitening), StrikesError> {
    let (free, all) = between_strikes(samples, rate_hz, from, settings, &|share| told(0.3 * share))?;
    StrikesError::refuse_few_for(layout, all.len())?;
    let first = begun(samples, &free, &all, rate_hz, layout, search, &|share| told(0.3 + 0.3 * share))?;
    StrikesError::refuse_unexplained(&first.residual, samples, UNEXPLAINED_AT_FIRST)?;
    completed_fit(first, samples, rate_hz, settings, layout, &|share| told(0.6 + 0.4 * share))
}

/// Modes between strikes, and moments near which strikes begin, in turn.
fn between_strikes(
    samples: &[f64],
    rate_hz: f64,
    (mut onsets, mut free): (Vec<usize>, FreeModes),
    settings: Settings,
    told: &dyn Fn(f64),
) -> Result<(FreeModes, Vec<usize>), StrikesError> {
    let rising = onsets.len();
    for round in 0..ROUNDS {
        told((round as f64 + 1.0) / (ROUNDS as f64 + 1.0));
        let white = free.whitening.filtered(samples, 0..samples.len());
        let changed: Vec<usize> =
            changes(&white, &free.poles, rate_hz, free.white_variance).into_iter().map(|change| change.0).collect();
        StrikesError::refuse_too_many(changed.len(), samples.len() as f64 / rate_hz)?;
        let is_settled = changed.len() == onsets.len()
            && changed.iter().zip(&onsets).all(|(a, b)| (a.abs_diff(*b) as f64) < SETTLED_S * rate_hz);
        onsets = changed;
        if is_settled {
            break;
        }
        let next = free_modes(samples, &onsets, Guard::OF_CHANGE, rate_hz, settings, &free.poles);
        match next.filter(|next| !next.poles.is_empty()) {
            Some(next) => free = next,
            None if free.poles.is_empty() => return Err(StrikesError::NoModes),
            // Strikes that are found anew may leave too little time between them: the modes stay.
            None => break,
        }
    }
    StrikesError::refuse_few(onsets.len(), rising)?;
    Ok((free, onsets))
}
