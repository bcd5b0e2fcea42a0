//! The free numbers, and the sound that they say.

use std::f64::consts::TAU;

use nalgebra::{DMatrix, DVector};

use super::super::closed_loop::BandPass;
use super::super::lattice::{Lattice, WIDEST};
use super::super::response::response;
use super::super::stability::{MOST_LOOP_GAIN, loop_gain};
use super::super::{Breakpoint, Coefficients, Form, Loop, Model, Path, RATE_HZ};
use super::circle::Circle;

/// Most breakpoints: descents of more find little more.
const KNOTS: usize = 17;
/// Numbers that a loop leaves free.
pub(super) const A_LOOP: usize = 2;
/// ln of what is missing in a gain to 1: at least, and at most.
const MISSING: [f64; 2] = [-8.0, -0.02];
const MISSING_AT_KNOT: [f64; 2] = [-7.0, -0.002];
/// ln of the noise's level: at least, and at most before it is brought to 1.
const LEVELS: [f64; 2] = [-14.0, 6.0];
/// A loop's least width in Hz, and its largest as a part of its frequency.
const NARROWEST_HZ: f64 = 0.5;
const WIDEST_PART: f64 = 0.25;

/// Filter, level of the noise and loops as free numbers.
///
/// A knot: ln of the noise's level, then the filter as a [`Lattice`], whose gain is free at the last knot only; at all others there stands in its place y, and the gain is such that
/// `|F| Σ |γ_s B_s|` is `1 - e^y` where it is largest. A loop: x, such that the gain round all loops at its centre is `1 - e^x` at the last knot, and the logarithm of its width in Hz. Then each band's offset in dB.
#[derive(Clone)]
pub(crate) struct Ringing {
    pub(super) form: Form,
    /// The times, counted, of the knots; after the last there is no noise and the filter stands still.
    pub(super) knots: Vec<usize>,
    /// The loops' centres in Hz and whole samples of delay.
    pub(super) loops: Vec<(f64, f64)>,
    pub(super) free: Vec<f64>,
}

/// What the numbers say.
pub(super) struct Spelled {
    /// Filters and levels of the noise at the knots ...
    pub(super) knots: Vec<(Coefficients, f64)>,
    /// ... and at all times.
    pub(super) filters: Vec<Coefficients>,
    pub(super) levels: Vec<f64>,
    /// The loops at gain 1, their gains, widths in Hz and the filter's phases that they make good.
    pub(super) bands: Vec<BandPass>,
    pub(super) gains: Vec<f64>,
    pub(super) widths_hz: Vec<f64>,
    phases: Vec<f64>,
}

impl Ringing {
    /// Evenly counted knots up to a time.
    pub(super) fn knots_until(end: usize) -> Vec<usize> {
        let mut knots: Vec<usize> = (0..KNOTS).map(|knot| knot * end / (KNOTS - 1)).collect();
        knots.dedup();
        knots
    }

    /// The last knot's time, counted.
    pub(super) fn end(&self) -> usize {
        self.knots.last().copied().unwrap_or(0)
    }

    /// Numbers a knot.
    pub(super) fn a_knot(&self) -> usize {
        1 + Lattice::flat(self.form, 1.0).free.len()
    }

    pub(super) fn first_of_loops(&self) -> usize {
        self.knots.len() * self.a_knot()
    }

    pub(super) fn first_of_offsets(&self) -> usize {
        self.first_of_loops() + A_LOOP * self.loops.len()
    }

    fn knot(&self, index: usize) -> &[f64] {
        self.free.get(index * self.a_knot()..(index + 1) * self.a_knot()).unwrap_or(&[])
    }

    fn of_loop(&self, index: usize) -> [f64; A_LOOP] {
        let from = self.first_of_loops() + A_LOOP * index;
        std::array::from_fn(|number| self.free.get(from + number).copied().unwrap_or(0.0))
    }

    /// The filter of a knot with another logarithm of its gain.
    fn shape(&self, knot: usize, ln_gain: f64) -> Coefficients {
        let shape = self.knot(knot).iter().skip(2);
        Lattice::of(self.form, std::iter::once(ln_gain).chain(shape.copied()).collect()).coefficients()
    }

    /// Keeps the numbers where they mean something.
    pub(super) fn bound(&mut self) {
        let (a_knot, loops, last) = (self.a_knot(), self.first_of_loops(), self.knots.len().saturating_sub(1));
        for (index, number) in self.free.iter_mut().enumerate().take(loops) {
            match (index % a_knot, index / a_knot == last) {
                (0, _) => *number = number.clamp(LEVELS[0], LEVELS[1]),
                (1, true) => {}
                (1, false) => *number = number.clamp(MISSING_AT_KNOT[0], MISSING_AT_KNOT[1]),
                _ => *number = number.clamp(-WIDEST, WIDEST),
            }
        }
        let of_loops = self.free.iter_mut().skip(loops);
        for (index, number) in of_loops.enumerate().take(A_LOOP * self.loops.len()) {
            let widest_hz = self.loops.get(index / A_LOOP).map_or(1.0, |(frequency_hz, _)| WIDEST_PART * frequency_hz);
            let [least, most] = if index % A_LOOP == 0 { MISSING } else { [NARROWEST_HZ.ln(), widest_hz.ln()] };
            *number = number.clamp(least, most);
        }
    }

    /// Filters, levels and loops.
    pub(super) fn spelled(&self, times_s: &[f64]) -> Spelled {
        let last = self.knots.len().saturating_sub(1);
        let end = self.shape(last, self.knot(last).get(1).copied().unwrap_or(0.0));
        let references: Vec<_> = self.loops.iter().map(|(hz, _)| response(&end, TAU * hz / RATE_HZ)).collect();
        let widths_hz: Vec<f64> = (0..self.loops.len()).map(|index| self.of_loop(index)[1].exp()).collect();
        let bands: Vec<BandPass> = self
            .loops
            .iter()
            .zip(&widths_hz)
            .zip(&references)
            .map(|(((hz, frames), width_hz), filter)| BandPass::new(*hz, *width_hz, *frames, filter.arg()))
            .collect();
        let count = self.loops.len();
        let round = |centre: usize, other: usize| {
            let angular = self.loops.get(centre).map_or(0.0, |(hz, _)| TAU * hz / RATE_HZ);
            match (references.get(centre), bands.get(other)) {
                (Some(filter), Some(band)) => (filter * band.response(angular)).re,
                _ => 0.0,
            }
        };
        let wanted = DVector::from_fn(count, |index, _| 1.0 - self.of_loop(index)[0].exp());
        let solved = DMatrix::from_fn(count, count, round).lu().solve(&wanted);
        let gains: Vec<f64> = solved.map_or_else(|| vec![0.0; count], |gains| gains.iter().copied().collect());
        let centres_hz: Vec<f64> = self.loops.iter().map(|(hz, _)| *hz).collect();
        let circle = Circle::new(&bands, &gains, &centres_hz, &widths_hz);
        let at_knot = |index: usize| {
            let level = self.knot(index).first().copied().unwrap_or(0.0).exp();
            if index == last {
                return (end, level);
            }
            let shape = self.shape(index, 0.0);
            let missing = self.knot(index).get(1).copied().unwrap_or(0.0).min(MISSING_AT_KNOT[1]).exp();
            let gain = (1.0 - missing) / circle.largest(&shape).max(1e-9);
            (Coefficients { b: shape.b.map(|b| b * gain), ..shape }, level)
        };
        let knots: Vec<(Coefficients, f64)> = (0..=last).map(at_knot).collect();
        let at_time = |time: usize| {
            let to = self.knots.partition_point(|knot| *knot <= time);
            let pair = (to.checked_sub(1).and_then(|from| knots.get(from)), knots.get(to));
            let (Some((from, level)), Some((next, next_level))) = pair else {
                let level = if time == self.end() { knots.get(last).map_or(0.0, |knot| knot.1) } else { 0.0 };
                return (end, level);
            };
            let second = |knot: usize| self.knots.get(knot).and_then(|time| times_s.get(*time)).copied().unwrap_or(0.0);
            let (from_s, to_s) = (second(to - 1), second(to));
            let part = (times_s.get(time).copied().unwrap_or(0.0) - from_s) / (to_s - from_s);
            (from.towards(next, part), level + part * (next_level - level))
        };
        let (filters, levels) = (0..times_s.len()).map(at_time).unzip();
        let phases = references.iter().map(|filter| filter.arg()).collect();
        Spelled { knots, filters, levels, bands, gains, widths_hz, phases }
    }

    /// The model: the noise's level at most 1, gains lowered where between knots they are too large after all.
    pub(crate) fn model(&self, times_s: &[f64]) -> Model {
        let spelled = self.spelled(times_s);
        let loudest = spelled.knots.iter().map(|knot| knot.1).fold(f64::MIN_POSITIVE, f64::max);
        let point = |((filter, level), time): (&(Coefficients, f64), &usize)| {
            let coefficients = Coefficients { b: filter.b.map(|b| b * loudest), ..*filter };
            Some(Breakpoint { time_s: *times_s.get(*time)?, coefficients, noise: level / loudest })
        };
        let path = Path { points: spelled.knots.iter().zip(&self.knots).filter_map(point).collect() };
        let round = |(index, (frequency_hz, frames)): (usize, &(f64, f64))| {
            let of = |numbers: &[f64]| numbers.get(index).copied().unwrap_or(0.0);
            // The delay that turns the wave as the descent had it, with a fraction that the numerator makes.
            let period = RATE_HZ / frequency_hz;
            let first = of(&spelled.phases) / TAU * period;
            let turns = ((frames + 0.5 - first) / period).round();
            Loop {
                frequency_hz: *frequency_hz,
                bandwidth_hz: of(&spelled.widths_hz),
                gain: of(&spelled.gains) / loudest,
                delay_s: (first + turns * period) / RATE_HZ,
            }
        };
        let mut loops: Vec<Loop> = self.loops.iter().enumerate().map(round).collect();
        let lower = (MOST_LOOP_GAIN / loop_gain(&path, &loops).max(f64::MIN_POSITIVE)).min(1.0);
        loops.iter_mut().for_each(|guide| guide.gain *= lower);
        Model { path, modes: Vec::new(), loops }
    }
}
