//! Strikes in a room: the room's response, and the thing in what is left without it, in turn.
//!
//! The first strikes are taken from rises of the level in the ear's bands. A room's sound only
//! fades, so it adds no rises.
//! The first fit of modes and contacts takes the sound for dry. Three steps then repeat:
//!
//! - Modes and the room's response are improved together ([`super::reflections`]).
//! - The room's sound is subtracted from the recording.
//! - The thing is fitted to the rest.
//!
//! Strikes and modes that the first fit lacks are found in the sound without the room.

use super::begin::at_best_time;
use super::derivatives::sound;
use super::descend::{Ending, Fitted, descend};
use super::dry::dry;
use super::equations::{of_one_strike, residual};
use super::error::LEAST_STRIKES;
use super::fading::measured;
use super::free::{Guard, MORE_MODES, free_modes};
use super::layout::Layout;
use super::model::{Model, Strike};
use super::passes::completed_fit;
use super::reflections::{FLAT_T60_S, UNKNOWN_T60_S, WithModes, reflected, response};
use super::rises::rises;
use super::start::StartSearch;
use super::whitening::{ORDER, Whitening};
use crate::bark::Spectrum;
use crate::modes::Settings;
use crate::room::Room;

/// Largest ratio of the residual's energy with a room to that without one: -0.2 dB.
const HEARD: f64 = 0.95;
/// Time in seconds from a strike's beginning in which its energy is compared with the residual's.
const HEARD_S: f64 = 0.03;
/// Least ratio of a strike's energy to the residual's: 3 dB. In the sets *room* true strikes have
/// 15 dB or more, and echoes have -5 dB or less.
const LEAST_OVER_LEFT: f64 = 2.0;

/// Thing in a room, and the recording without the room's sound.
pub(super) struct InRoom {
    pub(super) fitted: Fitted,
    pub(super) whitening: Whitening,
    pub(super) dry: Vec<f64>,
    pub(super) room: Option<Room>,
    /// T60 in seconds that is assumed of the response.
    assumed_t60_s: f64,
}

/// Fit of a thing struck at one place in a room, from a fit without the room on. `None` if no room
/// is heard.
pub(super) fn in_room(
    first: Fitted,
    samples: &[f64],
    rate_hz: f64,
    settings: Settings,
    told: &dyn Fn(f64),
) -> Option<InRoom> {
    let left = energy(&first.residual);
    let mut turn = dried(first, [samples; 2], rate_hz, UNKNOWN_T60_S).descended();
    let wet: Vec<f64> = samples.iter().zip(&turn.dry).map(|(x, dry)| x - dry).collect();
    if energy(&turn.fitted.residual) > HEARD * left || !is_near_modes(&wet, &turn.fitted.model, rate_hz) {
        return None;
    }
    told(0.1);
    turn = turn.settled(samples, rate_hz, &|share| told(0.1 + 0.15 * share));
    turn.fitted = at_best_time(turn.fitted, &turn.dry, &turn.whitening).fitted;
    turn = turn.next(samples, rate_hz);
    let told_anew = |share: f64| told(0.25 + 0.2 * share);
    if let Some(anew) = turn.begun_anew(StartSearch::IN_ROOM, rate_hz, settings, &told_anew) {
        turn = anew.fitted_again(samples, rate_hz, &|share| told(0.45 + 0.05 * share));
    }
    for round in 0..ROUNDS {
        let told = |share: f64| told(0.5 + 0.5 * (round as f64 + share) / ROUNDS as f64);
        let Some(next) = turn.continued(rate_hz, settings, &|share| told(0.2 * share)) else { break };
        let next = next.fitted_again(samples, rate_hz, &|share| told(0.2 + 0.2 * share));
        let mut next = next.without_echoes(rate_hz)?;
        // Contacts that are right leave no more than the ringing behind them.
        if next.fitted.left_in_contacts() > CONTACTS_EXPLAINED * next.fitted.mean_power() {
            let told_anew = |share: f64| told(0.4 + 0.4 * share);
            if let Some(anew) = next.begun_anew(StartSearch::DRY, rate_hz, settings, &told_anew) {
                next = anew.fitted_again(samples, rate_hz, &|share| told(0.8 + 0.2 * share));
            }
        }
        let is_settled = energy(&next.fitted.residual) > COMPLETE * energy(&turn.fitted.residual);
        turn = next;
        if is_settled {
            break;
        }
    }
    turn.room = turn.measured(samples, rate_hz);
    Some(turn)
}

pub(super) fn energy(sound: &[f64]) -> f64 {
    sound.iter().map(|x| x * x).sum()
}

/// True if a sound has its energy near the modes' frequencies, as a room's sound has.
///
/// A response also takes up modes that the model lacks, at other frequencies.
fn is_near_modes(sound: &[f64], model: &Model, rate_hz: f64) -> bool {
    let Some(spectrum) = Spectrum::of(sound, rate_hz) else { return false };
    let bin_hz = spectrum.bin_hz();
    let mut is_near = vec![false; (0.5 * rate_hz / bin_hz) as usize + 2];
    for pole in &model.poles {
        let [low, high] =
            [-NEAR_HZ, NEAR_HZ].map(|reach| ((pole.frequency_hz(rate_hz) + reach) / bin_hz).max(0.0) as usize);
        is_near.iter_mut().take(high + 1).skip(low).for_each(|bin| *bin = true);
    }
    let (mut near, mut all) = (0.0, 0.0);
    for (power, is_near) in spectrum.power().zip(is_near) {
        all += power;
        near += if is_near { power } else { 0.0 };
    }
    near > NEAR * all
}

/// Distance in Hz from a mode's frequency up to which energy counts as near the mode.
const NEAR_HZ: f64 = 20.0;
/// Least share of the energy near modes at which a response is a room's.
///
/// The sets *room* have shares of 0.45 to 0.91, and a model of too few modes has 0.09.
const NEAR: f64 = 0.25;

impl InRoom {
    /// Thing fitted again to the sound without the room.
    fn descended(self) -> Self {
        let fitted = descend(self.fitted, &self.dry, &self.whitening, Ending::COARSE);
        Self { fitted, ..self }
    }

    /// Fit of the sound without the room, begun anew: weak strikes rise out of that sound.
    ///
    /// `None` if it leaves more, as a fit that begins poorly may, or has too few strikes.
    fn begun_anew(&self, search: StartSearch, rate_hz: f64, settings: Settings, told: &dyn Fn(f64)) -> Option<Self> {
        let onsets = rises(&self.dry, rate_hz);
        let few = Settings { most_modes: settings.most_modes.min(MORE_MODES), ..settings };
        let free = free_modes(&self.dry, &onsets, Guard::OF_RISE, rate_hz, few, &[])?;
        let found = dry(&self.dry, (onsets, free), rate_hz, settings, (Layout::default(), search), told).ok()?;
        let anew = self.with(found).without_echoes(rate_hz)?;
        (energy(&anew.fitted.residual) < energy(&self.fitted.residual)).then_some(anew)
    }

    /// Fit of the sound without the room, with strikes and modes that it lacks.
    ///
    /// `None` if two modes or two strikes cannot be told apart.
    fn continued(&self, rate_hz: f64, settings: Settings, told: &dyn Fn(f64)) -> Option<Self> {
        completed_fit(self.fitted.clone(), &self.dry, rate_hz, settings, Layout::default(), told)
            .ok()
            .map(|found| self.with(found))
    }

    /// Another fit of the sound without the room.
    fn with(&self, (fitted, whitening): (Fitted, Whitening)) -> Self {
        Self { fitted, whitening, dry: self.dry.clone(), room: None, ..*self }
    }

    /// The fit without strikes that do not stand out of the residual: they are echoes.
    ///
    /// `None` if too few are left.
    fn without_echoes(self, rate_hz: f64) -> Option<Self> {
        let (model, residual) = (&self.fitted.model, &self.fitted.residual);
        let stands_out = |strike: &Strike| {
            let from = (strike.contact.first_sample().max(0.0) as usize).min(residual.len());
            let behind = &residual[from..(from + (HEARD_S * rate_hz) as usize).min(residual.len())];
            let own = of_one_strike(model, strike, from, behind.len());
            energy(&own) > LEAST_OVER_LEFT * energy(behind)
        };
        let strikes: Vec<Strike> = model.strikes.iter().copied().filter(stands_out).collect();
        if strikes.len() < LEAST_STRIKES {
            return None;
        }
        let fitted = Fitted::new(Model { strikes, ..model.clone() }, &self.dry, &self.whitening);
        Some(Self { fitted, ..self })
    }

    /// Thing in the room that it now leaves of the recording.
    fn next(self, samples: &[f64], rate_hz: f64) -> Self {
        dried(self.fitted, [&self.dry, samples], rate_hz, self.assumed_t60_s)
    }

    /// Thing and room fitted together, beginning with the room that the thing now leaves.
    fn fitted_again(self, samples: &[f64], rate_hz: f64, told: &dyn Fn(f64)) -> Self {
        self.next(samples, rate_hz).descended().settled(samples, rate_hz, told)
    }

    /// Thing and room fitted together, until little is gained.
    ///
    /// The response is taken to fade with the T60 that was measured last. If it may fade as it
    /// likes, as for that measurement, it takes up errors of decays.
    fn settled(self, samples: &[f64], rate_hz: f64, told: &dyn Fn(f64)) -> Self {
        let (mut best, mut damping) = (self, 0.0);
        for turn in 0..TURNS {
            if let Some(room) = best.measured(samples, rate_hz) {
                best.assumed_t60_s = room.t60_s.clamp(ASSUMED_T60_S[0], ASSUMED_T60_S[1]);
            }
            let Some((next, at)) = best.together(samples, rate_hz, damping) else { break };
            let is_settled = energy(&next.fitted.residual) > GAINED * energy(&best.fitted.residual);
            (best, damping) = (next, 0.1 * at);
            told((turn as f64 + 1.0) / TURNS as f64);
            if is_settled {
                break;
            }
        }
        best
    }

    /// Thing and room after a step of modes and response together, and the step's damping.
    ///
    /// `None` if no step leaves less.
    fn together(&self, samples: &[f64], rate_hz: f64, damping: f64) -> Option<(Self, f64)> {
        let equations = WithModes::new(&self.fitted.model, samples, &self.whitening, self.assumed_t60_s, rate_hz);
        let mut damping = damping;
        for _ in 0..DAMPINGS {
            let (response, step) = equations.solved(damping)?;
            let mut model = self.fitted.model.clone();
            model.step_shared(&step);
            let wet = reflected(&sound(&model, samples.len()), &response);
            let dry: Vec<f64> = samples.iter().zip(&wet).map(|(x, wet)| x - wet).collect();
            let whitening = Whitening::of_residual(&residual(&model, &dry), ORDER);
            let fitted = descend(Fitted::new(model, &dry, &whitening), &dry, &whitening, Ending::COARSE);
            if energy(&fitted.residual) < energy(&self.fitted.residual) {
                return Some((Self { fitted, whitening, dry, room: None, ..*self }, damping));
            }
            damping = (10.0 * damping).max(LEAST_DAMPING);
        }
        None
    }

    /// Fading of the room that the thing leaves of the recording.
    fn measured(&self, samples: &[f64], rate_hz: f64) -> Option<Room> {
        let [dry, left] = parts(&self.fitted, &self.dry, samples);
        let response = response([&dry, &left], &self.whitening, FLAT_T60_S, rate_hz);
        let mut poles = self.fitted.model.poles.clone();
        poles.sort_by(|a, b| a.angular.total_cmp(&b.angular));
        measured(&response, &poles, rate_hz, FLAT_T60_S)
    }
}

/// Maximum number of rounds in which the fit is completed, and fitted with the room again.
const ROUNDS: usize = 3;
/// Largest ratio of the residual's power within contacts to its power over the whole recording at
/// which contacts are explained: 1.2 dB.
const CONTACTS_EXPLAINED: f64 = 1.3;
/// Ratio of what is left after a round to what was left before from which the rounds end: -0.2 dB.
const COMPLETE: f64 = 0.95;
/// Maximum number of turns in which thing and room are fitted together.
const TURNS: usize = 8;
/// Ratio of what is left after a turn to what was left before from which the turns end: -0.05 dB.
const GAINED: f64 = 0.99;
/// Maximum number of dampings that are tried in a turn.
const DAMPINGS: usize = 5;
/// Least damping of a step that follows one that was no better.
const LEAST_DAMPING: f64 = 1e-4;
/// Range of T60s in seconds that are assumed of a response.
const ASSUMED_T60_S: [f64; 2] = [0.2, 3.0];

/// Dry sound of a thing fitted to a sound, and what it leaves of a recording.
fn parts(fitted: &Fitted, sound: &[f64], samples: &[f64]) -> [Vec<f64>; 2] {
    let dry: Vec<f64> = sound.iter().zip(&fitted.residual).map(|(x, left)| x - left).collect();
    let left = samples.iter().zip(&dry).map(|(x, dry)| x - dry).collect();
    [dry, left]
}

/// A thing fitted to a sound, in the room that it leaves of a recording.
fn dried(fitted: Fitted, [sound, samples]: [&[f64]; 2], rate_hz: f64, assumed_t60_s: f64) -> InRoom {
    let [dry, left] = parts(&fitted, sound, samples);
    let whitening = Whitening::of_residual(&fitted.residual, ORDER);
    let response = response([&dry, &left], &whitening, assumed_t60_s, rate_hz);
    let wet = reflected(&dry, &response);
    let without = |sound: &[f64]| -> Vec<f64> { sound.iter().zip(&wet).map(|(x, wet)| x - wet).collect() };
    let (dry, whitening) = (without(samples), Whitening::of_residual(&without(&left), ORDER));
    InRoom { fitted: Fitted::new(fitted.model, &dry, &whitening), whitening, dry, room: None, assumed_t60_s }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::multi_strike::begin::begun;
    use crate::multi_strike::synthetic::{self, StruckOften, plain};

    fn fitted(sound: &StruckOften, most_modes: usize) -> Option<InRoom> {
        let onsets = rises(&sound.samples, sound.rate_hz);
        let settings = Settings { most_modes, ..Settings::default() };
        let free = free_modes(&sound.samples, &onsets, Guard::OF_RISE, sound.rate_hz, settings, &[])?;
        let first =
            begun(&sound.samples, &free, &onsets, sound.rate_hz, Layout::default(), StartSearch::IN_ROOM, &|_| {})
                .ok()?;
        in_room(first, &sound.samples, sound.rate_hz, settings, &|_| {})
    }

    #[test]
    fn strikes_in_a_room_are_told_and_so_is_the_room() {
        let sound = synthetic::in_room(401, 8.0, 13);
        let found = fitted(&sound, 24).expect("a room");
        let strikes = &found.fitted.model.strikes;
        assert_eq!(strikes.len(), 13);
        let apart = |strike: &Strike| {
            let apart = |middle_s: f64| (strike.contact.middle / sound.rate_hz - middle_s).abs();
            sound.strikes.iter().map(|truth| apart(truth.middle_s())).fold(f64::INFINITY, f64::min)
        };
        let mut middles: Vec<f64> = strikes.iter().map(apart).collect();
        middles.sort_by(f64::total_cmp);
        assert!(middles[6] < 0.7e-6 && middles[12] < 1.1e-6, "{middles:?}");
        let (room, truth) = (found.room.expect("its fading"), sound.room.expect("the true one"));
        assert!((0.75..1.25).contains(&(room.t60_s / truth.t60_s)), "{room:?} {truth:?}");
        assert!((room.gain_db - truth.gain_db).abs() < 3.6, "{room:?} {truth:?}");
    }

    #[test]
    fn modes_that_a_fit_lacks_are_taken_for_no_room() {
        let sound = plain(8, 6.0, 10, -60.0);
        assert!(fitted(&sound, 6).is_none());
    }
}
