//! Free numbers of a candidate, and their prices.

use super::candidate::Candidate;
use crate::dynamic_filter::guide::Guide;
use crate::dynamic_filter::lattice::{Lattice, WIDEST};
use crate::dynamic_filter::model::Form;
use crate::dynamic_filter::stability::MOST_LOOP_GAIN;
use crate::modes::DampedSine;

/// Number of times between two knots, at which the filter's numbers are free; they run straight
/// between.
const TIMES_A_KNOT: usize = 6;
/// Price of an offset of a band's level at all times, in dB a dB: decay comes before colour.
const OFFSET_PRICE: f64 = 0.15;
/// Prices of changing a mode's amplitude and its decay, in dB a neper.
const MODE_PRICE: [f64; 2] = [1.5, 3.0];
/// Price of changing the log-odds of a loop's gain or the logarithm of its width, in dB a unit.
const GUIDE_PRICE: f64 = 0.15;
/// Price of a change of the filter from knot to knot, in dB a unit.
const MOTION_PRICE: f64 = 0.03;

/// Free numbers of a descent, in this order: the filter's knots, two numbers for each mode, two for
/// each loop, and each band's offset.
///
/// A mode's numbers change its amplitude and its decay.
#[derive(Clone)]
pub(super) struct Numbers {
    form: Form,
    times: usize,
    a_knot: usize,
    knots: usize,
    modes: Vec<DampedSine>,
    guides: Vec<Guide>,
    end: Option<usize>,
    pub(super) free: Vec<f64>,
}

impl Numbers {
    pub(super) fn of(start: &Candidate, bands: usize) -> Self {
        let form = start.filters.first().map_or(Form::FirstOrder, Lattice::form);
        let times = start.filters.len();
        let knots = times.saturating_sub(1).div_ceil(TIMES_A_KNOT) + 1;
        let at = |knot: usize| start.filters.get((knot * TIMES_A_KNOT).min(times.saturating_sub(1)));
        let mut free: Vec<f64> = (0..knots).filter_map(at).flat_map(|filter| filter.free.iter().copied()).collect();
        let a_knot = start.filters.first().map_or(0, |filter| filter.free.len());
        free.resize(free.len() + 2 * (start.modes.len() + start.guides.len()) + bands, 0.0);
        Self {
            form,
            times,
            a_knot,
            knots,
            modes: start.modes.clone(),
            guides: start.guides.clone(),
            end: start.end,
            free,
        }
    }

    fn filter_numbers(&self) -> &[f64] {
        self.free.get(..self.knots * self.a_knot).unwrap_or(&[])
    }

    fn mode_numbers(&self) -> &[f64] {
        let from = self.knots * self.a_knot;
        self.free.get(from..from + 2 * self.modes.len()).unwrap_or(&[])
    }

    fn guide_numbers(&self) -> &[f64] {
        let from = self.knots * self.a_knot + 2 * self.modes.len();
        self.free.get(from..from + 2 * self.guides.len()).unwrap_or(&[])
    }

    pub(super) fn offset_db(&self, band: usize) -> f64 {
        let from = self.knots * self.a_knot + 2 * (self.modes.len() + self.guides.len());
        self.free.get(from + band).copied().unwrap_or(0.0)
    }

    pub(super) fn bound(&mut self) {
        let (a_knot, count) = (self.a_knot.max(1), self.knots * self.a_knot);
        for (index, free) in self.free.iter_mut().enumerate().take(count) {
            if index % a_knot > 0 {
                *free = free.clamp(-WIDEST, WIDEST);
            }
        }
    }

    /// Errors in dB that stand for the prices.
    pub(super) fn prices(&self) -> impl Iterator<Item = f64> + '_ {
        let filters = self.filter_numbers();
        let motion = filters.iter().skip(self.a_knot).zip(filters);
        let motion = motion.enumerate().map(|(index, (now, before))| {
            // The gain is free to move.
            if index % self.a_knot == 0 { 0.0 } else { MOTION_PRICE * (now - before) }
        });
        let modes = self.mode_numbers().iter().enumerate().map(|(index, x)| MODE_PRICE[index % 2] * x);
        let guides = self.guide_numbers().iter().map(|x| GUIDE_PRICE * x);
        let from = self.knots * self.a_knot + 2 * (self.modes.len() + self.guides.len());
        motion
            .chain(modes)
            .chain(guides)
            .chain(self.free.get(from..).unwrap_or(&[]).iter().map(|offset| OFFSET_PRICE * offset))
    }

    pub(super) fn candidate(&self) -> Candidate {
        let numbers = self.filter_numbers();
        let knot = |index: usize| numbers.get(index * self.a_knot..(index + 1) * self.a_knot).unwrap_or(&[]);
        let filter = |time: usize| {
            let time = self.end.map_or(time, |end| time.min(end));
            let (from, part) = (time / TIMES_A_KNOT, (time % TIMES_A_KNOT) as f64 / TIMES_A_KNOT as f64);
            let to = (from + 1).min(self.knots.saturating_sub(1));
            let free = knot(from).iter().zip(knot(to)).map(|(from, to)| from + part * (to - from));
            Lattice::of(self.form, free.collect())
        };
        let modes = self.modes.iter().zip(self.mode_numbers().chunks_exact(2)).map(|(mode, change)| DampedSine {
            amplitude: mode.amplitude * change[0].clamp(-2.0, 2.0).exp(),
            decay_per_s: mode.decay_per_s * change[1].clamp(-2.0, 2.0).exp(),
            ..*mode
        });
        let guides = self.guides.iter().zip(self.guide_numbers().chunks_exact(2)).map(|(guide, change)| {
            // The gain moves along a logistic curve, so that it stays below its bound.
            let share = (guide.loop_gain / MOST_LOOP_GAIN).clamp(0.02, 0.9999);
            let moved = (share / (1.0 - share)).ln() + change[0];
            Guide {
                loop_gain: MOST_LOOP_GAIN / (1.0 + (-moved).exp()),
                bandwidth_hz: (guide.bandwidth_hz * change[1].exp()).clamp(1.0, 0.2 * guide.frequency_hz),
                ..*guide
            }
        });
        Candidate {
            filters: (0..self.times).map(filter).collect(),
            modes: modes.collect(),
            guides: guides.collect(),
            end: self.end,
        }
    }
}
