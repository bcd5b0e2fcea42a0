//! Strikes without a room: modes between them and moments near which they begin in turn, then
//! contacts, then what is missing.

use super::begin::begun;
use super::changes::changes;
use super::descend::{Ending, Fitted, descend};
use super::error::StrikesError;
use super::free::{FreeModes, Guard, free_modes};
use super::layout::Layout;
use super::model::Model;
use super::passes::completed_fit;
use super::spline::halved;
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
    let (free, all) = between_strikes(samples, rate_hz, from, (settings, layout), &|share| told(0.3 * share))?;
    StrikesError::refuse_few_for(layout, all.len())?;
    let first = begun(samples, &free, &all, rate_hz, layout, search, &|share| told(0.3 + 0.3 * share))?;
    StrikesError::refuse_unexplained(&first.residual, samples, UNEXPLAINED_AT_FIRST)?;
    let completed = |fitted: Fitted, from: f64, to: f64| {
        completed_fit(fitted, samples, rate_hz, settings, layout, &|share| told(from + (to - from) * share))
    };
    let (mut fitted, mut whitening) = completed(first, 0.6, 0.8)?;
    while let Some(finer) = with_finer_gains(&fitted, samples, &whitening) {
        (fitted, whitening) = completed(finer, 0.8, 0.9)?;
    }
    if let Some(complex) = with_complex_shapes(&fitted, samples, &whitening) {
        (fitted, whitening) = completed(complex, 0.9, 1.0)?;
    }
    Ok((fitted, whitening))
}

/// The fit with two intervals in place of each one of its gains along the object, if they explain
/// clearly more than chance does, and if there are three strikes or more for each coefficient.
///
/// All other numbers bend to make up for what a spline with too few intervals leaves. Each number
/// more explains one sample's noise by chance.
fn with_finer_gains(fitted: &Fitted, samples: &[f64], whitening: &Whitening) -> Option<Fitted> {
    if !(CUBIC..=MOST_HALVED).contains(&fitted.model.places()) {
        return None;
    }
    let mut model = fitted.model.clone();
    model.gains.iter_mut().filter(|gains| gains.len() > 1).for_each(|gains| *gains = halved(gains));
    if model.strikes.len() < STRIKES_A_COEFFICIENT * model.places() {
        return None;
    }
    if_told(model, fitted, samples, whitening)
}

/// The fit with gains whose phases differ along the object, if they explain clearly more than
/// chance does: modes of a thing with strong damping in some places have such shapes.
fn with_complex_shapes(fitted: &Fitted, samples: &[f64], whitening: &Whitening) -> Option<Fitted> {
    let (model, places) = (&fitted.model, fitted.model.places());
    if !model.shapes_are_real || places < 2 || model.strikes.len() < STRIKES_A_COEFFICIENT * places {
        return None;
    }
    if_told(Model { shapes_are_real: false, ..fitted.model.clone() }, fitted, samples, whitening)
}

/// A fit that begins with a model of more numbers, if they explain clearly more than chance does.
fn if_told(model: Model, fitted: &Fitted, samples: &[f64], whitening: &Whitening) -> Option<Fitted> {
    let added = model.shared_freedom() - fitted.model.shared_freedom();
    let more = descend(Fitted::new(model, samples, whitening), samples, whitening, Ending::COMPLETION);
    let least = MORE_THAN_CHANCE * added as f64 * fitted.noise_rms().powi(2);
    (fitted.energy - more.energy > least).then_some(more)
}

/// Least ratio of what more numbers explain to what they explain by chance.
const MORE_THAN_CHANCE: f64 = 2.0;
/// Least number of strikes for each coefficient of gains with more numbers.
///
/// Gains that fewer strikes tell are wrong between the places of those strikes. With 13
/// coefficients for 25 strikes a replay left -24.2 dB of the recording; the test asserts -25
/// (`cargo test -p malleus --test play own_force::strikes_at_positions`).
const STRIKES_A_COEFFICIENT: usize = 3;
/// Least number of coefficients of a cubic spline.
const CUBIC: usize = 4;
/// Maximum number of coefficients whose intervals are halved.
const MOST_HALVED: usize = 10;

/// Modes between strikes, and moments near which strikes begin, in turn.
fn between_strikes(
    samples: &[f64],
    rate_hz: f64,
    (mut onsets, mut free): (Vec<usize>, FreeModes),
    (settings, layout): (Settings, Layout),
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
        // Modes that were found beside missed strikes may stay for good where not all strikes ring
        // a mode alike.
        let is_anew = layout != Layout::default() && changed.len() != onsets.len();
        let known = if is_anew { &[] } else { &free.poles[..] };
        onsets = changed;
        if is_settled {
            break;
        }
        let next = free_modes(samples, &onsets, Guard::OF_CHANGE.of_layout(layout), rate_hz, settings, known);
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

#[cfg(test)]
mod tests {
    use nalgebra::Complex;

    use super::*;
    use crate::multi_strike::real_shapes::nearest_real;
    use crate::multi_strike::spline::{Weights, nearest};
    use crate::multi_strike::synthetic::at_places;
    use crate::multi_strike::truth::model_of;
    use crate::multi_strike::whitening::ORDER;

    type C64 = Complex<f64>;

    #[test]
    fn gains_are_refined_where_few_coefficients_leave_more_than_noise_and_only_there() {
        let sound = at_places(306, 12.0, 40);
        let with_coefficients = |count: usize| {
            let mut model = model_of(&sound);
            for gains in model.gains.iter_mut().filter(|gains| gains.len() > 1) {
                let met = (0..=60).map(|step| Weights::at(f64::from(step) / 60.0, gains.len()).sum(gains));
                *gains = nearest(&met.collect::<Vec<_>>(), count).expect("enough values");
            }
            let truth = Fitted::new(model_of(&sound), &sound.samples, &Whitening::none());
            let whitening = Whitening::of_residual(&truth.residual, ORDER);
            let from = Fitted::new(model, &sound.samples, &whitening);
            let fitted = descend(from, &sound.samples, &whitening, Ending::COMPLETION);
            let finer = with_finer_gains(&fitted, &sound.samples, &whitening);
            finer.map(|finer| (finer.model.places(), fitted.energy / finer.energy))
        };
        let finer = with_coefficients(4);
        assert!(finer.is_some_and(|(places, ratio)| places == 5 && ratio > 1.02), "{finer:?}");
        assert_eq!(with_coefficients(10), None);
    }

    #[test]
    fn shapes_are_complex_where_the_phase_of_gains_turns_along_the_object() {
        let sound = at_places(306, 20.0, 50);
        let fitted = |turn: f64| {
            let mut model = model_of(&sound);
            let noise = Fitted::new(model.clone(), &sound.samples, &Whitening::none()).residual;
            let whitening = Whitening::of_residual(&noise, ORDER);
            for gains in model.gains.iter_mut().filter(|gains| gains.len() > 1) {
                gains
                    .iter_mut()
                    .enumerate()
                    .for_each(|(place, gain)| *gain *= C64::new(0.0, turn * place as f64).exp());
            }
            let silent = vec![0.0; noise.len()];
            let turned = Fitted::new(model.clone(), &silent, &Whitening::none()).residual;
            let samples: Vec<f64> = noise.iter().zip(turned).map(|(noise, turned)| noise - turned).collect();
            model.gains.iter_mut().for_each(|gains| *gains = nearest_real(gains));
            let from = Fitted::new(model, &samples, &whitening);
            let real = descend(from, &samples, &whitening, Ending::COMPLETION);
            let complex = with_complex_shapes(&real, &samples, &whitening);
            complex.map(|complex| (complex.model.shapes_are_real, real.energy / complex.energy))
        };
        assert_eq!(fitted(0.0), None);
        let complex = fitted(0.05);
        assert!(complex.is_some_and(|(are_real, ratio)| !are_real && ratio > 1.02), "{complex:?}");
    }
}
