//! Free numbers of a model with ringing loops, and the model that they encode.

use std::f64::consts::TAU;

use nalgebra::{DMatrix, DVector};

use super::circle::Circle;
use crate::dynamic_filter::closed_loop::BandPass;
use crate::dynamic_filter::lattice::{Lattice, WIDEST};
use crate::dynamic_filter::model::{Breakpoint, Coefficients, Form, Loop, Model, Path, RATE_HZ};
use crate::dynamic_filter::response::response;
use crate::dynamic_filter::stability::{MOST_LOOP_GAIN, loop_gain};

/// Maximum number of breakpoints: descents with more find little more.
const KNOTS: usize = 17;
/// Number of free numbers of a loop.
pub(super) const A_LOOP: usize = 2;
/// Bounds on ln(1 - gain) for the gain round all loops at a loop's centre.
const MISSING: [f64; 2] = [-8.0, -0.02];
/// Bounds on ln(1 - gain) for the largest gain round the loops at a knot.
const MISSING_AT_KNOT: [f64; 2] = [-7.0, -0.002];
/// Bounds on ln of the noise's level, before the loudest knot is scaled to 1.
const LEVELS: [f64; 2] = [-14.0, 6.0];
/// Least width of a loop in Hz.
const NARROWEST_HZ: f64 = 0.5;
/// Largest width of a loop, as a part of its frequency.
const WIDEST_PART: f64 = 0.25;

/// Filter, level of the noise and loops as free numbers.
///
/// A knot has ln of the noise's level, then the filter as a [`Lattice`]. The filter's gain is free
/// at the last knot only. At all others y stands in its place, and the gain makes the maximum of
/// `|F| Σ |γ_s B_s|` equal to `1 - e^y`. A loop has x, which makes the gain round all loops at its
/// centre `1 - e^x` at the last knot, and the logarithm of its width in Hz. Each band's offset in
/// dB follows.
#[derive(Clone)]
pub(crate) struct Ringing {
    pub(super) form: Form,
    /// Indices of the knots' times; after the last knot there is no noise and the filter stands
    /// still.
    pub(super) knots: Vec<usize>,
    /// Centre in Hz and delay in whole samples of each loop.
    pub(super) loops: Vec<(f64, f64)>,
    pub(super) free: Vec<f64>,
}

/// Filters, levels and loops that the free numbers encode.
pub(super) struct Decoded {
    /// Filter and level of the noise at each knot.
    pub(super) knots: Vec<(Coefficients, f64)>,
    /// Filter at each time.
    pub(super) filters: Vec<Coefficients>,
    /// Level of the noise at each time.
    pub(super) levels: Vec<f64>,
    /// Each loop at gain 1.
    pub(super) bands: Vec<BandPass>,
    /// Gain of each loop.
    pub(super) gains: Vec<f64>,
    /// Width of each loop in Hz.
    pub(super) widths_hz: Vec<f64>,
    /// Phase of the last knot's filter at each loop's centre, for which the loop compensates.
    phases: Vec<f64>,
}

impl Ringing {
    /// Knots with evenly spaced indices up to a time.
    pub(super) fn knots_until(end: usize) -> Vec<usize> {
        let mut knots: Vec<usize> = (0..KNOTS).map(|knot| knot * end / (KNOTS - 1)).collect();
        knots.dedup();
        knots
    }

    /// Index of the last knot's time.
    pub(super) fn end(&self) -> usize {
        self.knots.last().copied().unwrap_or(0)
    }

    /// Number of free numbers of a knot.
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

    /// Filter of a knot with ln of its gain replaced by `ln_gain`.
    fn shape(&self, knot: usize, ln_gain: f64) -> Coefficients {
        let shape = self.knot(knot).iter().skip(2);
        Lattice::of(self.form, std::iter::once(ln_gain).chain(shape.copied()).collect()).coefficients()
    }

    /// Clamps the free numbers to their valid ranges.
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

    /// Filters, levels and loops at `times_s` in seconds.
    pub(super) fn decoded(&self, times_s: &[f64]) -> Decoded {
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
        // nalgebra cannot solve a system of size 0.
        let solved = (count > 0).then(|| DMatrix::from_fn(count, count, round).lu().solve(&wanted)).flatten();
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
        Decoded { knots, filters, levels, bands, gains, widths_hz, phases }
    }

    /// The model: the noise's level is at most 1, and gains are lowered where they are too large
    /// between knots.
    pub(crate) fn model(&self, times_s: &[f64]) -> Model {
        let decoded = self.decoded(times_s);
        let loudest = decoded.knots.iter().map(|knot| knot.1).fold(f64::MIN_POSITIVE, f64::max);
        let point = |((filter, level), time): (&(Coefficients, f64), &usize)| {
            let coefficients = Coefficients { b: filter.b.map(|b| b * loudest), ..*filter };
            Some(Breakpoint { time_s: *times_s.get(*time)?, coefficients, noise: level / loudest })
        };
        let path = Path { points: decoded.knots.iter().zip(&self.knots).filter_map(point).collect() };
        let round = |(index, (frequency_hz, frames)): (usize, &(f64, f64))| {
            let of = |numbers: &[f64]| numbers.get(index).copied().unwrap_or(0.0);
            // The delay turns the wave as in the descent; the numerator makes its fraction of a
            // sample.
            let period = RATE_HZ / frequency_hz;
            let first = of(&decoded.phases) / TAU * period;
            let turns = ((frames + 0.5 - first) / period).round();
            Loop {
                frequency_hz: *frequency_hz,
                bandwidth_hz: of(&decoded.widths_hz),
                gain: of(&decoded.gains) / loudest,
                delay_s: (first + turns * period) / RATE_HZ,
            }
        };
        let mut loops: Vec<Loop> = self.loops.iter().enumerate().map(round).collect();
        let lower = (MOST_LOOP_GAIN / loop_gain(&path, &loops).max(f64::MIN_POSITIVE)).min(1.0);
        loops.iter_mut().for_each(|guide| guide.gain *= lower);
        Model { path, modes: Vec::new(), loops }
    }
}
