//! Strikes and modes that a fitted model lacks, and those of it that explain too little.

use nalgebra::Complex;

use super::changes::changes;
use super::descend::{Fitted, deviations};
use super::equations::residual;
use super::free::left_over;
use super::model::{Model, Strike};
use super::start::missing as missing_strike;
use super::tied::tied_modes;
use super::whitening::Whitening;
use crate::modes::Settings;

/// Time in seconds from a known strike within which a change is its own error.
const KNOWN_S: f64 = 0.008;
/// Maximum number of modes that are added at a time.
const MOST_AT_A_TIME: usize = 12;
/// Ratio to the fastest decay that is searched for from which a mode is an error of a contact.
const STRAYED: f64 = 1.5;
/// Distance of two modes in sums of their decays within which only one is dropped at a time.
const NEIGHBOURS: f64 = 10.0;
/// Ratio to the median power left behind a strike above which the strike is sought anew.
const FAR_MORE: f64 = 8.0;

/// The model with the strikes that stand out of what it leaves, or if there are none, the modes.
///
/// A missed or misplaced strike rings in many modes, so that modes are looked for last.
///
/// A model that lacks a mode of one striker leaves a loud residual behind each of that striker's
/// strikes. They look misplaced, and a search for strikes does not help. With `are_modes_first`
/// modes are looked for before strikes.
pub(crate) fn completed(
    fitted: &Fitted,
    samples: &[f64],
    whitening: &Whitening,
    rate_hz: f64,
    (settings, are_modes_first): (Settings, bool),
) -> Model {
    let mut model = fitted.model.clone();
    if are_modes_first {
        add_modes(&mut model, &fitted.residual, rate_hz, settings);
        if model.poles.len() > fitted.model.poles.len() {
            return model;
        }
    }
    let (misplaced, variance) = misplaced(fitted, rate_hz);
    let mut places = 0..;
    model.strikes.retain(|_| !misplaced.contains(&places.next().unwrap_or(0)));
    let left = if misplaced.is_empty() { fitted.residual.clone() } else { residual(&model, samples) };
    let is_known = |at: usize| {
        let apart = |strike: &Strike| (strike.contact.middle - at as f64).abs() / rate_hz;
        model.strikes.iter().any(|strike| apart(strike) < KNOWN_S)
    };
    let white = whitening.filtered(&left, 0..left.len());
    let found =
        changes(&white, &model.poles, rate_hz, fitted.noise_rms().powi(2)).into_iter().filter(|(at, _)| !is_known(*at));
    let missing: Vec<Strike> =
        found.filter_map(|(at, _)| missing_strike(&model, &left, at, rate_hz, variance)).collect();
    let is_complete = missing.is_empty() && misplaced.is_empty();
    model.strikes.extend(missing);
    model.strikes.sort_by(|a, b| a.contact.middle.total_cmp(&b.contact.middle));
    if is_complete && !are_modes_first {
        add_modes(&mut model, &left, rate_hz, settings);
    }
    model
}

/// Adds the modes that ring in what a model leaves.
fn add_modes(model: &mut Model, left: &[f64], rate_hz: f64, settings: Settings) {
    let few = Settings { most_modes: settings.most_modes.saturating_sub(model.poles.len()), ..settings };
    let loudest = model.gains.iter().flatten().map(|gain| gain.norm()).fold(0.0, f64::max);
    // Gains that differ from strike to strike have no sum that all strikes share.
    let poles = if model.places() > 1 || model.owners.iter().any(Option::is_some) {
        let onsets: Vec<usize> =
            model.strikes.iter().map(|strike| strike.contact.first_sample().max(0.0) as usize).collect();
        left_over(left, &onsets, rate_hz, few)
    } else {
        tied_modes(model, left, rate_hz, few)
    };
    for pole in poles.into_iter().take(MOST_AT_A_TIME) {
        // The first step finds the gain, which is linear.
        model.push(pole, Complex::new(1e-6 * loudest, 0.0), None);
    }
}

/// Strikes behind which far more is left than behind the others, and the noise's variance.
fn misplaced(fitted: &Fitted, rate_hz: f64) -> (Vec<usize>, f64) {
    let (powers, median) = fitted.left_behind(rate_hz);
    let loud: Vec<usize> = (0..powers.len()).filter(|&strike| powers[strike] > FAR_MORE * median).collect();
    if loud.len() * 4 > powers.len() { (Vec::new(), median) } else { (loud, median) }
}

/// The model without modes and strikes that explain too little for their numbers.
///
/// The Bayesian information criterion asks for ln N times the noise a number. Modes that decay far
/// faster than `fastest`, in 1/sample, go too.
pub(crate) fn worthy(fitted: &Fitted, whitening: &Whitening, fastest: f64) -> Option<Model> {
    let deviations = deviations(fitted, whitening)?;
    let mut model = fitted.model.clone();
    let logarithm = (fitted.residual.len() as f64).ln();
    // With positions the scale of all gains is uncertain where that of all peaks is.
    let gains = if model.places() > 1 { &deviations.held_gains } else { &deviations.gains };
    // The least spread of any place; a mode that strayed is worth nothing.
    let spreads: Vec<f64> = (gains.iter().zip(&model.poles))
        .map(|(places, pole)| {
            let spread = places.iter().copied().fold(f64::INFINITY, f64::min);
            if pole.decay < STRAYED * fastest { spread } else { f64::INFINITY }
        })
        .collect();
    let is_near = |a: usize, b: usize| {
        let (a, b) = (fitted.model.poles[a], fitted.model.poles[b]);
        (a.angular - b.angular).abs() < NEIGHBOURS * (a.decay + b.decay)
    };
    let dropped = unworthy(&spreads, 4.0 * logarithm, is_near);
    model.drop_modes(&dropped);
    if model.contact_times_are_held {
        // One set of gains explains little of strikes at several places: they were heard all the
        // same.
        return Some(model);
    }
    // With positions the scale of all peaks is uncertain, but not that a strike stands out.
    let mut spreads: Vec<f64> = deviations.strikes.iter().map(|covariance| covariance[(2, 2)].sqrt()).collect();
    if fitted.model.places() > 1 {
        spreads = deviations.held_peaks;
    }
    let strikes = &fitted.model.strikes;
    let is_near = |a: usize, b: usize| {
        (strikes[a].contact.middle - strikes[b].contact.middle).abs()
            < strikes[a].contact.time + strikes[b].contact.time
    };
    let dropped = unworthy(&spreads, 3.0 * logarithm, is_near);
    let mut places = 0..;
    model.strikes.retain(|_| !dropped.contains(&places.next().unwrap_or(0)));
    Some(model)
}

/// Indices whose energy over the noise, `1/spread²`, is below `least`, the worst first.
///
/// Two in one place are both worth nothing, so of neighbours only the worse goes at a time.
fn unworthy(spreads: &[f64], least: f64, is_near: impl Fn(usize, usize) -> bool) -> Vec<usize> {
    let is_worthy = |index: &usize| least * spreads[*index] * spreads[*index] < 1.0;
    let mut order: Vec<usize> = (0..spreads.len()).filter(|index| !is_worthy(index)).collect();
    order.sort_by(|a, b| spreads[*b].total_cmp(&spreads[*a]));
    let mut dropped: Vec<usize> = Vec::new();
    for index in order {
        if !dropped.iter().any(|other| is_near(index, *other)) {
            dropped.push(index);
        }
    }
    dropped
}
