//! The powers that the bands hear.

use std::f64::consts::TAU;

use nalgebra::Complex;

use super::super::RATE_HZ;
use super::super::closed_loop::Pole;
use super::super::joint::Joint;
use super::super::lattice::squared;
use super::super::response::{NOISE_DENSITY, heard_in_band};
use super::numbers::{Ringing, Spelled};

/// Poles are sought at every so many times; between, decay and residue run straight.
const TIMES_A_POLE: usize = 3;
/// Newton's steps from a loop's centre, and from the pole a moment before.
const FIRST_STEPS: usize = 5;
const STEPS: usize = 2;
/// A pole decays at least so fast, 1/s: what a descent tries may not.
const SLOWEST: f64 = 0.05;

/// A loop's mode at a time, counted.
pub(super) struct Place {
    time: usize,
    /// α in 1/s.
    pub(super) decay_per_s: f64,
    /// `|R|²`, and `Re R`.
    square: f64,
    common: f64,
}

impl Ringing {
    /// Powers that the bands hear, `[time][band]`: noise through the filter, and each loop's mode.
    ///
    /// With the residue R and the decay α of the closed loop's pole the mode's power P obeys `P' = -2αP + |R|² n² S`, n the noise's level and S its density; what is heard is
    /// `|F|² (P + Re R n² S)`, the mode and what it has in common with the noise that feeds it.
    pub(super) fn powers(&self, joint: &Joint, spelled: &Spelled) -> Vec<Vec<f64>> {
        let noise = spelled.filters.iter().zip(&spelled.levels).map(|(filter, level)| {
            let squared = squared(filter);
            let heard = |band: &super::super::response::BandHearing| level * level * band.power(&squared);
            if *level > 0.0 { joint.hearing.iter().map(heard).collect() } else { vec![0.0; joint.hearing.len()] }
        });
        let mut powers: Vec<Vec<f64>> = noise.collect();
        for (frequency_hz, _) in &self.loops {
            let heard: Vec<f64> = joint.rates.iter().map(|rate| heard_in_band(*frequency_hz, *rate)).collect();
            let own = self.powers_of_loop(&joint.times_s, spelled, *frequency_hz);
            for (powers, own) in powers.iter_mut().zip(own) {
                powers.iter_mut().zip(&heard).for_each(|(power, heard)| *power += heard * own);
            }
        }
        powers
    }

    fn powers_of_loop(&self, times_s: &[f64], spelled: &Spelled, frequency_hz: f64) -> Vec<f64> {
        let places = self.places(spelled, frequency_hz);
        let angular = TAU * frequency_hz / RATE_HZ;
        let (mut power, mut before_s) = (0.0, 0.0);
        let times = times_s.iter().zip(&spelled.filters).zip(&spelled.levels).enumerate();
        let own = times.map(|(time, ((time_s, filter), level))| {
            let [decay_per_s, square, common] = between(&places, time, times_s);
            let density = NOISE_DENSITY * level * level;
            let rate = 2.0 * decay_per_s.max(SLOWEST);
            let steady = square * density / rate;
            power = steady + (power - steady) * f64::exp(-rate * (time_s - before_s));
            before_s = *time_s;
            squared(filter)(angular) * (power + (common * density).max(0.0))
        });
        own.collect()
    }

    /// The loop's pole from time to time, each sought from that before.
    pub(super) fn places(&self, spelled: &Spelled, frequency_hz: f64) -> Vec<Place> {
        let end = self.end();
        let times = (0..end).step_by(TIMES_A_POLE).chain([end]);
        let (mut s, mut steps) = (Complex::new(0.0, TAU * frequency_hz), FIRST_STEPS);
        let place = |time: usize| {
            let pole = Pole::near(s, steps, spelled.filters.get(time)?, &spelled.bands, &spelled.gains);
            (s, steps) = (pole.s, STEPS);
            let (square, common) = (pole.residue.norm_sqr(), pole.residue.re);
            Some(Place { time, decay_per_s: pole.decay_per_s(), square, common })
        };
        times.filter_map(place).collect()
    }
}

/// Decay, `|R|²` and `Re R` at a time; after the last place, its own.
fn between(places: &[Place], time: usize, times_s: &[f64]) -> [f64; 3] {
    let numbers = |place: &Place| [place.decay_per_s, place.square, place.common];
    let above = places.partition_point(|place| place.time <= time);
    let (from, to) = (above.checked_sub(1).and_then(|below| places.get(below)), places.get(above));
    let (Some(from), Some(to)) = (from, to) else { return from.or(to).map_or([0.0; 3], numbers) };
    let second = |time: usize| times_s.get(time).copied().unwrap_or(0.0);
    let part = (second(time) - second(from.time)) / (second(to.time) - second(from.time));
    let (from, to) = (numbers(from), numbers(to));
    std::array::from_fn(|index| from[index] + part * (to[index] - from[index]))
}
