//! First estimate of all contacts, from the changes of the modes' amplitudes.
//!
//! A strike changes the amplitude of mode k by `a_k = m g_k Q(s_k, τ) e^{-s_k δ}`, δ from a moment
//! near the strike to the middle of its contact. For a trial contact time of the strongest strike
//! its amplitudes give the gains. Then each strike is looked up on a grid over τ and δ, and gains
//! and contacts are improved in turn.

use nalgebra::{Complex, Matrix3, Vector3};
use rayon::prelude::*;

use super::contact::{Contact, strength};
use super::free::{Guard, amplitudes, energy_of, stretches};
use super::model::{Model, Strike};
use super::whitening::Whitening;
use crate::modes::Pole;

type C64 = Complex<f64>;

/// Shortest and longest contact time that is tried, in seconds.
const TIMES_S: [f64; 2] = [0.12e-3, 5e-3];
/// Number of contact times that are tried for the strongest strike.
const TRIED: usize = 20;
/// Number of contact times on a strike's own grid.
const GRID: usize = 28;
/// Reach of δ before and behind the moment, in seconds.
pub(super) const REACH_S: [f64; 2] = [3e-3, 4.5e-3];
/// Step of δ in samples.
const STEP: f64 = 0.5;
/// Error of an amplitude that is allowed for beside the noise, as a share of it.
const OWN_ERROR: f64 = 0.006;
/// Number of rounds of gains and contacts in turn, behind each look at the grid.
const ROUNDS: usize = 8;
/// Number of looks at the grid, the later ones with the gains of all strikes.
const LOOKS: usize = 2;
/// Least median over strikes of a mode's energy over the noise in an amplitude.
const STEADY: f64 = 6.0;
/// Least number of modes that contacts are started from.
const LEAST_MODES: usize = 4;

/// Change of all modes' amplitudes by a strike.
pub(super) struct Change {
    /// Moment to which the amplitudes refer, in samples.
    pub(super) at: usize,
    pub(super) amplitudes: Vec<C64>,
    /// Variances of the amplitudes, in full scale squared.
    pub(super) variances: Vec<f64>,
}

/// A whitened recording with its filter, and the variance of its noise.
pub(crate) struct White<'a> {
    pub(crate) samples: &'a [f64],
    pub(crate) whitening: &'a Whitening,
    pub(crate) variance: f64,
}

/// Starting models from the strikes near `onsets`, one for each contact time tried, with misfits.
///
/// The best fitting comes first. Strikes that are not among the usable ones are left out, and those
/// too close to their neighbours for an amplitude of their own.
pub(crate) fn starts(
    white: &White<'_>,
    (onsets, usable): (&[usize], &[usize]),
    poles: &[Pole],
    rate_hz: f64,
) -> Vec<Model> {
    let usable_changes = |poles: &[Pole]| {
        let mut changes = changes_of(white, onsets, poles, rate_hz);
        changes.retain(|change| usable.contains(&change.at));
        changes
    };
    let poles = &steady(&usable_changes(poles), poles);
    let changes = usable_changes(poles);
    let strength_of = |change: &Change| {
        change.amplitudes.iter().zip(&change.variances).map(|(a, v)| (1.0 + a.norm_sqr() / v).ln()).sum::<f64>()
    };
    let Some(strongest) =
        (0..changes.len()).max_by(|a, b| strength_of(&changes[*a]).total_cmp(&strength_of(&changes[*b])))
    else {
        return Vec::new();
    };
    let grid_of_strike = grid(GRID, rate_hz);
    let mut found: Vec<(f64, Model)> = grid(TRIED, rate_hz)
        .into_par_iter()
        .map(|time| from_trial(&changes, strongest, time, poles, &grid_of_strike, rate_hz))
        .collect();
    found.sort_by(|a, b| a.0.total_cmp(&b.0));
    found.into_iter().map(|(_, model)| model).collect()
}

/// Modes that most strikes ring; modes of one stretch alone are errors of that stretch.
fn steady(changes: &[Change], poles: &[Pole]) -> Vec<Pole> {
    let significance = |mode: usize| {
        let mut all: Vec<f64> =
            changes.iter().map(|change| change.amplitudes[mode].norm_sqr() / change.variances[mode]).collect();
        all.sort_by(f64::total_cmp);
        all.get(all.len() / 2).copied().unwrap_or(0.0)
    };
    let mut modes: Vec<(f64, Pole)> =
        poles.iter().enumerate().map(|(mode, pole)| (significance(mode), *pole)).collect();
    modes.sort_by(|a, b| b.0.total_cmp(&a.0));
    let count = modes.iter().take_while(|(significance, _)| *significance > STEADY).count();
    modes.truncate(count.max(LEAST_MODES));
    let mut steady: Vec<Pole> = modes.into_iter().map(|(_, pole)| pole).collect();
    steady.sort_by(|a, b| a.angular.total_cmp(&b.angular));
    steady
}

/// Contact of a strike that a model lacks, near a sample, from what the model leaves.
///
/// `None` if the next strike follows too soon for the modes to be heard.
pub(crate) fn missing(model: &Model, residual: &[f64], at: usize, rate_hz: f64, variance: f64) -> Option<Strike> {
    let next = model.strikes.iter().map(|strike| strike.contact.first_sample().max(0.0) as usize);
    let next = next.filter(|start| *start > at).min().unwrap_or(residual.len());
    let onsets = [at, next];
    let stretches = stretches(&onsets[..], Guard::OF_CHANGE, residual.len(), rate_hz);
    let own = amplitudes(residual, &stretches[..1], &model.poles).pop().filter(|own| !own.is_empty())?;
    let back = at as f64 - stretches[0].start as f64;
    let (mut sums, mut variances) = (Vec::new(), Vec::new());
    for (amplitude, pole) in own.iter().zip(&model.poles) {
        let back = pole.power(back);
        sums.push(amplitude * back);
        let noise = 2.0 * variance / energy_of(*pole, stretches[0].len()) * back.norm_sqr();
        variances.push(noise + (OWN_ERROR * amplitude.norm() * back.norm()).powi(2));
    }
    let change = Change { at, amplitudes: sums, variances };
    let exponents: Vec<C64> = (0..model.poles.len()).map(|mode| model.exponent(mode)).collect();
    let silent = vec![0.0; model.poles.len()];
    let times = grid(GRID, rate_hz);
    let count = if model.places() > 1 { PLACES } else { 1 };
    let strikers = model.strikes.iter().map(|strike| strike.striker).max().unwrap_or(0);
    let tried = (0..count).flat_map(|place| (0..=strikers).map(move |striker| (place, striker)));
    let of_place = |(place, striker): (usize, usize)| {
        let mut strike = Strike { contact: NOWHERE, position: place as f64 / (PLACES - 1) as f64, striker };
        let gain = |mode: usize| {
            if model.rings(mode, &strike) { model.gain(mode, strike.position) } else { C64::new(0.0, 0.0) }
        };
        let gains: Vec<C64> = (0..model.poles.len()).map(gain).collect();
        let mut contact = on_grid(&change, &gains, &silent, &exponents, &times, rate_hz);
        (0..3).for_each(|_| improve(&mut contact, &change, &gains, &exponents));
        let left = misfit(&contact, &change, &gains, &exponents);
        strike.contact = Contact { middle: contact.middle + at as f64, ..contact };
        (left, strike)
    };
    let found: Vec<(f64, Strike)> = tried.collect::<Vec<_>>().into_par_iter().map(of_place).collect();
    found.into_iter().min_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, strike)| strike)
}

/// Number of positions at which a missing strike is tried.
const PLACES: usize = 13;
/// Contact of a strike that is not yet looked for.
const NOWHERE: Contact = Contact { middle: 0.0, time: 1.0, peak: 0.0 };

/// Contact times in samples that are tried.
pub(super) fn grid(count: usize, rate_hz: f64) -> Vec<f64> {
    let tried = |index: usize| rate_hz * TIMES_S[0] * (TIMES_S[1] / TIMES_S[0]).powf(index as f64 / (count - 1) as f64);
    (0..count).map(tried).collect()
}

/// Changes of amplitudes by the strikes near `onsets`, from the whitened recording.
///
/// Strikes too close to their neighbours for an amplitude of their own are left out.
pub(super) fn changes_of(white: &White<'_>, onsets: &[usize], poles: &[Pole], rate_hz: f64) -> Vec<Change> {
    let variance = white.variance;
    let stretches = stretches(onsets, Guard::OF_CHANGE, white.samples.len(), rate_hz);
    let amplitudes = amplitudes(white.samples, &stretches, poles);
    let responses: Vec<C64> = poles.iter().map(|&pole| white.whitening.response(pole)[0]).collect();
    let mut changes = Vec::new();
    // Stretch before the strike whose amplitudes are known.
    let mut before: Option<usize> = None;
    for (index, &at) in onsets.iter().enumerate() {
        let Some(own) = amplitudes.get(index).filter(|own| !own.is_empty()) else {
            before = None;
            continue;
        };
        let is_alone = index == 0 || before == Some(index - 1);
        let (mut sums, mut variances) = (Vec::with_capacity(poles.len()), Vec::with_capacity(poles.len()));
        for (mode, pole) in poles.iter().enumerate() {
            let back = pole.power(at as f64 - stretches[index].start as f64);
            let own_variance = 2.0 * variance / energy_of(*pole, stretches[index].len()) * back.norm_sqr();
            let (mut sum, mut both) = (own[mode] * back, own_variance);
            if let Some(before) = before {
                let ahead = pole.power(at as f64 - stretches[before].start as f64);
                sum -= amplitudes[before][mode] * ahead;
                both += 2.0 * variance / energy_of(*pole, stretches[before].len()) * ahead.norm_sqr();
            }
            variances.push(both + (OWN_ERROR * own[mode].norm() * back.norm()).powi(2));
            sums.push(sum);
        }
        before = Some(index);
        // The filter scales each mode.
        sums.iter_mut().zip(&responses).for_each(|(sum, response)| *sum /= response);
        variances.iter_mut().zip(&responses).for_each(|(variance, response)| *variance /= response.norm_sqr());
        if is_alone {
            changes.push(Change { at, amplitudes: sums, variances });
        }
    }
    changes
}

/// Model for a trial contact time of the strongest strike, with its misfit.
fn from_trial(
    changes: &[Change],
    strongest: usize,
    time: f64,
    poles: &[Pole],
    grid: &[f64],
    rate_hz: f64,
) -> (f64, Model) {
    let exponents: Vec<C64> = poles.iter().map(|pole| C64::new(-pole.decay, pole.angular)).collect();
    let loud = &changes[strongest];
    let mut gains: Vec<C64> =
        loud.amplitudes.iter().zip(&exponents).map(|(a, s)| a / strength(*s, time).value).collect();
    let mut spreads: Vec<f64> =
        loud.variances.iter().zip(&exponents).map(|(v, s)| v / strength(*s, time).value.norm_sqr()).collect();
    // δ of the strongest strike is 0: its gains hold the phases, which turn all δ by one amount.
    let (mut contacts, mut misfit) = (Vec::new(), f64::INFINITY);
    for round in 0..LOOKS * ROUNDS {
        if round % ROUNDS == 0 {
            let look = |change: &Change| on_grid(change, &gains, &spreads, &exponents, grid, rate_hz);
            contacts = changes.iter().map(look).collect::<Vec<Contact>>();
            // The next look has gains of all strikes.
            spreads.fill(0.0);
        }
        contacts.iter_mut().zip(changes).for_each(|(contact, change)| improve(contact, change, &gains, &exponents));
        let mut left = 0.0;
        for (mode, gain) in gains.iter_mut().enumerate() {
            let (mut along, mut size, mut energy) = (C64::new(0.0, 0.0), 1e-300, 0.0);
            for (contact, change) in contacts.iter().zip(changes) {
                let shape = shape(contact, exponents[mode]);
                let weight = 1.0 / change.variances[mode];
                along += shape.conj() * change.amplitudes[mode] * weight;
                size += shape.norm_sqr() * weight;
                energy += change.amplitudes[mode].norm_sqr() * weight;
            }
            *gain = along / size;
            left += energy - along.norm_sqr() / size;
        }
        misfit = left;
    }
    let strikes = contacts.iter().zip(changes).map(|(contact, change)| Strike {
        contact: Contact { middle: change.at as f64 + contact.middle, ..*contact },
        position: 0.0,
        striker: 0,
    });
    let mut model = Model {
        poles: poles.to_vec(),
        gains: gains.into_iter().map(|gain| vec![gain]).collect(),
        owners: vec![None; poles.len()],
        acceleration: 0.0,
        contact_times_are_held: false,
        strikes: strikes.collect(),
    };
    model.strikes.sort_by(|a, b| a.contact.middle.total_cmp(&b.contact.middle));
    model.normalise();
    (misfit, model)
}

/// Amplitude of a mode of gain 1 at the moment, by a contact whose middle counts from there.
fn shape(contact: &Contact, exponent: C64) -> C64 {
    strength(exponent, contact.time).value * (-exponent * contact.middle).exp() * contact.peak
}

/// Contact that explains most of a change, on a grid over contact time and middle.
fn on_grid(change: &Change, gains: &[C64], spreads: &[f64], exponents: &[C64], grid: &[f64], rate_hz: f64) -> Contact {
    let energy: f64 = change.amplitudes.iter().map(C64::norm_sqr).sum();
    let steps = ((REACH_S[0] + REACH_S[1]) * rate_hz / STEP) as usize;
    let turns: Vec<C64> = exponents.iter().map(|s| C64::new(0.0, s.im * STEP).exp()).collect();
    let mut best = (0.0, Contact { middle: 0.0, time: grid[0], peak: 1e-9 });
    for &time in grid {
        let shapes: Vec<C64> = exponents.iter().zip(gains).map(|(s, gain)| gain * strength(*s, time).value).collect();
        let loudness = energy / shapes.iter().map(C64::norm_sqr).sum::<f64>().max(1e-300);
        let strengths = exponents.iter().map(|s| strength(*s, time).value.norm_sqr());
        let weights: Vec<f64> = (change.variances.iter().zip(spreads).zip(strengths))
            .map(|((variance, spread), strength)| 1.0 / (variance + loudness * spread * strength))
            .collect();
        let size: f64 = shapes.iter().zip(&weights).map(|(shape, weight)| shape.norm_sqr() * weight).sum();
        let mut along: Vec<C64> = (change.amplitudes.iter().zip(&shapes).zip(&weights).zip(exponents))
            .map(|(((a, shape), weight), s)| {
                a * shape.conj() * *weight * C64::new(0.0, -s.im * REACH_S[0] * rate_hz).exp()
            })
            .collect();
        for step in 0..steps {
            let sum: f64 = along.iter().map(|x| x.re).sum();
            if sum > 0.0 && sum * sum / size > best.0 {
                let middle = step as f64 * STEP - REACH_S[0] * rate_hz;
                best = (sum * sum / size, Contact { middle, time, peak: sum / size });
            }
            along.iter_mut().zip(&turns).for_each(|(x, turn)| *x *= turn);
        }
    }
    best.1
}

/// Remainder of a change behind a contact, in units of its variances.
fn misfit(contact: &Contact, change: &Change, gains: &[C64], exponents: &[C64]) -> f64 {
    (change.amplitudes.iter().zip(&change.variances).zip(gains).zip(exponents))
        .map(|(((a, variance), gain), s)| (a - gain * shape(contact, *s)).norm_sqr() / variance)
        .sum()
}

/// Two damped Gauss-Newton steps of a contact's middle, ln τ and ln m at given gains.
fn improve(contact: &mut Contact, change: &Change, gains: &[C64], exponents: &[C64]) {
    let mut now = misfit(contact, change, gains, exponents);
    let mut damping = 1e-3;
    for _ in 0..4 {
        let (mut normal, mut right) = (Matrix3::<f64>::zeros(), Vector3::<f64>::zeros());
        for (((a, variance), gain), s) in change.amplitudes.iter().zip(&change.variances).zip(gains).zip(exponents) {
            let value = gain * shape(contact, *s);
            let strength = strength(*s, contact.time);
            let slopes = [-s * value, value * strength.by_time / strength.value * contact.time, value];
            let left = a - value;
            for (i, slope) in slopes.iter().enumerate() {
                right[i] += (slope.conj() * left).re / variance;
                for (j, other) in slopes.iter().enumerate() {
                    normal[(i, j)] += (slope.conj() * other).re / variance;
                }
            }
        }
        (0..3).for_each(|index| normal[(index, index)] *= 1.0 + damping);
        let Some(step) = normal.cholesky().map(|factor| factor.solve(&right)) else { return };
        let reach = 0.2 * contact.time;
        let next = Contact {
            middle: contact.middle + step[0].clamp(-reach, reach),
            time: contact.time * step[1].clamp(-0.3, 0.3).exp(),
            peak: contact.peak * step[2].clamp(-0.7, 0.7).exp(),
        };
        let then = misfit(&next, change, gains, exponents);
        if then < now {
            (*contact, now) = (next, then);
            damping *= 0.1;
        } else {
            damping = (damping * 10.0).max(1e-3);
        }
    }
}
