//! T60 and level of a room in octaves, from its answer to all modes.
//!
//! The room's response is noise that decays with the rate d (diffimpact §3.4), so that the answer's
//! power in a band follows `∫ e^{-2du} g²(t-u) du` for the modes' response g. But modes take what
//! they can of the answer: a room changes amplitudes of slow modes, and what it changes alike for
//! all time is not told from the modes' own. So rooms of known T60 are drawn, modes are fitted to
//! each, and the answer is compared with what is left of the draws. Their scatter gives the
//! standard deviations, those of the modes included.

use rayon::prelude::*;

use super::super::model::Model;
use super::convolution::convolved;
use super::curves::{Curves, Match};
use super::dried::InRoom;
use super::estimate::{RoomBandEstimate, RoomEstimate};
use crate::modes::{Ending, Group, Pole, add_ringing, refine};
use crate::random::SplitMix64;

/// Shortest T60 that is drawn, in seconds.
const SHORTEST_S: f64 = 0.18;
/// Ratio of successive T60s.
const RATIO: f64 = 1.35;
/// Number of T60s.
const TIMES: usize = 9;
/// Number of rooms that are drawn for each T60.
const DRAWS: usize = 8;
/// Energy of a drawn room's response over the direct sound's: -12 dB.
const DRAWN: f64 = 0.063;
/// Fit of the modes in an answer.
const ENDING: Ending = Ending { steps: 6, gain: 1e-2, ridge: 0.0 };
/// Largest standard deviation of ln T60 of an octave that counts.
const TOLD: f64 = 0.5;

/// Largest gain of an octave in dB; what is louder is a mode that was not found.
const LOUDEST_DB: f64 = 0.0;

/// The room that an answer tells, and deviations that it causes in the modes.
#[derive(Clone, Debug)]
pub(crate) struct Told {
    /// `None` if no octave tells a T60.
    pub(crate) room: Option<RoomEstimate>,
    /// Standard deviations of decay and angular frequency of each mode, per sample.
    pub(crate) poles: Vec<[f64; 2]>,
    /// Relative standard deviation of each gain.
    pub(crate) gains: Vec<f64>,
}

/// Rest of an answer behind the modes, and the amount by which they moved.
struct Left {
    curves: Curves,
    poles: Vec<[f64; 2]>,
    gains: Vec<f64>,
}

/// Room of a fit, and deviations of the modes in it.
pub(crate) fn told_of(found: &InRoom, rate_hz: f64) -> Option<Told> {
    let model = &found.fitted.model;
    let length = found.answer.samples.len();
    let direct = direct(model, length);
    let heard = left_of(model, &direct, &found.answer.samples, rate_hz)?;
    let t60_s = |time: usize| SHORTEST_S * RATIO.powi(time as i32);
    let drawn: Vec<Left> = (0..TIMES * DRAWS)
        .into_par_iter()
        .map(|index| {
            let response = response(index as u64, t60_s(index / DRAWS) * rate_hz, length);
            left_of(model, &direct, &convolved(&direct, &response, 0..length), rate_hz)
        })
        .collect::<Option<Vec<Left>>>()?;
    let means: Vec<Curves> =
        drawn.chunks(DRAWS).map(|draws| Curves::mean(draws.iter().map(|draw| &draw.curves))).collect();
    let floors = heard.curves.floors();
    let bands: Vec<RoomBandEstimate> = (0..heard.curves.count())
        .filter_map(|band| {
            let found = heard.curves.matched(band, &means, floors[band])?;
            let nearest = found.place.round() as usize;
            // Each draw as if it were the recording.
            let again: Vec<Match> = drawn[nearest * DRAWS..(nearest + 1) * DRAWS]
                .iter()
                .filter_map(|draw| draw.curves.matched(band, &means, floors[band] / found.factor))
                .collect();
            let spread = |number: fn(&Match) -> f64, truth: f64| {
                let squares: f64 = again.iter().map(|found| (number(found) - truth).powi(2)).sum();
                (again.len() * 2 > DRAWS).then(|| (squares / again.len() as f64).sqrt())
            };
            let of_time = spread(|found| found.place, nearest as f64)? * RATIO.ln();
            let of_gain = spread(|found| 10.0 * found.factor.log10(), 0.0)?;
            let time_s = SHORTEST_S * RATIO.powf(found.place);
            let gain_db = 10.0 * (DRAWN * found.factor).log10();
            (of_time < TOLD && gain_db < LOUDEST_DB).then(|| RoomBandEstimate {
                edges_hz: heard.curves.edges_hz(band),
                t60_s: time_s,
                t60_s_sd: of_time * time_s,
                gain_db,
                gain_db_sd: of_gain,
            })
        })
        .collect();
    let room = RoomEstimate::of_bands(bands);
    let (time, factor) = room.as_ref().map_or((0.5 * TIMES as f64, 1.0), |room| {
        ((room.t60_s / SHORTEST_S).ln() / RATIO.ln(), 10f64.powf(room.gain_db / 10.0) / DRAWN)
    });
    let nearest = (time.round().max(0.0) as usize).min(TIMES - 1);
    let draws = &drawn[nearest * DRAWS..(nearest + 1) * DRAWS];
    let rms = |number: &dyn Fn(&Left) -> f64| {
        (factor * draws.iter().map(|draw| number(draw).powi(2)).sum::<f64>() / DRAWS as f64).sqrt()
    };
    let modes = 0..model.poles.len();
    Some(Told {
        room,
        poles: modes.clone().map(|mode| [0, 1].map(|part| rms(&|draw| draw.poles[mode][part]))).collect(),
        gains: modes.map(|mode| rms(&|draw| draw.gains[mode])).collect(),
    })
}

/// Response of all modes to a force of 1 in one sample.
fn direct(model: &Model, length: usize) -> Vec<f64> {
    let mut direct = vec![0.0; length];
    (0..model.poles.len()).for_each(|mode| add_ringing(model.poles[mode], model.gain(mode, 0.0), &mut direct));
    direct
}

/// Response of a room that is drawn: noise that decays by 60 dB in `t60` samples.
fn response(draw: u64, t60: f64, length: usize) -> Vec<f64> {
    let mut random = SplitMix64(draw.wrapping_mul(0x9E37_79B9_7F4A_7C15) ^ 0x0000_A45E);
    let decay = 1000f64.ln() / t60;
    // The energy of e^{-dn} over all n is 1/2d.
    let size = (DRAWN * 2.0 * decay).sqrt();
    (0..length).map(|n| size * random.normal() * (-decay * n as f64).exp()).collect()
}

/// Rest of an answer, once modes have taken of it what they can.
fn left_of(model: &Model, direct: &[f64], answer: &[f64], rate_hz: f64) -> Option<Left> {
    let heard: Vec<f64> = direct.iter().zip(answer).map(|(direct, answer)| direct + answer).collect();
    let group = Group::ringing(&heard);
    let refined = refine(std::slice::from_ref(&group), &model.poles, ENDING)?;
    let moved = |(pole, new): (&Pole, &Pole)| [new.decay - pole.decay, new.angular - pole.angular];
    let gains = refined.gains[0].modes.iter().enumerate();
    Some(Left {
        curves: Curves::of(&refined.residual(0, &group.stretches[0]), rate_hz),
        poles: model.poles.iter().zip(&refined.poles).map(moved).collect(),
        gains: gains.map(|(mode, gain)| gain.norm() / model.gain(mode, 0.0).norm() - 1.0).collect(),
    })
}
