//! Modes and noise of one strike, as near to the recording as an ear tells.
//!
//! 1. Subbands give candidates; those that explain most loudness are chosen.
//! 2. Joint least squares give the gains of the chosen modes.
//! 3. The rest of the sound gives the noise bands.
//! 4. A descent moves modes and noise bands together.

use nalgebra::Complex;

use super::audible::{Chosen, are_one};
use super::loudest::with_partials;
use super::noise::noise_of;
use crate::band::usual_edges_hz;
use crate::distance::Background;
use crate::hearing::{Loudness, Partial, Partials};
use crate::joint::{Descent, HELD, LOUDEST, Sounding, cancel};
use crate::modes::{
    Basis, DampedSine, Ending, Gains, Group, Model, Pole, Settings, Stretch, candidates, estimate_poles, explains,
    filled, refine,
};

/// Share of a strike's energy that audible modes leave, below which modes may explain all of it.
const LITTLE: f64 = 0.03;
/// Gain of a mode relative to the strongest below which a table does not hold it: 93 dB.
const SOFTEST: f64 = 2.2e-5;
/// Maximum number of times that modes are dropped because they cancel.
const ROUNDS: usize = 4;
/// Number of parts of a residual that are compared to tell noise from sound.
const PARTS: usize = 10;
/// Number of steps of the descent.
const STEPS: usize = 150;
/// Number of steps after which the nearest of several starts is known.
const PROBING: usize = 15;
/// Length of the strike whose loudness is compared, in seconds.
const LONGEST_S: f64 = 4.0;
/// Ridge of the least squares with which the descent begins: modes that are nearly alike share
/// what they explain.
const RIDGE: f64 = 2e-3;
/// Length of the sound in which modes are refined, in seconds.
const REFINED_S: f64 = 2.0;
/// Number of steps of each refinement.
const REFINING: usize = 5;
/// Lengths in seconds over which the modes of a long sound are refined once more.
const LONGER_S: [f64; 2] = [4.0, 8.0];
/// Share of such a length that a sound must have at least.
const LEAST_SHARE: f64 = 0.75;
/// Number of steps of each of these refinements.
const REFINING_LONGER: usize = 3;

/// A strike's modes, with or without noise.
pub(super) enum Near {
    /// Modes that explain the strike down to its noise floor: poles of most likelihood.
    Exact((Vec<Pole>, Gains)),
    /// Modes and noise that the descent brought near.
    Approached(Sounding),
}

/// A strike, driven by a force from sample `onset` on.
#[derive(Clone, Copy)]
pub(super) struct Heard<'a> {
    pub(super) samples: &'a [f64],
    pub(super) onset: usize,
    /// Sample before which the modes are fitted.
    pub(super) end: usize,
    /// Sample before which the strike is heard alone.
    pub(super) last: usize,
    pub(super) rate_hz: f64,
    pub(super) force: &'a [f64],
    /// Steady sound under the strike, which is none of its modes and noise.
    pub(super) background: Option<&'a Background>,
}

impl Heard<'_> {
    fn strike(&self) -> &[f64] {
        &self.samples[self.onset..self.end.min(self.samples.len())]
    }

    /// Modes and noise near to the strike; `None` if it has no audible mode.
    ///
    /// If the audible modes leave nothing but noise, the modes of most likelihood are the answer.
    /// Else several sets of modes begin a descent. The nearest after a few steps goes on.
    pub(super) fn near(&self, settings: Settings) -> Option<Near> {
        let (mut modes, apart) = self.audible(settings);
        let partials = Partials::new(&self.samples[..self.onset], self.strike(), self.rate_hz).loudest(LOUDEST);
        let (start, left) = self.start_of(&modes, &partials, settings)?;
        if left < LITTLE
            && let Some(exact) = self.exact(settings)
        {
            let (poles, gains) = exact;
            let (poles, gains) = self.over_background(poles, gains);
            return Some(Near::Exact((poles, gains)));
        }
        let edges_hz = usual_edges_hz(self.rate_hz);
        let fastest = settings.fastest_decay_per_s / self.rate_hz;
        let mut descent = Descent::new(
            self.samples,
            (self.onset, self.last),
            self.rate_hz,
            self.force,
            &edges_hz,
            self.background,
            fastest,
        );
        let mut nearest = (descent.run(&start, PROBING).1, start);
        let sounding = |modes: &[DampedSine]| Some(self.start_of(modes, &partials, settings)?.0);
        if let Some(apart) = apart
            && is_nearer(&mut descent, &mut nearest, sounding(&apart))
        {
            modes = apart;
        }
        for modes in self.refined_longer(&modes) {
            is_nearer(&mut descent, &mut nearest, sounding(&modes));
        }
        let fuller = self.fuller(&nearest.1.poles, settings);
        is_nearer(&mut descent, &mut nearest, fuller.and_then(|modes| sounding(&modes)));
        let (near, _) = descent.run(&nearest.1, STEPS);
        let Sounding { poles, gains, bands } = audible_of(near);
        let (poles, gains) = self.over_background(poles, gains);
        Some(Near::Approached(Sounding { poles, gains, bands }))
    }

    /// Modes that stand out of the background where they begin, or the loudest one.
    ///
    /// Without a background all modes are kept.
    fn over_background(&self, poles: Vec<Pole>, mut gains: Gains) -> (Vec<Pole>, Gains) {
        let Some(background) = self.background else { return (poles, gains) };
        let strike = self.strike();
        let stretch = Stretch { samples: strike, force: Some(&self.force[..self.force.len().min(strike.len())]) };
        let size_of = |(pole, gain): (&Pole, &Complex<f64>)| (gain * Basis::new(*pole, &stretch).after_force()).norm();
        let amplitudes: Vec<f64> = poles.iter().zip(&gains.modes).map(size_of).collect();
        let loudest = amplitudes.iter().copied().fold(0.0, f64::max);
        let rate_hz = self.rate_hz;
        let is_over =
            |pole: &Pole, size: f64| background.is_over(pole.frequency_hz(rate_hz), pole.decay_per_s(rate_hz), size);
        let are_over: Vec<bool> = poles.iter().zip(&amplitudes).map(|(pole, &size)| is_over(pole, size)).collect();
        let none = !are_over.contains(&true);
        let is_kept = |index: usize| are_over[index] || (none && amplitudes[index] >= loudest);
        let pairs = poles.into_iter().zip(gains.modes).enumerate();
        let poles: Vec<Pole>;
        (poles, gains.modes) = pairs.filter(|(index, _)| is_kept(*index)).map(|(_, pair)| pair).unzip();
        (poles, gains)
    }

    /// Modes with further ones in the place of those that were dropped because they cancel.
    ///
    /// No further mode lies within the width of another. `None` if a table may have no more.
    fn fuller(&self, poles: &[Pole], settings: Settings) -> Option<Vec<DampedSine>> {
        if poles.len() >= settings.most_modes {
            return None;
        }
        let model = filled(self.part(self.ringing()), self.rate_hz, settings, poles, true)?;
        Some(self.sines(&model))
    }

    fn ringing(&self) -> &[f64] {
        let strike = self.strike();
        &strike[self.force.len().min(strike.len())..]
    }

    /// Modes of most likelihood, if they leave nothing but noise.
    ///
    /// Their gains are those of the free ringing behind the contact, driven by the force.
    fn exact(&self, settings: Settings) -> Option<(Vec<Pole>, Gains)> {
        let ringing = self.ringing();
        if !explains(self.part(ringing), self.rate_hz, settings) {
            return None;
        }
        let likely = estimate_poles(ringing, self.rate_hz, settings);
        let group = [Group::ringing(ringing)];
        let model = refine(&group, &likely, Ending { steps: 0, ..Ending::COARSE })?;
        if likely.len() >= settings.most_modes || !is_noise(&model.residual(0, &group[0].stretches[0])) {
            return None;
        }
        let strike = self.strike();
        let stretch = Stretch { samples: strike, force: Some(&self.force[..self.force.len().min(strike.len())]) };
        let free = model.gains.into_iter().next()?;
        let bases: Vec<Basis> = model.poles.iter().map(|&pole| Basis::new(pole, &stretch)).collect();
        let modes: Vec<_> = bases.iter().zip(&free.modes).map(|(basis, gain)| gain / basis.after_force()).collect();
        // The force's own gain is the one that leaves least of the sound during the contact.
        let mut sound = vec![0.0; strike.len()];
        bases.iter().zip(&modes).for_each(|(basis, gain)| basis.add(*gain, &mut sound));
        let pairs = self.force.iter().zip(strike.iter().zip(&sound));
        let along: f64 = pairs.map(|(force, (wanted, given))| force * (wanted - given)).sum();
        let energy: f64 = self.force.iter().map(|force| force * force).sum();
        Some((model.poles, Gains { modes, force: along / energy.max(f64::MIN_POSITIVE) }))
    }

    /// Modes that explain most loudness, ringing from the end of the force on.
    ///
    /// Further ones come from what the first ones leave, by the loudness of that alone: a partial
    /// that beats with another adds no loudness to it. If a table may have still more, the most
    /// significant ones are added. In the second set none of these lies within the width of another
    /// mode.
    fn audible(&self, settings: Settings) -> (Vec<DampedSine>, Option<Vec<DampedSine>>) {
        let strike = self.strike();
        let ringing = self.ringing();
        let longest = |sound: &[f64]| sound.len().min((LONGEST_S * self.rate_hz) as usize);
        let loudness = Loudness::new(&strike[..longest(strike)], &self.samples[..self.onset], self.rate_hz);
        let most = settings.most_modes;
        let mut chosen = Chosen::none(&loudness);
        chosen.take_from(&candidates(ringing, self.rate_hz, settings), &loudness, most);
        let (mut modes, left) = self.refined(chosen.modes(), ringing, settings);
        if modes.len() < most {
            chosen = Chosen::of_rest(modes, &loudness.excitation_of(&left[..longest(&left)]));
            let more = candidates(&left, self.rate_hz, settings);
            chosen.take_from(&more, &loudness, most);
            modes = chosen.modes().to_vec();
            if modes.len() < most {
                let part = self.part(ringing);
                let known = self.poles(&modes);
                let fill = |is_apart: bool| {
                    let model = filled(part, self.rate_hz, settings, &known, is_apart);
                    model.map_or_else(|| modes.clone(), |model| self.sines(&model))
                };
                let (all, apart) = (fill(false), fill(true));
                return (all, Some(apart));
            }
        }
        (modes, None)
    }

    /// The beginning of a descent from modes, and their share of the strike's energy that is left.
    fn start_of(
        &self,
        modes: &[DampedSine],
        partials: &[(usize, Partial)],
        settings: Settings,
    ) -> Option<(Sounding, f64)> {
        // A refinement may leave drifts and clicks behind, which are no modes.
        let is_over = |mode: &&DampedSine| {
            let over =
                |background: &Background| background.is_over(mode.frequency_hz, mode.decay_per_s, mode.amplitude);
            self.background.is_none_or(over)
        };
        let modes = modes.iter().filter(|mode| is_mode(mode, self.rate_hz, settings)).filter(is_over);
        let modes = modes.copied().collect();
        let modes = with_partials(modes, partials, self.strike(), self.rate_hz, settings.most_modes);
        self.start(self.poles(&modes))
    }

    /// Modes refined over more and more of the sound in which they ring.
    ///
    /// Slow modes that lie within some hertz of one another are told apart by how they beat, for
    /// which the time of the first refinement is too short. Empty if the sound is too short, too.
    fn refined_longer(&self, modes: &[DampedSine]) -> Vec<Vec<DampedSine>> {
        let ringing = self.ringing();
        let mut longer: Vec<Vec<DampedSine>> = Vec::new();
        for seconds in LONGER_S {
            let length = (seconds * self.rate_hz) as usize;
            if (ringing.len() as f64) < LEAST_SHARE * length as f64 {
                break;
            }
            let group = [Group::ringing(&ringing[..ringing.len().min(length)])];
            let ending = Ending { steps: REFINING_LONGER, ridge: RIDGE, ..Ending::COARSE };
            let poles = self.poles(longer.last().map_or(modes, |modes| modes));
            let Some(model) = refine(&group, &poles, ending) else { break };
            longer.push(self.sines(&model));
        }
        longer
    }

    fn part<'a>(&self, ringing: &'a [f64]) -> &'a [f64] {
        &ringing[..ringing.len().min((REFINED_S * self.rate_hz) as usize)]
    }

    fn sines(&self, model: &Model) -> Vec<DampedSine> {
        let gains = model.gains.iter().flat_map(|gains| &gains.modes);
        let sine = |(pole, gain): (&Pole, &Complex<f64>)| DampedSine {
            frequency_hz: pole.frequency_hz(self.rate_hz),
            decay_per_s: pole.decay_per_s(self.rate_hz),
            amplitude: gain.norm(),
            phase: gain.arg(),
        };
        model.poles.iter().zip(gains).map(sine).collect()
    }

    /// Modes refined jointly by least squares, and what they leave of the sound in which they ring.
    ///
    /// Of two modes that come within one another's width one is dropped, and the other begins again
    /// where it was: together they would cancel.
    fn refined(&self, modes: &[DampedSine], ringing: &[f64], settings: Settings) -> (Vec<DampedSine>, Vec<f64>) {
        let part = self.part(ringing);
        let group = [Group::ringing(part)];
        let ending = Ending { steps: REFINING, ridge: RIDGE, ..Ending::COARSE };
        let before = self.poles(modes);
        let Some(mut model) = refine(&group, &before, ending) else { return (modes.to_vec(), part.to_vec()) };
        let sines = self.sines(&model);
        let mut order: Vec<usize> = (0..sines.len()).filter(|&k| is_mode(&sines[k], self.rate_hz, settings)).collect();
        order.sort_by(|&a, &b| model.worth(b).total_cmp(&model.worth(a)));
        let mut kept: Vec<(usize, Pole)> = Vec::new();
        for index in order {
            match kept.iter_mut().find(|(other, _)| are_one(&sines[*other], &sines[index])) {
                Some((other, pole)) => *pole = before[*other],
                None => kept.push((index, model.poles[index])),
            }
        }
        if kept.len() < sines.len() {
            let poles: Vec<Pole> = kept.iter().map(|(_, pole)| *pole).collect();
            match refine(&group, &poles, ending) {
                Some(again) => model = again,
                None => return (modes.to_vec(), part.to_vec()),
            }
        }
        (self.sines(&model), model.residual(0, &group[0].stretches[0]))
    }

    fn poles(&self, modes: &[DampedSine]) -> Vec<Pole> {
        modes.iter().map(|mode| Pole::new(mode.frequency_hz, mode.decay_per_s, self.rate_hz)).collect()
    }

    /// Modes with gains by least squares, and the noise that they leave; and their share of the
    /// strike's energy.
    ///
    /// Of two modes within their widths that cancel, the weaker is dropped.
    fn start(&self, mut poles: Vec<Pole>) -> Option<(Sounding, f64)> {
        let whole = self.strike();
        let partials = Partials::new(&self.samples[..self.onset], whole, self.rate_hz).loudest(LOUDEST);
        let partials: Vec<f64> = partials.iter().map(|(_, partial)| partial.frequency_hz).collect();
        let strike = &whole[..whole.len().min((LONGEST_S * self.rate_hz) as usize)];
        let stretch = Stretch { samples: strike, force: Some(&self.force[..self.force.len().min(strike.len())]) };
        let group = [Group { stretches: vec![stretch] }];
        for round in 1.. {
            let model = refine(&group, &poles, Ending { steps: 0, ridge: RIDGE, ..Ending::COARSE })?;
            let nearest = |hz: &f64| {
                let distance = |k: &usize| (model.poles[*k].frequency_hz(self.rate_hz) - hz).abs();
                let nearest = (0..model.poles.len()).min_by(|a, b| distance(a).total_cmp(&distance(b)));
                nearest.filter(|nearest| distance(nearest) < HELD * hz)
            };
            let held: Vec<usize> = partials.iter().filter_map(nearest).collect();
            let kept = without_cancelling(&model, &held);
            if round < ROUNDS && kept.len() < poles.len() {
                poles = kept;
                continue;
            }
            let left = model.residual(0, &stretch);
            let share = left.iter().map(|x| x * x).sum::<f64>() / stretch.energy().max(f64::MIN_POSITIVE);
            let mut rest = whole.to_vec();
            let whole = Stretch { samples: whole, force: stretch.force };
            if whole.samples.len() > strike.len() {
                rest = model.residual(0, &whole);
            } else {
                rest.copy_from_slice(&left);
            }
            let bands = noise_of(whole.samples, &rest, self.background, self.rate_hz);
            return Some((Sounding { gains: model.gains.into_iter().next()?, poles, bands }, share));
        }
        None
    }
}

/// True if a descent from `start` comes nearer to the strike within a few steps than `nearest` did;
/// then it takes its place.
fn is_nearer(descent: &mut Descent, nearest: &mut (f64, Sounding), start: Option<Sounding>) -> bool {
    let Some(start) = start else { return false };
    let distance = descent.run(&start, PROBING).1;
    let is_nearer = distance < nearest.0;
    if is_nearer {
        *nearest = (distance, start);
    }
    is_nearer
}

/// Poles of a model without the weaker of each two modes that lie within their widths and cancel.
fn without_cancelling(model: &Model, held: &[usize]) -> Vec<Pole> {
    let gains: Vec<Complex<f64>> = model.gains.iter().flat_map(|gains| gains.modes.clone()).collect();
    let energy = |k: &usize| gains[*k].norm_sqr() / model.poles[*k].decay;
    let mut order: Vec<usize> = (0..model.poles.len()).collect();
    order.sort_by(|a, b| held.contains(b).cmp(&held.contains(a)).then(energy(b).total_cmp(&energy(a))));
    let mut kept: Vec<usize> = Vec::new();
    for index in order {
        let (pole, gain) = (model.poles[index], gains[index]);
        if !kept.iter().any(|&other| cancel((&model.poles[other], gains[other]), (&pole, gain))) {
            kept.push(index);
        }
    }
    kept.sort_unstable();
    kept.into_iter().map(|index| model.poles[index]).collect()
}

/// Modes without those that are too soft for a table.
fn audible_of(mut sounding: Sounding) -> Sounding {
    let strongest = sounding.gains.modes.iter().map(|gain| gain.norm()).fold(0.0, f64::max);
    let pairs = sounding.poles.into_iter().zip(sounding.gains.modes);
    (sounding.poles, sounding.gains.modes) = pairs.filter(|(_, gain)| gain.norm() > SOFTEST * strongest).unzip();
    sounding
}

/// True if a mode lies in the range of the search.
fn is_mode(mode: &DampedSine, rate_hz: f64, settings: Settings) -> bool {
    (settings.lowest_hz..0.49 * rate_hz).contains(&mode.frequency_hz) && mode.decay_per_s < settings.fastest_decay_per_s
}

/// Returns true if a residual does not die away: the power of its first tenth is at most twice that
/// of its quietest tenth.
fn is_noise(left: &[f64]) -> bool {
    let size = (left.len() / PARTS).max(1);
    let powers: Vec<f64> = left.chunks_exact(size).map(|part| part.iter().map(|x| x * x).sum()).collect();
    let quietest = powers.iter().copied().fold(f64::INFINITY, f64::min);
    powers.first().is_some_and(|first| *first <= 2.0 * quietest)
}
