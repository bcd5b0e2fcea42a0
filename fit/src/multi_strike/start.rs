//! First estimate of all contacts, from the changes of the modes' amplitudes.
//!
//! A strike changes the amplitude of mode k by `a_k = m g_k Q(s_k, τ) e^{-s_k δ}`, δ from a moment
//! near the strike to the middle of its contact. For a trial contact time of the strongest strike
//! its amplitudes give the gains. Then each strike is looked up on a grid over τ and δ, and gains
//! and contacts are improved in turn.

use nalgebra::{Complex, Matrix3, Vector3};
use rayon::prelude::*;

use super::amplitudes::{Change, OWN_ERROR, Told, White, changes_of, spreads};
use super::contact::{Contact, Response, strength};
use super::free::{Guard, amplitudes, stretches};
use super::model::{Model, Strike};
use crate::modes::Pole;

type C64 = Complex<f64>;

/// Shortest and longest contact time that is tried, in seconds.
const TIMES_S: [f64; 2] = [0.12e-3, 5e-3];
/// Number of contact times of the strongest strike at which all strikes are looked up.
const TRIED: usize = 40;
/// Number of contact times on either side of each to which the strikes are followed.
const FOLLOWED: i32 = 2;
/// Ratio of neighbouring contact times. A mode of 5 kHz is not rung by contacts of 0.9 or 1.1 ms,
/// but by those of 1 ms: coarser steps miss the right time.
const FINER: f64 = 1.0193;
/// Number of contact times on a strike's own grid.
const GRID: usize = 28;
/// Reach of δ before and behind the moment, in seconds.
pub(super) const REACH_S: [f64; 2] = [3e-3, 4.5e-3];
/// Number of the best contact times of a strike's own grid that are improved.
const LOOKED_AT: usize = 5;
/// Number of times that each of them is improved.
const IMPROVED: usize = 3;
/// Step of δ in samples.
const STEP: f64 = 0.5;
/// Number of rounds of gains and contacts in turn, behind each look and each step from it.
const ROUNDS: usize = 8;
/// Number of looks at the grid, the later ones with the gains of all strikes.
const LOOKS: usize = 2;
/// Least median over strikes of a mode's energy over the noise in an amplitude.
const STEADY: f64 = 6.0;
/// Least number of modes that contacts are started from.
const LEAST_MODES: usize = 4;

/// Starting models of the strikes near `onsets`, the best first: one for each contact time tried.
///
/// Gains are at first those of one strike: the strongest, or in later attempts the next strong one.
/// Strikes that are not usable are left out, and those too close to their neighbours for an
/// amplitude of their own.
pub(crate) fn starts(
    white: &White<'_>,
    (onsets, usable): (&[usize], &[usize]),
    poles: &[Pole],
    rate_hz: f64,
    attempt: usize,
) -> Vec<Model> {
    // The second start differs in kind.
    let told = if attempt == 1 { Told::Alone } else { Told::Together };
    let usable_changes = |poles: &[Pole]| {
        let mut changes = changes_of(white, onsets, poles, rate_hz, told);
        changes.retain(|change| usable.contains(&change.at));
        changes
    };
    let poles = &steady(&usable_changes(poles), poles);
    let changes = usable_changes(poles);
    let strength_of = |change: &Change| {
        change.amplitudes.iter().zip(&change.variances).map(|(a, v)| (1.0 + a.norm_sqr() / v).ln()).sum::<f64>()
    };
    let strengths: Vec<f64> = changes.iter().map(strength_of).collect();
    let Some(first) = strongest_but(&strengths, attempt) else { return Vec::new() };
    let looked_at = Grid::new(exponents_of(poles), rate_hz);
    let mut found: Vec<(f64, Model)> = grid(TRIED, rate_hz)
        .into_par_iter()
        .flat_map_iter(|time| from_trial(&changes, first, time, poles, &looked_at))
        .collect();
    found.sort_by(|a, b| a.0.total_cmp(&b.0));
    found.into_iter().map(|(_, model)| model).collect()
}

/// Index of the value that `others` values exceed.
pub(super) fn strongest_but(values: &[f64], others: usize) -> Option<usize> {
    let mut order: Vec<usize> = (0..values.len()).collect();
    order.sort_by(|a, b| values[*b].total_cmp(&values[*a]));
    order.get(others).copied()
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
    let stretches = stretches(&[at, next], Guard::OF_CHANGE, residual.len(), rate_hz);
    let own = amplitudes(residual, &stretches[..1], &model.poles).pop().filter(|own| !own.is_empty())?;
    let back = at as f64 - stretches[0].start as f64;
    let (mut sums, mut variances) = (Vec::new(), Vec::new());
    for ((amplitude, pole), spread) in
        own.iter().zip(&model.poles).zip(spreads(&model.poles, stretches[0].len(), Told::Alone))
    {
        let back = pole.power(back);
        sums.push(amplitude * back);
        let noise = variance * spread * back.norm_sqr();
        variances.push(noise + (OWN_ERROR * amplitude.norm() * back.norm()).powi(2));
    }
    let change = Change { at, amplitudes: sums, variances };
    let looked_at = Grid::new(exponents_of(&model.poles), rate_hz);
    let silent = vec![0.0; model.poles.len()];
    let count = if model.places() > 1 { PLACES } else { 1 };
    let strikers = model.strikes.iter().map(|strike| strike.striker).max().unwrap_or(0);
    let tried = (0..count).flat_map(|place| (0..=strikers).map(move |striker| (place, striker)));
    let of_place = |(place, striker): (usize, usize)| {
        let mut strike = Strike { contact: NOWHERE, position: place as f64 / (PLACES - 1) as f64, striker };
        let gain = |mode: usize| {
            if model.rings(mode, &strike) { model.gain(mode, strike.position) } else { C64::new(0.0, 0.0) }
        };
        let gains: Vec<C64> = (0..model.poles.len()).map(gain).collect();
        let mut contact = looked_at.best(&change, &gains, &silent);
        let left = looked_at.improve(&mut contact, &change, &gains);
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

/// Models for contact times of the strike `first` near a trial one, with their misfits.
///
/// All strikes are looked up on the grid at the trial time, and followed from there to the others.
fn from_trial(changes: &[Change], first: usize, time: f64, poles: &[Pole], grid: &Grid) -> Vec<(f64, Model)> {
    let loud = &changes[first];
    let strengths: Vec<C64> = grid.exponents.iter().map(|s| strength(*s, time).value).collect();
    let mut gains: Vec<C64> = loud.amplitudes.iter().zip(&strengths).map(|(a, strength)| a / strength).collect();
    let mut spreads: Vec<f64> = loud.variances.iter().zip(&strengths).map(|(v, s)| v / s.norm_sqr()).collect();
    // δ of the first strike is 0: its gains hold the phases, which turn all δ by one amount.
    let (mut contacts, mut left) = (Vec::new(), f64::INFINITY);
    for _ in 0..LOOKS {
        contacts = changes.iter().map(|change| grid.best(change, &gains, &spreads)).collect::<Vec<Contact>>();
        left = grid.in_turn(&mut contacts, changes, &mut gains);
        // The next look has gains of all strikes.
        spreads.fill(0.0);
    }
    let mut found = vec![(left, model_of(changes, poles, &contacts, &gains))];
    for factor in [FINER, 1.0 / FINER] {
        let (mut contacts, mut gains) = (contacts.clone(), gains.clone());
        for step in 1..=FOLLOWED {
            let all_longer = (time * factor.powi(step)).powi(2) - contacts[first].time.powi(2);
            contacts.iter_mut().for_each(|contact| grid.lengthen(contact, all_longer));
            grid.fit_gains(&contacts, changes, &mut gains);
            let left = grid.in_turn(&mut contacts, changes, &mut gains);
            found.push((left, model_of(changes, poles, &contacts, &gains)));
        }
    }
    found
}

/// Model of modes and of the contacts of changes.
fn model_of(changes: &[Change], poles: &[Pole], contacts: &[Contact], gains: &[C64]) -> Model {
    let strikes = contacts.iter().zip(changes).map(|(contact, change)| Strike {
        contact: Contact { middle: change.at as f64 + contact.middle, ..*contact },
        position: 0.0,
        striker: 0,
    });
    let mut model = Model {
        poles: poles.to_vec(),
        gains: gains.iter().map(|gain| vec![*gain]).collect(),
        owners: vec![None; poles.len()],
        acceleration: 0.0,
        contact_times_are_held: false,
        strikes: strikes.collect(),
    };
    model.strikes.sort_by(|a, b| a.contact.middle.total_cmp(&b.contact.middle));
    model.normalise();
    model
}

/// Amplitude of a mode of gain 1 at the moment, by a contact whose middle counts from there.
fn shape(contact: &Contact, exponent: C64) -> C64 {
    strength(exponent, contact.time).value * (-exponent * contact.middle).exp() * contact.peak
}

/// Exponents `s = -d + jω` of poles.
fn exponents_of(poles: &[Pole]) -> Vec<C64> {
    poles.iter().map(|pole| C64::new(-pole.decay, pole.angular)).collect()
}

/// Contact times that are tried for a strike, with the strength of each mode at each of them.
struct Grid {
    exponents: Vec<C64>,
    times: Vec<f64>,
    strengths: Vec<Vec<C64>>,
    /// Reach of the middle before and behind the moment, in samples.
    reach: [f64; 2],
}

impl Grid {
    fn new(exponents: Vec<C64>, rate_hz: f64) -> Self {
        let times = grid(GRID, rate_hz);
        let strengths =
            times.iter().map(|time| exponents.iter().map(|s| strength(*s, *time).value).collect()).collect();
        Self { exponents, times, strengths, reach: REACH_S.map(|reach| reach * rate_hz) }
    }

    /// Contact that explains most of a change.
    fn best(&self, change: &Change, gains: &[C64], spreads: &[f64]) -> Contact {
        let energy: f64 = change.amplitudes.iter().map(C64::norm_sqr).sum();
        let steps = ((self.reach[0] + self.reach[1]) / STEP) as usize;
        let turns: Vec<C64> = self.exponents.iter().map(|s| C64::new(0.0, s.im * STEP).exp()).collect();
        let first: Vec<C64> = self.exponents.iter().map(|s| C64::new(0.0, -s.im * self.reach[0]).exp()).collect();
        let nothing = Contact { middle: 0.0, time: self.times[0], peak: 1e-9 };
        let mut best = vec![(0.0, nothing); self.times.len()];
        for ((&time, strengths), best) in self.times.iter().zip(&self.strengths).zip(&mut best) {
            let shapes: Vec<C64> = gains.iter().zip(strengths).map(|(gain, strength)| gain * strength).collect();
            let loudness = energy / shapes.iter().map(C64::norm_sqr).sum::<f64>().max(1e-300);
            let weights: Vec<f64> = (change.variances.iter().zip(spreads).zip(strengths))
                .map(|((variance, spread), strength)| 1.0 / (variance + loudness * spread * strength.norm_sqr()))
                .collect();
            let size: f64 = shapes.iter().zip(&weights).map(|(shape, weight)| shape.norm_sqr() * weight).sum();
            let mut along: Vec<C64> = (change.amplitudes.iter().zip(&shapes).zip(&weights).zip(&first))
                .map(|(((a, shape), weight), first)| a * shape.conj() * *weight * first)
                .collect();
            for step in 0..steps {
                let sum: f64 = along.iter().map(|x| x.re).sum();
                if sum > 0.0 && sum * sum / size > best.0 {
                    let middle = step as f64 * STEP - self.reach[0];
                    *best = (sum * sum / size, Contact { middle, time, peak: sum / size });
                }
                along.iter_mut().zip(&turns).for_each(|(x, turn)| *x *= turn);
            }
        }
        // The steps of the grid may be longer than the way from one minimum to the next.
        best.sort_by(|a, b| b.0.total_cmp(&a.0));
        let improved = |(_, mut contact): (f64, Contact)| {
            let left = (0..IMPROVED).fold(f64::INFINITY, |_, _| self.improve(&mut contact, change, gains));
            (left, contact)
        };
        let found = best.into_iter().take(LOOKED_AT).map(improved).min_by(|a, b| a.0.total_cmp(&b.0));
        found.map_or(nothing, |(_, contact)| contact)
    }

    /// Improves contacts and gains in turn; returns what is left of the changes, in units of their
    /// variances.
    fn in_turn(&self, contacts: &mut [Contact], changes: &[Change], gains: &mut [C64]) -> f64 {
        let mut left = f64::INFINITY;
        for _ in 0..ROUNDS {
            for (contact, change) in contacts.iter_mut().zip(changes) {
                self.improve(contact, change, gains);
            }
            left = self.fit_gains(contacts, changes, gains);
        }
        left
    }

    /// Fits gains to the changes of contacts; returns what is left of the changes.
    fn fit_gains(&self, contacts: &[Contact], changes: &[Change], gains: &mut [C64]) -> f64 {
        let mut left = 0.0;
        for (mode, gain) in gains.iter_mut().enumerate() {
            let (mut along, mut size, mut energy) = (C64::new(0.0, 0.0), 1e-300, 0.0);
            for (contact, change) in contacts.iter().zip(changes) {
                let shape = shape(contact, self.exponents[mode]);
                let weight = 1.0 / change.variances[mode];
                along += shape.conj() * change.amplitudes[mode] * weight;
                size += shape.norm_sqr() * weight;
                energy += change.amplitudes[mode].norm_sqr() * weight;
            }
            *gain = along / size;
            left += energy - along.norm_sqr() / size;
        }
        left
    }

    /// Lengthens a contact by an amount of its squared time, with the ringing that it has.
    ///
    /// Slow modes tell the squares of contact times up to a constant.
    fn lengthen(&self, contact: &mut Contact, by: f64) {
        let longest = self.times[self.times.len() - 1];
        let time = (contact.time * contact.time + by).max(0.0).sqrt().clamp(self.times[0], longest);
        contact.peak *= contact.time / time;
        contact.time = time;
    }

    /// Damped Gauss-Newton steps of a contact's middle, ln τ and ln m at given gains, within the
    /// grid's times; returns what is left of the change, in units of its variances.
    fn improve(&self, contact: &mut Contact, change: &Change, gains: &[C64]) -> f64 {
        let mut shapes = self.shapes(contact, gains);
        let mut now = misfit(&shapes, change);
        let mut damping = 1e-3;
        for _ in 0..4 {
            let (mut normal, mut right) = (Matrix3::<f64>::zeros(), Vector3::<f64>::zeros());
            for (((a, variance), (value, strength)), s) in
                change.amplitudes.iter().zip(&change.variances).zip(&shapes).zip(&self.exponents)
            {
                let slopes = [-s * value, value * strength.by_time / strength.value * contact.time, *value];
                let left = a - value;
                for (i, slope) in slopes.iter().enumerate() {
                    right[i] += (slope.conj() * left).re / variance;
                    for (j, other) in slopes.iter().enumerate() {
                        normal[(i, j)] += (slope.conj() * other).re / variance;
                    }
                }
            }
            (0..3).for_each(|index| normal[(index, index)] *= 1.0 + damping);
            let Some(step) = normal.cholesky().map(|factor| factor.solve(&right)) else { break };
            let reach = 0.2 * contact.time;
            let grown = contact.time * step[1].clamp(-0.3, 0.3).exp();
            let next = Contact {
                middle: contact.middle + step[0].clamp(-reach, reach),
                time: grown.clamp(self.times[0], self.times[self.times.len() - 1]),
                peak: contact.peak * step[2].clamp(-0.7, 0.7).exp(),
            };
            let moved = self.shapes(&next, gains);
            let then = misfit(&moved, change);
            if then < now {
                (*contact, shapes, now) = (next, moved, then);
                damping *= 0.1;
            } else {
                damping = (damping * 10.0).max(1e-3);
            }
        }
        now
    }

    /// Amplitude of each mode by a contact, and the contact's strength.
    fn shapes(&self, contact: &Contact, gains: &[C64]) -> Vec<(C64, Response)> {
        let of_mode = |(s, gain): (&C64, &C64)| {
            let strength = strength(*s, contact.time);
            (gain * strength.value * (-s * contact.middle).exp() * contact.peak, strength)
        };
        self.exponents.iter().zip(gains).map(of_mode).collect()
    }
}

/// Remainder of a change behind a contact's amplitudes, in units of the change's variances.
fn misfit(shapes: &[(C64, Response)], change: &Change) -> f64 {
    (change.amplitudes.iter().zip(&change.variances).zip(shapes))
        .map(|((a, variance), (shape, _))| (a - shape).norm_sqr() / variance)
        .sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::multi_strike::synthetic::plain;
    use crate::multi_strike::truth::model_of;
    use crate::multi_strike::whitening::Whitening;

    #[test]
    fn modes_that_are_not_there_beside_true_ones_spoil_no_contacts() {
        let sound = plain(8, 6.0, 10, -60.0);
        let truth = model_of(&sound);
        let mut poles = truth.poles.clone();
        for pole in &truth.poles[..3] {
            poles.push(Pole { decay: 0.05 * pole.decay, angular: 1.004 * pole.angular });
        }
        let onsets: Vec<usize> = sound.strikes.iter().map(|strike| (strike.at_s * sound.rate_hz) as usize).collect();
        let whitening = Whitening::none();
        let white = White { samples: &sound.samples, whitening: &whitening, variance: sound.noise_rms.powi(2) };
        let error = |model: &Model| {
            let pairs = model.strikes.iter().zip(&truth.strikes);
            let mut apart: Vec<f64> = pairs.map(|(a, b)| (a.contact.time / b.contact.time).ln().abs()).collect();
            apart.sort_by(f64::total_cmp);
            apart[apart.len() / 2]
        };
        let found = starts(&white, (&onsets, &onsets), &poles, sound.rate_hz, 0);
        assert!(found.iter().all(|model| model.strikes.len() == 10));
        let least = found.iter().map(error).fold(f64::INFINITY, f64::min);
        assert!(least < 0.05, "contact times of the best start are wrong by {least}");
    }
}
