//! Band powers of a model with ringing loops.

use std::f64::consts::TAU;

use nalgebra::Complex;

use super::numbers::{Decoded, Ringing};
use crate::dynamic_filter::closed_loop::Pole;
use crate::dynamic_filter::lattice::squared;
use crate::dynamic_filter::model::RATE_HZ;
use crate::dynamic_filter::objective::Objective;
use crate::dynamic_filter::response::{NOISE_DENSITY, sine_power_in_band};

/// Number of times between two at which poles are sought; decay and residue run straight between.
const TIMES_A_POLE: usize = 3;
/// Newton steps from a loop's centre to the first pole.
const FIRST_STEPS: usize = 5;
/// Newton steps from the pole at the time before.
const STEPS: usize = 2;
/// Least decay of a pole in 1/s: an attempt of a descent may be unstable.
const SLOWEST: f64 = 0.05;

/// A loop's pole at one time.
pub(super) struct Place {
    /// Index of the time.
    time: usize,
    /// Decay rate α in 1/s.
    pub(super) decay_per_s: f64,
    /// Squared magnitude `|R|²` of the residue.
    square: f64,
    /// Real part `Re R` of the residue.
    common: f64,
}

impl Ringing {
    /// Band powers as `[time][band]`: noise through the filter, and each loop's mode.
    ///
    /// With the residue R and the decay α of the closed loop's pole, the mode's power P obeys
    /// `P' = -2αP + |R|² n² S`; n is the noise's level and S its density. The output has the power
    /// `|F|² (P + Re R n² S)`: the mode, and its correlation with the noise that feeds it.
    pub(super) fn powers(&self, objective: &Objective, decoded: &Decoded) -> Vec<Vec<f64>> {
        let noise = decoded.filters.iter().zip(&decoded.levels).map(|(filter, level)| {
            let squared = squared(filter);
            let heard = |band: &super::super::response::NoiseBand| level * level * band.power(&squared);
            if *level > 0.0 {
                objective.noise_bands.iter().map(heard).collect()
            } else {
                vec![0.0; objective.noise_bands.len()]
            }
        });
        let mut powers: Vec<Vec<f64>> = noise.collect();
        for (frequency_hz, _) in &self.loops {
            let heard: Vec<f64> = objective.rates.iter().map(|rate| sine_power_in_band(*frequency_hz, *rate)).collect();
            let own = self.powers_of_loop(&objective.times_s, decoded, *frequency_hz);
            for (powers, own) in powers.iter_mut().zip(own) {
                powers.iter_mut().zip(&heard).for_each(|(power, heard)| *power += heard * own);
            }
        }
        powers
    }

    fn powers_of_loop(&self, times_s: &[f64], decoded: &Decoded, frequency_hz: f64) -> Vec<f64> {
        let places = self.places(decoded, frequency_hz);
        let angular = TAU * frequency_hz / RATE_HZ;
        let (mut power, mut before_s) = (0.0, 0.0);
        let times = times_s.iter().zip(&decoded.filters).zip(&decoded.levels).enumerate();
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

    /// Poles of a loop over time, each sought from the one before.
    pub(super) fn places(&self, decoded: &Decoded, frequency_hz: f64) -> Vec<Place> {
        let end = self.end();
        let times = (0..end).step_by(TIMES_A_POLE).chain([end]);
        let (mut s, mut steps) = (Complex::new(0.0, TAU * frequency_hz), FIRST_STEPS);
        let place = |time: usize| {
            let pole = Pole::near(s, steps, decoded.filters.get(time)?, &decoded.bands, &decoded.gains);
            (s, steps) = (pole.s, STEPS);
            let (square, common) = (pole.residue.norm_sqr(), pole.residue.re);
            Some(Place { time, decay_per_s: pole.decay_per_s(), square, common })
        };
        times.filter_map(place).collect()
    }
}

/// Decay, `|R|²` and `Re R` at a time, linear between poles; after the last pole, its own.
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
