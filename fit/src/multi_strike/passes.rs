//! Passes that complete a first fit: strikes and modes that it lacks are added, those that explain
//! too little are dropped, and all are fitted anew.

use nalgebra::Complex;

use super::amplitudes::{Told, White, changes_of};
use super::completion::{completed, worthy};
use super::descend::{Ending, Fitted, descend};
use super::equations::energy;
use super::error::StrikesError;
use super::layout::Layout;
use super::model::Model;
use super::real_shapes::nearest_real;
use super::sought_anew::sought_anew;
use super::strikers::assigned;
use super::whitening::{ORDER, Whitening};
use crate::modes::Settings;

/// Maximum number of passes that look for what the model lacks.
const COMPLETIONS: usize = 5;
/// Maximum number of times that modes and strikes are dropped in a pass.
const PRUNINGS: usize = 6;
/// Ratio by which dropped parts may let what is left grow; they are kept where it grows more.
///
/// Worth is judged as if the energy about a fit were a parabola.
const MOST_GROWN: f64 = 2.0;
/// Number of passes in a row that change no number of modes and strikes, and end them.
const MOST_STALLED: usize = 2;

/// The fit with what it lacks and without what explains too little, and the filter of its noise.
pub(super) fn completed_fit(
    first: Fitted,
    samples: &[f64],
    rate_hz: f64,
    settings: Settings,
    layout: Layout,
    told: &dyn Fn(f64),
) -> Result<(Fitted, Whitening), StrikesError> {
    let (mut fitted, mut whitening) = (first, Whitening::none());
    let (mut stalled, mut is_refused) = (0, false);
    for pass in 0..COMPLETIONS {
        let before = (fitted.model.poles.len(), fitted.model.strikes.len());
        whitening = Whitening::of_residual(&fitted.residual, ORDER);
        fitted = Fitted::new(fitted.model, samples, &whitening);
        // Strikes that are sought anew may end farther off than they were.
        let start = (layout != Layout::default()).then(|| fitted.clone());
        fitted = with_strikes_anew(fitted, samples, &whitening, rate_hz, layout);
        fitted = with_strikers(fitted, samples, &whitening, rate_hz, layout);
        let are_modes_first = is_refused || stalled > 0 && layout.strikers > 1;
        let more = completed(&fitted, samples, &whitening, rate_hz, (settings, are_modes_first));
        let is_complete = more == fitted.model;
        let more = with_shapes_of_new_modes(more, fitted.model.poles.len(), samples, &whitening);
        fitted = descend(Fitted::new(more, samples, &whitening), samples, &whitening, Ending::COMPLETION);
        for _ in 0..PRUNINGS {
            let fastest = settings.fastest_decay_per_s / rate_hz;
            let kept = worthy(&fitted, &whitening, fastest).ok_or(StrikesError::Untold)?;
            if kept == fitted.model {
                break;
            }
            let pruned = descend(Fitted::new(kept, samples, &whitening), samples, &whitening, Ending::COMPLETION);
            if pruned.energy > MOST_GROWN * fitted.energy {
                break;
            }
            fitted = pruned;
        }
        told((pass as f64 + 1.0) / COMPLETIONS as f64);
        if let Some(start) = start.filter(|start| cost(&fitted, start) > cost(start, start)) {
            fitted = start;
            if are_modes_first {
                break;
            }
            is_refused = true;
            continue;
        }
        let is_stalled = before == (fitted.model.poles.len(), fitted.model.strikes.len());
        stalled = if is_stalled { stalled + 1 } else { 0 };
        if is_complete || stalled == MOST_STALLED {
            break;
        }
    }
    Ok((fitted, whitening))
}

/// The model with first gains of its new modes, from the index `known` on, if shapes are real.
///
/// A descent from gains near 0 does not find the phase of a real shape. So complex gains that leave
/// least with all else held, a linear problem, are found first, and made real.
fn with_shapes_of_new_modes(model: Model, known: usize, samples: &[f64], whitening: &Whitening) -> Model {
    if !model.shapes_are_real || model.poles.len() <= known {
        return model;
    }
    let free = Fitted::new(Model { shapes_are_real: false, ..model }, samples, whitening);
    let mut arrow = free.equations(whitening);
    let first = free.model.gain_column(known);
    let is_new = |index: &usize| (first..free.model.shared_size() - 1).contains(index);
    (0..free.model.shared_size()).filter(|index| !is_new(index)).for_each(|index| arrow.hold_shared(index));
    let step = arrow.held_shared(HAIR).map(|(covariance, right)| covariance * right);
    let mut model = Model { shapes_are_real: true, ..free.model };
    let Some(step) = step else { return model };
    for mode in known..model.poles.len() {
        let column = model.gain_column(mode);
        for (place, gain) in model.gains[mode].iter_mut().enumerate() {
            *gain += Complex::new(step[column + 2 * place], step[column + 2 * place + 1]);
        }
        model.gains[mode] = nearest_real(&model.gains[mode]);
    }
    model
}

/// Share by which the diagonal of the gains' equations grows, so that gains near which nothing is
/// struck are told, too.
const HAIR: f64 = 1e-6;

/// Bayesian information criterion of a fit: its energy and ln N for each of its numbers, in units
/// of the noise that `reference` leaves.
fn cost(fitted: &Fitted, reference: &Fitted) -> f64 {
    let numbers = fitted.model.shared_freedom() + fitted.model.strike_size() * fitted.model.strikes.len();
    fitted.energy / reference.noise_rms().powi(2) + numbers as f64 * (fitted.residual.len() as f64).ln()
}

/// The fit with strikes where they leave least, if their positions or strikers have to be told.
fn with_strikes_anew(fitted: Fitted, samples: &[f64], whitening: &Whitening, rate_hz: f64, layout: Layout) -> Fitted {
    if layout == Layout::default() {
        return fitted;
    }
    let anew = sought_anew(&fitted, whitening, rate_hz);
    if anew == fitted.model {
        return fitted;
    }
    let other = descend(Fitted::new(anew, samples, whitening), samples, whitening, Ending::COMPLETION);
    if other.energy < fitted.energy { other } else { fitted }
}

/// The fit with strikers told apart by its contacts, and with their own modes.
fn with_strikers(fitted: Fitted, samples: &[f64], whitening: &Whitening, rate_hz: f64, layout: Layout) -> Fitted {
    if layout.strikers < 2 {
        return fitted;
    }
    let model = &fitted.model;
    let onsets: Vec<usize> =
        model.strikes.iter().map(|strike| strike.contact.first_sample().max(0.0) as usize).collect();
    let whole = whitening.filtered(samples, 0..samples.len());
    let white = White { samples: &whole, whitening, variance: fitted.noise_rms().powi(2) };
    let changes = changes_of(&white, &onsets, &model.poles, rate_hz, Told::Together);
    let mut next = assigned(model, &changes, layout.strikers, layout.positions, rate_hz);
    if next.shapes_are_real {
        let changed = next.gains.iter_mut().zip(&model.gains).filter(|(next, own)| next != own);
        changed.for_each(|(gains, _)| *gains = nearest_real(gains));
    }
    if next == *model {
        return fitted;
    }
    let other = Fitted::new(next, samples, whitening);
    // Gains told by few strikes may be wrong by any factor.
    if other.energy < energy(samples, whitening).min(MOST_GROWN * fitted.energy) { other } else { fitted }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::multi_strike::synthetic::at_places;
    use crate::multi_strike::truth::model_of;

    #[test]
    fn modes_of_one_striker_are_found_though_all_its_strikes_seem_misplaced() {
        let sound = at_places(301, 20.0, 30);
        let truth = model_of(&sound);
        let own: Vec<usize> = (0..truth.poles.len()).filter(|&mode| truth.owners[mode].is_some()).collect();
        let mut model = truth.clone();
        model.drop_modes(&own);
        let first = Fitted::new(model, &sound.samples, &Whitening::none());
        let layout = Layout { positions: truth.places(), strikers: 2 };
        let (fitted, _) = completed_fit(first, &sound.samples, sound.rate_hz, Settings::default(), layout, &|_| {})
            .expect("strikes are told");
        for &mode in &own {
            let pole = truth.poles[mode];
            let is_near = |found: &&crate::modes::Pole| (found.angular - pole.angular).abs() < pole.decay;
            let found = fitted.model.poles.iter().find(is_near);
            assert!(found.is_some(), "no mode near {:.1} Hz", pole.frequency_hz(sound.rate_hz));
        }
        assert_eq!(fitted.model.strikes.len(), truth.strikes.len());
    }
}
