//! Strikers told apart by their contact laws, and the modes that are a striker's own.

use nalgebra::{Complex, DMatrix, DVector};

use super::amplitudes::Change;
use super::contact::strength;
use super::model::{Model, Strike};
use super::spline::Weights;

type C64 = Complex<f64>;

/// Slope of ln τ over ln m by which contacts of one striker are compared: Hertz' -0.2 over 1.2.
const SLOPE: f64 = -1.0 / 6.0;
/// Maximum number of rounds of means and members in turn.
const ROUNDS: usize = 30;
/// Error of a modelled amplitude that is allowed for beside its own, as a share of it.
const MODEL_ERROR: f64 = 0.1;
/// Largest decay of a mode, in nepers, over the time in which a contact is looked for.
///
/// The amplitude of a faster mode behind a contact is not told by what is left of it later.
const MOST_FADED: f64 = 3.0;
/// Time in samples from a change to the strike that made it, at most, as a share of the rate.
const NEAR_S: f64 = 0.008;

/// Striker of each strike, from 0 for the hardest one on.
///
/// Contacts of one striker have `τ = τ1 m^(-1/6)`, of which the logarithms of τ1 form groups
/// (Lloyd's algorithm in one dimension).
pub(crate) fn told_apart(strikes: &[Strike], count: usize) -> Vec<usize> {
    let values: Vec<f64> =
        strikes.iter().map(|strike| strike.contact.time.ln() - SLOPE * strike.contact.peak.max(1e-12).ln()).collect();
    let mut sorted = values.clone();
    sorted.sort_by(f64::total_cmp);
    let quantile = |share: f64| sorted.get((share * sorted.len() as f64) as usize).copied().unwrap_or(0.0);
    let mut means: Vec<f64> = (0..count).map(|group| quantile((group as f64 + 0.5) / count as f64)).collect();
    let nearest = |means: &[f64], value: f64| {
        (0..means.len()).min_by(|a, b| (means[*a] - value).abs().total_cmp(&(means[*b] - value).abs())).unwrap_or(0)
    };
    for _ in 0..ROUNDS {
        for (group, mean) in means.clone().iter().enumerate() {
            // The median of a group stands still when a few of its strikes are wrong.
            let members: Vec<f64> = sorted.iter().copied().filter(|value| nearest(&means, *value) == group).collect();
            means[group] = members.get(members.len() / 2).copied().unwrap_or(*mean);
        }
    }
    values.into_iter().map(|value| nearest(&means, value)).collect()
}

/// The model with its strikers told apart anew, and each mode given to the object or a striker.
///
/// A mode's amplitudes follow gains along the object, or one gain under one striker and silence
/// under the others. The Bayesian information criterion decides.
pub(crate) fn assigned(model: &Model, changes: &[Change], count: usize, places: usize, rate_hz: f64) -> Model {
    let mut assigned = model.clone();
    if count < 2 {
        return assigned;
    }
    let strikers = told_apart(&model.strikes, count);
    assigned.strikes.iter_mut().zip(strikers).for_each(|(strike, striker)| strike.striker = striker);
    let pairs: Vec<(&Change, &Strike)> =
        changes.iter().filter_map(|change| Some((change, made_by(change, &assigned.strikes, rate_hz)?))).collect();
    let owned: Vec<(Option<usize>, Vec<C64>)> =
        (0..model.poles.len()).map(|mode| owner(&pairs, mode, model.exponent(mode), count, places)).collect();
    for (mode, (owner, gains)) in owned.into_iter().enumerate() {
        let is_told = model.poles[mode].decay * NEAR_S * rate_hz < MOST_FADED;
        if is_told && owner != assigned.owners[mode] {
            (assigned.owners[mode], assigned.gains[mode]) = (owner, gains);
        }
    }
    assigned
}

fn made_by<'a>(change: &Change, strikes: &'a [Strike], rate_hz: f64) -> Option<&'a Strike> {
    let apart = |strike: &&Strike| (strike.contact.middle - change.at as f64).abs();
    strikes.iter().min_by(|a, b| apart(a).total_cmp(&apart(b))).filter(|strike| apart(strike) < NEAR_S * rate_hz)
}

/// Owner of a mode, and the mode's gains under that owner.
fn owner(
    pairs: &[(&Change, &Strike)],
    mode: usize,
    exponent: C64,
    count: usize,
    places: usize,
) -> (Option<usize>, Vec<C64>) {
    // Amplitude for a gain of 1, amplitude and weight of each strike.
    let seen: Vec<(C64, C64, f64, &Strike)> = pairs
        .iter()
        .map(|(change, strike)| {
            let since = change.at as f64 - strike.contact.middle;
            let shape = strength(exponent, strike.contact.time).value * (exponent * since).exp() * strike.contact.peak;
            let amplitude = change.amplitudes[mode];
            let weight = 1.0 / (change.variances[mode] + MODEL_ERROR * MODEL_ERROR * amplitude.norm_sqr());
            (shape, amplitude, weight, *strike)
        })
        .collect();
    let cost = (pairs.len().max(2) as f64).ln();
    let (along, misfit) = along_object(&seen, places);
    let mut best = (misfit + 2.0 * places as f64 * cost, None, along);
    for striker in 0..count {
        let (mut sum, mut size, mut energy) = (C64::new(0.0, 0.0), 1e-300, 0.0);
        for (shape, amplitude, weight, strike) in &seen {
            energy += weight * amplitude.norm_sqr();
            if strike.striker == striker {
                sum += shape.conj() * amplitude * *weight;
                size += shape.norm_sqr() * weight;
            }
        }
        let misfit = energy - sum.norm_sqr() / size + 2.0 * cost;
        if misfit < best.0 {
            best = (misfit, Some(striker), vec![sum / size]);
        }
    }
    (best.1, best.2)
}

/// Gains along the object that explain a mode's amplitudes best, and what they leave.
fn along_object(seen: &[(C64, C64, f64, &Strike)], places: usize) -> (Vec<C64>, f64) {
    let mut normal = DMatrix::<f64>::zeros(places, places);
    let mut right = [DVector::<f64>::zeros(places), DVector::<f64>::zeros(places)];
    for (shape, amplitude, weight, strike) in seen {
        let weights = Weights::at(strike.position, places);
        let along = shape.conj() * amplitude * *weight;
        for (a, x) in weights.values().iter().enumerate() {
            right[0][weights.first + a] += along.re * x;
            right[1][weights.first + a] += along.im * x;
            for (b, y) in weights.values().iter().enumerate() {
                normal[(weights.first + a, weights.first + b)] += shape.norm_sqr() * weight * x * y;
            }
        }
    }
    let ridge = 1e-6 * normal.trace() + f64::MIN_POSITIVE;
    (0..places).for_each(|index| normal[(index, index)] += ridge);
    let Some(factor) = normal.cholesky() else { return (vec![C64::new(0.0, 0.0); places], f64::INFINITY) };
    let [re, im] = right.map(|right| factor.solve(&right));
    let gains: Vec<C64> = re.iter().zip(&im).map(|(re, im)| C64::new(*re, *im)).collect();
    let misfit = |(shape, amplitude, weight, strike): &(C64, C64, f64, &Strike)| {
        (amplitude - shape * Weights::at(strike.position, places).sum(&gains)).norm_sqr() * weight
    };
    let misfit = seen.iter().map(misfit).sum();
    (gains, misfit)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::multi_strike::amplitudes::{Told, White, changes_of};
    use crate::multi_strike::synthetic::at_places;
    use crate::multi_strike::truth::model_of;
    use crate::multi_strike::whitening::Whitening;

    #[test]
    fn strikers_and_their_own_modes_are_told_of_true_contacts() {
        let sound = at_places(2, 20.0, 30);
        let truth = model_of(&sound);
        let onsets: Vec<usize> = sound.strikes.iter().map(|strike| (strike.at_s * sound.rate_hz) as usize).collect();
        let whitening = Whitening::none();
        let white = White { samples: &sound.samples, whitening: &whitening, variance: sound.noise_rms.powi(2) };
        let changes = changes_of(&white, &onsets, &truth.poles, sound.rate_hz, Told::Together);
        let mut model = truth.clone();
        model.owners.fill(None);
        model.strikes.iter_mut().for_each(|strike| strike.striker = 0);
        let found = assigned(&model, &changes, 2, truth.places(), sound.rate_hz);
        let right = found.strikes.iter().zip(&truth.strikes).filter(|(a, b)| a.striker == b.striker).count();
        assert!(right >= 29, "{right} of 30");
        assert_eq!(found.owners, truth.owners);
    }
}
