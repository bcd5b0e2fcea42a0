//! First guesses of a descent.

use std::f64::consts::{PI, TAU};

use super::circle::Circle;
use super::numbers::{A_LOOP, Ringing};
use crate::bark::{DampingBand, DampingLaw, bark};
use crate::dynamic_filter::damping::counted;
use crate::dynamic_filter::delay::delay_s;
use crate::dynamic_filter::lattice::Lattice;
use crate::dynamic_filter::misfit::misfit;
use crate::dynamic_filter::model::{Coefficients, MOST_MODES, RATE_HZ};
use crate::dynamic_filter::objective::{Candidate, Objective};
use crate::dynamic_filter::response::{NOISE_DENSITY, response, sine_power_in_band};
use crate::modes::DampedSine;
use crate::score::quantile;

/// Quantiles of the bands' decays that are tried as the noise's decay.
const NOISE_DECAYS: [f64; 5] = [0.3, 0.5, 0.7, 0.85, 1.0];
/// Number of nepers by which the noise falls until its end.
const NOISE_NEPERS: f64 = 9.0;
/// Largest decay of a band with a loop, as a part of the noise's decay.
const SLOWER: f64 = 0.95;
/// Bound of a loop's half-width, as a part of the distance to its nearest neighbour.
const CROWDED: [f64; 2] = [0.03, 0.1];
/// Least distance between two loops in Bark.
const APART_BARK: f64 = 0.4;
/// Share of a mode's power that must lie in a band for the mode to count as inside it.
const INSIDE: f64 = 0.2;
/// Least ratio of a loop's half-width to its decay.
const LEAST_WIDTH: f64 = 1.3;
/// Least ln of the noise's level.
const LEAST_LEVEL: f64 = -11.0;
/// Least value of 1 - gain, for the gain round the loops at a knot.
const LEAST_MISSING: f64 = 2e-3;
/// Largest value of 1 - gain, for the gain round the loops at a loop's centre.
const MOST_MISSING: f64 = 0.9;

/// First guesses for each of `filters`.
pub(super) fn starts(
    law: &DampingLaw,
    objective: &Objective,
    filters: &[Lattice],
    modes: &[DampedSine],
) -> Vec<Ringing> {
    let mut decays: Vec<f64> = counted(law).map(|band| band.decay_per_s).collect();
    decays.sort_by(f64::total_cmp);
    let of_filter = |filter: &Lattice| {
        let of_decay =
            |part: f64| CROWDED.map(|crowded| start(law, objective, filter, modes, quantile(&decays, part), crowded));
        NOISE_DECAYS.map(of_decay)
    };
    filters.iter().flat_map(of_filter).flatten().collect()
}

/// A filter that stands still, noise that falls, and loops in the loudest of the bands that fall
/// more slowly.
fn start(
    law: &DampingLaw,
    objective: &Objective,
    filter: &Lattice,
    modes: &[DampedSine],
    noise_decay_per_s: f64,
    crowded: f64,
) -> Ringing {
    let times_s = &objective.times_s;
    let last = times_s.len().saturating_sub(1);
    let end = times_s.partition_point(|time_s| time_s * noise_decay_per_s < NOISE_NEPERS).min(last);
    let knots = Ringing::knots_until(end);
    let second = |time: &usize| times_s.get(*time).copied().unwrap_or(0.0);
    let of_knot = |time: &usize| {
        let level = (-noise_decay_per_s * second(time)).max(LEAST_LEVEL);
        std::iter::once(level).chain(filter.free.iter().copied())
    };
    let mut free: Vec<f64> = knots.iter().flat_map(of_knot).collect();
    let coefficients = filter.coefficients();
    let slower: Vec<(DampedSine, DampingBand)> = slower(law, modes, SLOWER * noise_decay_per_s);
    let mut loops = Vec::new();
    for (mode, band) in &slower {
        let filter = response(&coefficients, TAU * mode.frequency_hz / RATE_HZ);
        // This residue makes the loop as loud as the band while the noise falls.
        let residue = (2.0 * noise_decay_per_s / NOISE_DENSITY).sqrt() * band.gain / filter.norm().max(1e-9);
        let apart = |(other, _): &(DampedSine, DampingBand)| TAU * (other.frequency_hz - mode.frequency_hz).abs();
        let nearest = slower.iter().map(apart).filter(|apart| *apart > 0.0).fold(TAU * mode.frequency_hz, f64::min);
        let (frames, numbers) =
            numbers_of_loop(residue, band.decay_per_s, crowded * nearest, mode.frequency_hz, filter.arg());
        loops.push((mode.frequency_hz, frames));
        free.extend(numbers);
    }
    free.resize(free.len() + objective.lawful(), 0.0);
    let ringing = Ringing { form: filter.form(), knots, loops, free };
    let filters = vec![coefficients; ringing.knots.len()];
    ringing.with_gains_of(times_s, &filters)
}

/// Delay in whole samples, and free numbers, of a loop round a filter with the phase `phase`.
///
/// `residue` and `decay_per_s` are asked for, both in 1/s. `widest` bounds the half-width, and with
/// it the residue.
fn numbers_of_loop(residue: f64, decay_per_s: f64, widest: f64, frequency_hz: f64, phase: f64) -> (f64, [f64; A_LOOP]) {
    let half_width = (residue + decay_per_s).min(widest).max(LEAST_WIDTH * decay_per_s).max(PI);
    let delay_s = delay_s(frequency_hz, phase);
    let missing = (decay_per_s * (1.0 + half_width * delay_s) / half_width).min(MOST_MISSING);
    ((delay_s * RATE_HZ).floor(), [missing.ln(), (half_width / PI).ln()])
}

/// The loudest bands that fall more slowly than the noise, each with its loudest mode.
///
/// At most [`MOST_MODES`] of them.
fn slower(law: &DampingLaw, modes: &[DampedSine], noise_decay_per_s: f64) -> Vec<(DampedSine, DampingBand)> {
    let mut bands: Vec<DampingBand> =
        counted(law).filter(|band| band.decay_per_s < noise_decay_per_s).copied().collect();
    bands.sort_by(|a, b| b.gain.total_cmp(&a.gain));
    let mut taken: Vec<(DampedSine, DampingBand)> = Vec::new();
    for band in bands {
        let heard = |mode: &DampedSine| sine_power_in_band(mode.frequency_hz, band.bark);
        let is_apart = |mode: &&DampedSine| {
            taken.iter().all(|(other, _)| (bark(other.frequency_hz) - bark(mode.frequency_hz)).abs() > APART_BARK)
        };
        let inside = modes.iter().filter(|mode| heard(mode) > INSIDE).filter(is_apart);
        let power = |mode: &DampedSine| heard(mode) * mode.amplitude.powi(2);
        let loudest = inside.max_by(|a, b| power(a).total_cmp(&power(b))).copied();
        taken.extend(loudest.map(|mode| (mode, band)));
        if taken.len() == MOST_MODES {
            break;
        }
    }
    taken
}

/// The numbers of a candidate of a descent without levels, if its noise ends and its loops ring on.
pub(crate) fn of_candidate(objective: &Objective, candidate: &Candidate) -> Option<Ringing> {
    let times_s = &objective.times_s;
    let end = candidate.end.filter(|end| *end > 0 && !candidate.guides.is_empty())?.min(times_s.len() - 1);
    let (knots, last) = (Ringing::knots_until(end), candidate.filters.get(end)?);
    let filters: Vec<&Lattice> = knots.iter().filter_map(|time| candidate.filters.get(*time)).collect();
    let mut free: Vec<f64> =
        filters.iter().flat_map(|filter| std::iter::once(0.0).chain(filter.free.iter().copied())).collect();
    let mut loops = Vec::new();
    for guide in &candidate.guides {
        let angular = TAU * guide.frequency_hz / RATE_HZ;
        let magnitude = |filter: &Lattice| filter.squared()(angular).sqrt();
        let loudest = candidate.filters.iter().map(magnitude).fold(f64::MIN_POSITIVE, f64::max);
        let gain = guide.loop_gain * magnitude(last) / loudest;
        let phase = response(&last.coefficients(), angular).arg();
        loops.push((guide.frequency_hz, (delay_s(guide.frequency_hz, phase) * RATE_HZ).floor()));
        free.extend([(1.0 - gain).clamp(LEAST_MISSING, MOST_MISSING).ln(), guide.bandwidth_hz.ln()]);
    }
    free.resize(free.len() + objective.lawful(), 0.0);
    let form = last.form();
    let coefficients: Vec<_> = filters.iter().map(|filter| filter.coefficients()).collect();
    Some(Ringing { form, knots, loops, free }.with_gains_of(times_s, &coefficients))
}

impl Ringing {
    /// These numbers with one more loop, at `mode` in `band`.
    ///
    /// If there are [`MOST_MODES`] loops already, it replaces the one whose loss increases the
    /// misfit least.
    pub(crate) fn with(&self, law: &DampingLaw, objective: &Objective, mode: &DampedSine, band: &DampingBand) -> Self {
        let off =
            |less: &Self| misfit(law, &objective.times_s, &less.powers(objective, &less.decoded(&objective.times_s)));
        let is_full = self.loops.len() >= MOST_MODES;
        let fewer = (0..self.loops.len()).filter(|_| is_full).map(|index| self.without(index));
        let least = fewer.map(|less| (off(&less), less)).min_by(|a, b| a.0.total_cmp(&b.0));
        let mut more = least.map_or_else(|| self.clone(), |(_, less)| less);
        let decoded = self.decoded(&objective.times_s);
        let Some((last, _)) = decoded.knots.last() else { return more };
        let filter = response(last, TAU * mode.frequency_hz / RATE_HZ);
        let steps =
            objective.times_s.windows(2).zip(&decoded.levels).map(|(pair, level)| level * level * (pair[1] - pair[0]));
        let noise_s: f64 = steps.sum::<f64>().max(f64::MIN_POSITIVE);
        let residue = band.gain / filter.norm().max(1e-9) / (NOISE_DENSITY * noise_s).sqrt();
        let apart = |(other_hz, _): &(f64, f64)| TAU * (other_hz - mode.frequency_hz).abs();
        let nearest = more.loops.iter().map(apart).fold(TAU * mode.frequency_hz, f64::min);
        let numbers = numbers_of_loop(residue, band.decay_per_s, nearest * CROWDED[1], mode.frequency_hz, filter.arg());
        let at = more.first_of_offsets();
        more.free.splice(at..at, numbers.1);
        more.loops.push((mode.frequency_hz, numbers.0));
        let filters: Vec<Coefficients> = decoded.knots.iter().map(|knot| knot.0).collect();
        more.with_gains_of(&objective.times_s, &filters)
    }

    fn without(&self, index: usize) -> Self {
        let mut less = self.clone();
        let from = self.first_of_loops() + A_LOOP * index;
        less.free.drain(from..from + A_LOOP);
        less.loops.remove(index);
        less
    }

    /// Frequencies of the loops in Hz.
    pub(crate) fn frequencies_hz(&self) -> Vec<f64> {
        self.loops.iter().map(|(hz, _)| *hz).collect()
    }

    /// These numbers with knots whose filters have the gains of `filters`, as far as the loops stay
    /// stable.
    pub(super) fn with_gains_of(mut self, times_s: &[f64], filters: &[Coefficients]) -> Self {
        self.bound();
        let decoded = self.decoded(times_s);
        let centres_hz: Vec<f64> = self.loops.iter().map(|(hz, _)| *hz).collect();
        let circle = Circle::new(&decoded.bands, &decoded.gains, &centres_hz, &decoded.widths_hz);
        let a_knot = self.a_knot();
        for (knot, filter) in filters.iter().enumerate().take(self.knots.len().saturating_sub(1)) {
            let most = if self.loops.is_empty() { 0.0 } else { circle.largest(filter) };
            if let Some(number) = self.free.get_mut(knot * a_knot + 1) {
                *number = (1.0 - most).clamp(LEAST_MISSING, 1.0).ln();
            }
        }
        self
    }
}
