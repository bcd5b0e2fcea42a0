//! Strikes sought anew in what a fit leaves without each of them.
//!
//! A descent ends in the minimum that is nearest to its start. A strike at an unknown position may
//! start near a wrong one, with a wrong contact time.

use rayon::prelude::*;

use super::descend::Fitted;
use super::equations::{energy, of_one_strike};
use super::model::{Model, Strike};
use super::start::sought;
use super::whitening::Whitening;

/// Time in seconds before a contact from which on its sound is compared.
const BEFORE_S: f64 = 0.004;
/// Longest time in seconds behind a contact over which its sound is compared.
const BEHIND_S: f64 = 0.5;

/// The model with each strike where it leaves least: as it is, or as its ringing alone tells it.
///
/// All others keep their sound; both are compared from shortly before the contact to the next one.
pub(super) fn sought_anew(fitted: &Fitted, whitening: &Whitening, rate_hz: f64) -> Model {
    let (model, residual) = (&fitted.model, &fitted.residual);
    let variance = fitted.left_behind(rate_hz).1;
    let first_sample = |strike: &Strike| (strike.contact.first_sample().max(0.0) as usize).min(residual.len());
    let better = |(index, strike): (usize, &Strike)| {
        let at = first_sample(strike);
        let next = model.strikes.get(index + 1).map_or(residual.len(), first_sample);
        let end = next.min(at + (BEHIND_S * rate_hz) as usize).max(at);
        let before = index.checked_sub(1).map_or(0, |before| first_sample(&model.strikes[before]));
        let start = at.saturating_sub((BEFORE_S * rate_hz) as usize).max(before.min(at));
        let left = &residual[start..end];
        let sound = of_one_strike(model, strike, start, left.len());
        let heard: Vec<f64> = left.iter().zip(sound).map(|(left, turned)| left - turned).collect();
        let Some(other) = sought(model, &heard[at - start..], rate_hz, variance) else { return *strike };
        let sound = of_one_strike(model, &other.later_by((at - start) as f64), 0, heard.len());
        let without: Vec<f64> = heard.iter().zip(sound).map(|(heard, turned)| heard + turned).collect();
        if energy(&without, whitening) < energy(left, whitening) { other.later_by(at as f64) } else { *strike }
    };
    let mut strikes: Vec<Strike> = model.strikes.par_iter().enumerate().map(better).collect();
    strikes.sort_by(|a, b| a.contact.middle.total_cmp(&b.contact.middle));
    Model { strikes, ..model.clone() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::multi_strike::synthetic::at_places;
    use crate::multi_strike::truth::model_of;

    #[test]
    fn strikes_in_wrong_places_are_found_again_and_right_ones_stay() {
        let sound = at_places(301, 20.0, 30);
        let truth = model_of(&sound);
        let mut model = truth.clone();
        let wrong = [3, 11, 24];
        for index in wrong {
            let strike = &mut model.strikes[index];
            strike.contact.time *= 1.6;
            strike.contact.peak *= 0.5;
            strike.position = 1.0 - strike.position;
        }
        let whitening = Whitening::none();
        let found = sought_anew(&Fitted::new(model, &sound.samples, &whitening), &whitening, sound.rate_hz);
        let is_found = |(found, truth): &(&Strike, &Strike)| {
            (found.position - truth.position).abs() < 0.02
                && (found.contact.time / truth.contact.time).ln().abs() < 0.05
        };
        let pairs: Vec<(&Strike, &Strike)> = found.strikes.iter().zip(&truth.strikes).collect();
        assert!(wrong.iter().all(|index| is_found(&pairs[*index])), "{found:?}");
        let right = pairs.iter().filter(|pair| is_found(pair)).count();
        assert!(right >= 29, "{right} of 30 are where they are in truth");
    }
}
