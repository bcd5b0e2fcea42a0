//! The free numbers of a descent, what they stand for, and what it costs to move them.

use super::guide::Guide;
use super::joint::{SOUGHT_LOOP_GAIN, Sought};
use super::lattice::{Lattice, Shape, WIDEST};
use crate::modes::DampedSine;

/// Every so many of the times has a filter of its own; between, its free numbers run straight.
const TIMES_A_KNOT: usize = 3;
/// Price of a band's level that is off at all times alike, dB a dB: decay comes before colour.
const OFFSET_PRICE: f64 = 0.15;
/// Price of changing a mode's amplitude and decay, dB a neper.
const MODE_PRICE: [f64; 2] = [1.5, 3.0];
/// Price of changing the odds of a loop's gain and the logarithm of its width, dB a unit.
const GUIDE_PRICE: f64 = 0.15;
/// Price of change from knot to knot, dB a unit.
const MOTION_PRICE: f64 = 0.03;
/// The same of a filter whose noise has a level of its own: there the filter had better stand still, for on it hang the loops' decays.
const STILL_PRICE: f64 = 0.05;
/// The noise falls no further below its loudest than by so many nepers: 80 dB.
pub(crate) const DEEPEST: f64 = 9.2;

/// Where a number of a filter with loops stays: real poles below 0.99, conjugate ones within 0.9. A peak would leave the loops no gain.
pub(crate) fn mild(shape: Shape, place: usize) -> [f64; 2] {
    match (shape, place) {
        (Shape::FirstOrder | Shape::OnePoleOneZero, 1) | (Shape::RealPoles, 1 | 2) => [-2.6, 2.6],
        (Shape::ConjugatePoles, 2) => [-WIDEST, 1.1],
        _ => [-WIDEST, WIDEST],
    }
}

/// Knots of the filter and of the noise's level, then amplitude and decay of each mode, then gain and width of each loop, then the bands' offsets.
#[derive(Clone)]
pub(crate) struct Numbers {
    shape: Shape,
    times: usize,
    /// Numbers a knot: the filter's, and the level's where it moves.
    a_knot: usize,
    levels_move: bool,
    knots: usize,
    modes: Vec<DampedSine>,
    guides: Vec<Guide>,
    /// The numbers.
    pub(crate) free: Vec<f64>,
}

impl Numbers {
    /// Those of a start, with offsets for so many bands.
    pub(crate) fn of(start: &Sought, bands: usize) -> Self {
        let shape = start.filters.first().map_or(Shape::FirstOrder, Lattice::shape);
        let times = start.filters.len();
        let knots = times.saturating_sub(1).div_ceil(TIMES_A_KNOT) + 1;
        let mut free: Vec<f64> = Vec::new();
        for knot in 0..knots {
            let at = (knot * TIMES_A_KNOT).min(times.saturating_sub(1));
            free.extend(start.filters.get(at).into_iter().flat_map(|filter| filter.free.iter().copied()));
            free.extend(start.levels.get(at));
        }
        let a_knot = free.len() / knots;
        free.resize(free.len() + 2 * (start.modes.len() + start.guides.len()) + bands, 0.0);
        Self {
            shape,
            times,
            a_knot,
            levels_move: !start.levels.is_empty(),
            knots,
            modes: start.modes.clone(),
            guides: start.guides.clone(),
            free,
        }
    }

    fn part(&self, from: usize, count: usize) -> &[f64] {
        self.free.get(from..from + count).unwrap_or(&[])
    }

    fn knot_numbers(&self) -> &[f64] {
        self.part(0, self.knots * self.a_knot)
    }

    fn mode_numbers(&self) -> &[f64] {
        self.part(self.knots * self.a_knot, 2 * self.modes.len())
    }

    fn guide_numbers(&self) -> &[f64] {
        self.part(self.knots * self.a_knot + 2 * self.modes.len(), 2 * self.guides.len())
    }

    fn offsets(&self) -> &[f64] {
        let from = self.knots * self.a_knot + 2 * (self.modes.len() + self.guides.len());
        self.part(from, self.free.len() - from)
    }

    /// By how much a band's level is off at all times alike, dB.
    pub(crate) fn offset_db(&self, band: usize) -> f64 {
        self.offsets().get(band).copied().unwrap_or(0.0)
    }

    /// Whether a number of a knot is a logarithm of a gain, of the filter or of the noise.
    fn is_gain(&self, index: usize) -> bool {
        let place = index % self.a_knot.max(1);
        place == 0 || (self.levels_move && place + 1 == self.a_knot)
    }

    /// Brings the numbers back into their ranges.
    pub(crate) fn bound(&mut self) {
        let count = self.knots * self.a_knot;
        for index in 0..count {
            if !self.is_gain(index) {
                let place = index % self.a_knot;
                let [least, most] = if self.levels_move { mild(self.shape, place) } else { [-WIDEST, WIDEST] };
                self.free[index] = self.free[index].clamp(least, most);
            }
        }
        if self.levels_move {
            let levels = || (1..=self.knots).map(|knot| knot * self.a_knot - 1);
            let loudest = levels().map(|at| self.free[at]).fold(f64::NEG_INFINITY, f64::max);
            levels().for_each(|at| self.free[at] = self.free[at].max(loudest - DEEPEST));
        }
    }

    /// What the numbers cost.
    pub(crate) fn prices(&self) -> impl Iterator<Item = f64> + '_ {
        let numbers = self.knot_numbers();
        let motion = numbers.iter().skip(self.a_knot).zip(numbers).enumerate().map(|(index, (now, before))| {
            let place = index % self.a_knot;
            let price = match (self.levels_move, self.is_gain(index)) {
                (true, true) if place > 0 => 0.0,
                (true, _) => STILL_PRICE,
                // The gain is the level, and may move as it likes.
                (false, true) => 0.0,
                (false, false) => MOTION_PRICE,
            };
            price * (now - before)
        });
        let modes = self.mode_numbers().iter().enumerate().map(|(index, x)| MODE_PRICE[index % 2] * x);
        let guides = self.guide_numbers().iter().map(|x| GUIDE_PRICE * x);
        let offsets = self.offsets().iter().map(|offset| OFFSET_PRICE * offset);
        motion.chain(modes).chain(guides).chain(offsets)
    }

    /// What the numbers stand for.
    pub(crate) fn sought(&self) -> Sought {
        let numbers = self.knot_numbers();
        let knot = |index: usize| numbers.get(index * self.a_knot..(index + 1) * self.a_knot).unwrap_or(&[]);
        let at = |time: usize| -> Vec<f64> {
            let (from, part) = (time / TIMES_A_KNOT, (time % TIMES_A_KNOT) as f64 / TIMES_A_KNOT as f64);
            let to = (from + 1).min(self.knots.saturating_sub(1));
            knot(from).iter().zip(knot(to)).map(|(from, to)| from + part * (to - from)).collect()
        };
        let (mut filters, mut levels) = (Vec::with_capacity(self.times), Vec::new());
        for time in 0..self.times {
            let mut free = at(time);
            if self.levels_move {
                levels.extend(free.pop());
            }
            filters.push(Lattice::of(self.shape, free));
        }
        let modes = self.modes.iter().zip(self.mode_numbers().chunks_exact(2)).map(|(mode, change)| DampedSine {
            amplitude: mode.amplitude * change[0].clamp(-2.0, 2.0).exp(),
            decay_per_s: mode.decay_per_s * change[1].clamp(-2.0, 2.0).exp(),
            ..*mode
        });
        let guides = self.guides.iter().zip(self.guide_numbers().chunks_exact(2)).map(|(guide, change)| {
            // The gain moves along a logistic curve, so that it stays below its bound.
            let most = SOUGHT_LOOP_GAIN.max(1.01 * guide.loop_gain);
            let share = (guide.loop_gain / most).clamp(0.02, 0.9999);
            let moved = (share / (1.0 - share)).ln() + change[0];
            Guide {
                loop_gain: most / (1.0 + (-moved).exp()),
                bandwidth_hz: (guide.bandwidth_hz * change[1].exp()).clamp(1.0, 0.2 * guide.frequency_hz),
                ..*guide
            }
        });
        Sought { filters, levels, modes: modes.collect(), guides: guides.collect() }
    }
}
