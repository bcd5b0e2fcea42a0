//! Filter, modes and loops together: the descent that makes what all bands hear decay by the law.

use nalgebra::{DMatrix, DVector};

use super::additive::settled_s;
use super::damping::counted;
use super::guide::{Guide, crowding};
use super::lattice::{Lattice, WIDEST, squared};
use super::path::db_per_s;
use super::response::{BandHearing, heard_in_band};
use super::stability::MOST_LOOP_GAIN;
use super::{Form, RATE_HZ};
use crate::bark::{DampingLaw, HIGHEST_BARK, frequency_hz};
use crate::modes::DampedSine;

/// Every so many of the times has a filter of its own; between, its free numbers run straight.
const TIMES_A_KNOT: usize = 6;
/// A decay is read off so many dB.
const HEARD_DB: f64 = 40.0;
/// What a level may exceed after that.
const AFTER_DB: f64 = 52.0;
/// An error in every level of a band by so much counts half, dB: what cannot be followed must not spoil what can.
const HOPELESS_DB: f64 = 4.0;
/// Weight of a band that is too quiet to count.
const QUIET_WEIGHT: f64 = 0.05;
/// Weight of a band without a law: what is there has to stay below its nearest neighbour's.
const NEIGHBOUR_WEIGHT: f64 = 0.03;
/// So many bands from the law.
const NEIGHBOURS: f64 = 3.0;
/// Weight of what is too loud after the decay.
const AFTER_WEIGHT: f64 = 0.3;
/// Price of a band's level that is off at all times alike, dB a dB: decay comes before colour.
const OFFSET_PRICE: f64 = 0.15;
/// Price of changing a mode's amplitude and decay, dB a neper.
const MODE_PRICE: [f64; 2] = [1.5, 3.0];
/// Price of changing the odds of a loop's gain and the logarithm of its width, dB a unit.
const GUIDE_PRICE: f64 = 0.15;
/// Price of a loop's gain beyond its bound, dB a unit.
const UNSTABLE_PRICE: f64 = 300.0;
/// Price of change from knot to knot, dB a unit.
const MOTION_PRICE: f64 = 0.03;
/// Steps at most.
const STEPS: usize = 40;

/// What is sought.
#[derive(Clone, Debug)]
pub(crate) struct Sought {
    /// Filters at all times of [`times_s`].
    pub(crate) filters: Vec<Lattice>,
    /// Modes beside the filter.
    pub(crate) modes: Vec<DampedSine>,
    /// Loops round it.
    pub(crate) guides: Vec<Guide>,
    /// The time, counted, after which there is no noise and the filter stands still; none for never.
    pub(crate) end: Option<usize>,
}

impl Sought {
    /// Ends the noise, and stops the filter, behind a time.
    pub(crate) fn freeze_after(&mut self, end: Option<usize>) {
        self.end = end;
        let last = end.and_then(|end| self.filters.get(end)).cloned();
        if let (Some(end), Some(last)) = (end, last) {
            self.filters.iter_mut().skip(end + 1).for_each(|filter| filter.clone_from(&last));
        }
    }
}

/// One level that is asked for.
pub(crate) struct Row {
    /// The band and the time, counted.
    pub(crate) band: usize,
    time: usize,
    /// What it counts.
    pub(crate) weight: f64,
    level_db: f64,
    /// Only what exceeds the level is an error.
    ceiling: bool,
}

impl Row {
    /// By how much powers, `[time][band]`, are off, in a band whose level may be off at all times alike.
    pub(crate) fn error_db(&self, powers: &[Vec<f64>], offset_db: f64) -> f64 {
        let power = powers.get(self.time).and_then(|powers| powers.get(self.band)).copied().unwrap_or(0.0);
        let error = 10.0 * power.max(1e-30).log10() - self.level_db - offset_db;
        if self.ceiling { error.max(0.0) } else { error }
    }
}

/// The law as levels over time.
pub(crate) struct Joint {
    /// The times, seconds.
    pub(crate) times_s: Vec<f64>,
    /// The bands' rates in Bark: those of the law, then neighbours without one.
    pub(crate) rates: Vec<f64>,
    /// What they hear of noise.
    pub(crate) hearing: Vec<BandHearing>,
    /// What is asked for.
    pub(crate) rows: Vec<Row>,
    /// How many bands have a law, and with it an offset.
    lawful: usize,
}

impl Joint {
    /// Of a law at times.
    pub(crate) fn new(law: &DampingLaw, times_s: &[f64]) -> Self {
        let counts: Vec<f64> = counted(law).map(|band| band.bark).collect();
        let mut rates: Vec<f64> = law.bands.iter().map(|band| band.bark).collect();
        let mut rows = Vec::new();
        for (index, band) in law.bands.iter().enumerate() {
            let weight = if counts.contains(&band.bark) { 1.0 } else { QUIET_WEIGHT };
            let decay = db_per_s(band.decay_per_s);
            let (from_s, heard_s) = (settled_s(band), HEARD_DB / decay);
            let level = |time_s: f64| 20.0 * band.gain.log10() - decay * time_s;
            rows.extend(spread(times_s, from_s, from_s + heard_s, index, weight, false, level));
            let after = |time_s: f64| level(time_s).max(level(AFTER_DB / decay));
            // A draw that is louder for a moment long after would pass for the band's decay: until the end nothing may be.
            let end_s = times_s.last().copied().unwrap_or(0.0).max(from_s + 1.5 * heard_s);
            rows.extend(spread(times_s, from_s + heard_s, end_s, index, AFTER_WEIGHT * weight, true, after));
        }
        let lawful = rates.len();
        for rate in (1..=HIGHEST_BARK as u32).map(f64::from) {
            let apart = |bark: f64| (bark - rate).abs();
            let nearest = law.bands.iter().min_by(|a, b| apart(a.bark).total_cmp(&apart(b.bark)));
            let Some(band) = nearest.filter(|band| (0.5..=NEIGHBOURS).contains(&apart(band.bark))) else { continue };
            if frequency_hz(rate) > 0.45 * RATE_HZ {
                continue;
            }
            let decay = db_per_s(band.decay_per_s);
            let level = |time_s: f64| 20.0 * band.gain.log10() - decay * time_s;
            rows.extend(spread(times_s, 0.0, HEARD_DB / decay, rates.len(), NEIGHBOUR_WEIGHT, true, level));
            rates.push(rate);
        }
        let hearing = rates.iter().map(|rate| BandHearing::new(*rate)).collect();
        Self { times_s: times_s.to_vec(), rates, hearing, rows, lawful }
    }

    /// How many bands have a law.
    pub(crate) fn lawful(&self) -> usize {
        self.lawful
    }

    /// Powers that the bands hear, `[time][band]`.
    pub(crate) fn powers(&self, sought: &Sought) -> Vec<Vec<f64>> {
        let heard: Vec<Vec<(usize, f64)>> = sought
            .modes
            .iter()
            .map(|mode| {
                let in_band = |(band, rate): (usize, &f64)| {
                    let heard = heard_in_band(mode.frequency_hz, *rate);
                    (heard > 1e-9).then_some((band, heard * mode.amplitude.powi(2)))
                };
                self.rates.iter().enumerate().filter_map(in_band).collect()
            })
            .collect();
        let at = |(time, (time_s, filter)): (usize, (&f64, &Lattice))| {
            let squared = squared(&filter.coefficients());
            let mut powers: Vec<f64> = if sought.end.is_some_and(|end| time > end) {
                vec![0.0; self.hearing.len()]
            } else {
                self.hearing.iter().map(|hearing| hearing.power(&squared)).collect()
            };
            for (mode, heard) in sought.modes.iter().zip(&heard) {
                let fallen = (-2.0 * mode.decay_per_s * time_s).exp();
                for (band, power) in heard {
                    if let Some(sum) = powers.get_mut(*band) {
                        *sum += power * fallen;
                    }
                }
            }
            powers
        };
        let mut powers: Vec<Vec<f64>> = self.times_s.iter().zip(&sought.filters).enumerate().map(at).collect();
        for guide in &sought.guides {
            let heard: Vec<f64> = self.rates.iter().map(|rate| heard_in_band(guide.frequency_hz, *rate)).collect();
            for (powers, own) in powers.iter_mut().zip(guide.powers(&self.times_s, &sought.filters, sought.end)) {
                powers.iter_mut().zip(&heard).for_each(|(power, heard)| *power += heard * own);
            }
        }
        powers
    }

    /// Filters, modes and loops that bring the levels of all bands nearest to the law, from a start.
    pub(crate) fn descend(&self, start: &Sought) -> Sought {
        const NUDGE: f64 = 1e-4;
        let mut numbers = Numbers::of(start, self.lawful);
        let mut trust = vec![1.0; self.rates.len()];
        let mut errors = self.errors(&numbers, &trust);
        let mut damping = 1e-2;
        for step in 0..STEPS {
            if step % 5 == 4 {
                trust = self.trust(&numbers);
                errors = self.errors(&numbers, &trust);
            }
            let mut slopes = DMatrix::zeros(errors.len(), numbers.free.len());
            for index in 0..numbers.free.len() {
                let mut nudged = numbers.clone();
                nudged.free[index] += NUDGE;
                slopes.set_column(index, &((self.errors(&nudged, &trust) - &errors) / NUDGE));
            }
            let mut curvature = slopes.tr_mul(&slopes);
            for index in 0..numbers.free.len() {
                curvature[(index, index)] += damping * (curvature[(index, index)] + 1e-3);
            }
            let Some(step) = curvature.cholesky().map(|factors| factors.solve(&slopes.tr_mul(&errors))) else { break };
            let mut tried = numbers.clone();
            tried.free.iter_mut().zip(step.iter()).for_each(|(free, step)| *free -= step.clamp(-1.0, 1.0));
            tried.bound();
            let after = self.errors(&tried, &trust);
            let gained = errors.norm_squared() - after.norm_squared();
            if gained > 0.0 {
                let small = gained < 1e-4 * (1.0 + errors.norm_squared());
                (numbers, errors) = (tried, after);
                damping = (0.2 * damping).max(1e-9);
                if small {
                    break;
                }
            } else {
                damping *= 10.0;
                if damping > 1e8 {
                    break;
                }
            }
        }
        numbers.sought()
    }

    /// What each band's errors count, by how large they are: 1 where there are none.
    fn trust(&self, numbers: &Numbers) -> Vec<f64> {
        let mut sums = vec![(0.0, 1e-9); self.rates.len()];
        for (row, error) in self.rows.iter().zip(self.row_errors(numbers)) {
            if let Some((sum, weight)) = sums.get_mut(row.band) {
                *sum += row.weight * error * error;
                *weight += row.weight;
            }
        }
        sums.into_iter().map(|(sum, weight)| (1.0 + sum / weight / HOPELESS_DB.powi(2)).recip()).collect()
    }

    fn row_errors(&self, numbers: &Numbers) -> Vec<f64> {
        let powers = self.powers(&numbers.sought());
        let error = |row: &Row| row.error_db(&powers, numbers.offset_db(row.band));
        self.rows.iter().map(error).collect()
    }

    fn errors(&self, numbers: &Numbers, trust: &[f64]) -> DVector<f64> {
        let rows = self.row_errors(numbers);
        let weighed = self.rows.iter().zip(rows).map(|(row, error)| {
            let trust = trust.get(row.band).copied().unwrap_or(1.0);
            (trust * row.weight).sqrt() * error
        });
        let guides = numbers.sought().guides;
        let unstable: Vec<f64> =
            crowding(&guides).map(|gain| UNSTABLE_PRICE * (gain - MOST_LOOP_GAIN).max(0.0)).collect();
        let all: Vec<f64> = weighed.chain(numbers.prices()).chain(unstable).collect();
        DVector::from_vec(all)
    }
}

/// Rows of one band between two times, whose weights sum up to one.
fn spread(
    times_s: &[f64],
    from_s: f64,
    to_s: f64,
    band: usize,
    weight: f64,
    ceiling: bool,
    level_db: impl Fn(f64) -> f64,
) -> Vec<Row> {
    let inside = |time: usize| times_s.get(time).copied().filter(|time_s| (from_s..to_s).contains(time_s));
    let length_s = to_s - from_s;
    let rows = (0..times_s.len()).filter_map(|time| {
        let time_s = inside(time)?;
        let before = time.checked_sub(1).and_then(|before| times_s.get(before)).map_or(from_s, |t| t.max(from_s));
        let after = times_s.get(time + 1).map_or(to_s, |t| t.min(to_s));
        let share = 0.5 * (after - before) / length_s;
        Some(Row { band, time, weight: weight * share, level_db: level_db(time_s), ceiling })
    });
    rows.collect()
}

/// The free numbers of a descent: knots of the filter, then amplitude and decay of each mode, then the bands' offsets.
#[derive(Clone)]
struct Numbers {
    form: Form,
    times: usize,
    a_knot: usize,
    knots: usize,
    modes: Vec<DampedSine>,
    guides: Vec<Guide>,
    end: Option<usize>,
    free: Vec<f64>,
}

impl Numbers {
    fn of(start: &Sought, bands: usize) -> Self {
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

    fn offset_db(&self, band: usize) -> f64 {
        let from = self.knots * self.a_knot + 2 * (self.modes.len() + self.guides.len());
        self.free.get(from + band).copied().unwrap_or(0.0)
    }

    fn bound(&mut self) {
        let (a_knot, count) = (self.a_knot.max(1), self.knots * self.a_knot);
        for (index, free) in self.free.iter_mut().enumerate().take(count) {
            if index % a_knot > 0 {
                *free = free.clamp(-WIDEST, WIDEST);
            }
        }
    }

    /// What the priors cost.
    fn prices(&self) -> impl Iterator<Item = f64> + '_ {
        let filters = self.filter_numbers();
        let motion = filters.iter().skip(self.a_knot).zip(filters);
        let motion = motion.enumerate().map(|(index, (now, before))| {
            // The gain may move as it likes.
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

    fn sought(&self) -> Sought {
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
        Sought {
            filters: (0..self.times).map(filter).collect(),
            modes: modes.collect(),
            guides: guides.collect(),
            end: self.end,
        }
    }
}
