//! Strikes in a room: the room's response, and the thing in what is left without it, in turn.
//!
//! The first strikes are taken from rises of the level in the ear's bands. A room's sound only
//! fades, so it adds no rises.
//! Modes and contacts are fitted to the sound as if it were dry. The response follows from the
//! residual ([`super::reflections`]). The room's sound is subtracted from the recording, and the
//! rest is fitted again.

use super::begin::at_best_time;
use super::descend::{Ending, Fitted, descend};
use super::dry::dry;
use super::equations::of_one_strike;
use super::error::LEAST_STRIKES;
use super::free::{Guard, MORE_MODES, free_modes};
use super::layout::Layout;
use super::model::{Model, Strike};
use super::passes::completed_fit;
use super::reflections::{FLAT_T60_S, UNKNOWN_T60_S, measured, reflected, response};
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
    let mut turn = dried(first, samples, samples, rate_hz).descended();
    let wet: Vec<f64> = samples.iter().zip(&turn.dry).map(|(x, dry)| x - dry).collect();
    if energy(&turn.fitted.residual) > HEARD * left || !is_near_modes(&wet, &turn.fitted.model, rate_hz) {
        return None;
    }
    told(0.1);
    turn = turn.next(samples, rate_hz).descended();
    turn.fitted = at_best_time(turn.fitted, &turn.dry, &turn.whitening).fitted;
    told(0.2);
    turn = turn.next(samples, rate_hz);
    (turn.fitted, turn.whitening) = turn.completed(rate_hz, settings, &|share| told(0.2 + 0.7 * share))?;
    turn.drop_echoes(rate_hz);
    if turn.fitted.model.strikes.len() < LEAST_STRIKES {
        return None;
    }
    turn = turn.next(samples, rate_hz).descended();
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

    /// Fit of the sound without the room, continued or begun anew: the one that leaves less.
    ///
    /// Weak strikes rise out of the sound without the room, but a fit begun anew may end poorly.
    fn completed(&self, rate_hz: f64, settings: Settings, told: &dyn Fn(f64)) -> Option<(Fitted, Whitening)> {
        let layout = Layout::default();
        let anew = || {
            let onsets = rises(&self.dry, rate_hz);
            let few = Settings { most_modes: settings.most_modes.min(MORE_MODES), ..settings };
            let free = free_modes(&self.dry, &onsets, Guard::OF_RISE, rate_hz, few, &[])?;
            dry(&self.dry, (onsets, free), rate_hz, settings, (layout, StartSearch::IN_ROOM), &|share| {
                told(0.5 + 0.5 * share)
            })
            .ok()
        };
        let told = |share: f64| told(0.5 * share);
        let continued = completed_fit(self.fitted.clone(), &self.dry, rate_hz, settings, layout, &told).ok();
        let left = |(fitted, _): &(Fitted, Whitening)| energy(&fitted.residual);
        [continued, anew()].into_iter().flatten().min_by(|a, b| left(a).total_cmp(&left(b)))
    }

    /// Drops strikes that do not stand out of the residual: they are echoes.
    fn drop_echoes(&mut self, rate_hz: f64) {
        let (model, residual) = (&self.fitted.model, &self.fitted.residual);
        let stands_out = |strike: &Strike| {
            let from = (strike.contact.first_sample().max(0.0) as usize).min(residual.len());
            let behind = &residual[from..(from + (HEARD_S * rate_hz) as usize).min(residual.len())];
            let own = of_one_strike(model, strike, from, behind.len());
            energy(&own) > LEAST_OVER_LEFT * energy(behind)
        };
        let strikes = model.strikes.iter().copied().filter(stands_out).collect();
        let model = Model { strikes, ..model.clone() };
        self.fitted = Fitted::new(model, &self.dry, &self.whitening);
    }

    /// Thing in the room that it now leaves of the recording.
    fn next(self, samples: &[f64], rate_hz: f64) -> Self {
        dried(self.fitted, &self.dry, samples, rate_hz)
    }

    /// Fading of the room that the thing leaves of the recording.
    fn measured(&self, samples: &[f64], rate_hz: f64) -> Option<Room> {
        let model = &self.fitted.model;
        let [dry, left] = parts(&self.fitted, &self.dry, samples);
        let response = response([&dry, &left], &self.whitening, FLAT_T60_S, rate_hz);
        let of_mode = |mode: usize| (model.poles[mode], model.gains[mode][0].norm_sqr() / model.poles[mode].decay);
        let mut modes: Vec<_> = (0..model.poles.len()).map(of_mode).collect();
        modes.sort_by(|a, b| a.0.angular.total_cmp(&b.0.angular));
        measured(&response, &modes, rate_hz)
    }
}

/// Dry sound of a thing fitted to a sound, and what it leaves of a recording.
fn parts(fitted: &Fitted, sound: &[f64], samples: &[f64]) -> [Vec<f64>; 2] {
    let dry: Vec<f64> = sound.iter().zip(&fitted.residual).map(|(x, left)| x - left).collect();
    let left = samples.iter().zip(&dry).map(|(x, dry)| x - dry).collect();
    [dry, left]
}

/// A thing fitted to a sound, in the room that it leaves of a recording.
fn dried(fitted: Fitted, sound: &[f64], samples: &[f64], rate_hz: f64) -> InRoom {
    let [dry, left] = parts(&fitted, sound, samples);
    let whitening = Whitening::of_residual(&fitted.residual, ORDER);
    let response = response([&dry, &left], &whitening, UNKNOWN_T60_S, rate_hz);
    let wet = reflected(&dry, &response);
    let without = |sound: &[f64]| -> Vec<f64> { sound.iter().zip(&wet).map(|(x, wet)| x - wet).collect() };
    let (dry, whitening) = (without(samples), Whitening::of_residual(&without(&left), ORDER));
    InRoom { fitted: Fitted::new(fitted.model, &dry, &whitening), whitening, dry, room: None }
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
        let first = begun(
            &sound.samples,
            &free,
            (&onsets, &onsets),
            sound.rate_hz,
            Layout::default(),
            StartSearch::IN_ROOM,
            &|_| {},
        )
        .ok()?;
        in_room(first, &sound.samples, sound.rate_hz, settings, &|_| {})
    }

    #[test]
    fn strikes_in_a_room_are_told_and_so_is_the_room() {
        let sound = synthetic::in_room(401, 8.0, 13);
        let found = fitted(&sound, 24).expect("a room");
        let strikes = &found.fitted.model.strikes;
        assert!((12..=13).contains(&strikes.len()), "{} strikes", strikes.len());
        let apart = |strike: &Strike| {
            let apart = |middle_s: f64| (strike.contact.middle / sound.rate_hz - middle_s).abs();
            sound.strikes.iter().map(|truth| apart(truth.middle_s())).fold(f64::INFINITY, f64::min)
        };
        let mut middles: Vec<f64> = strikes.iter().map(apart).collect();
        middles.sort_by(f64::total_cmp);
        assert!(middles[6] < 60e-6 && middles[10] < 1e-3, "{middles:?}");
        let (room, truth) = (found.room.expect("its fading"), sound.room.expect("the true one"));
        assert!((0.5..2.0).contains(&(room.t60_s / truth.t60_s)), "{room:?} {truth:?}");
        assert!((room.gain_db - truth.gain_db).abs() < 8.0, "{room:?} {truth:?}");
    }

    #[test]
    fn modes_that_a_fit_lacks_are_taken_for_no_room() {
        let sound = plain(8, 6.0, 10, -60.0);
        assert!(fitted(&sound, 6).is_none());
    }
}
