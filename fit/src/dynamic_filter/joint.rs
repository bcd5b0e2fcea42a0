//! Filter, noise, modes and loops together: the descent that makes what all bands hear decay by the law.

use nalgebra::{DMatrix, DVector};

use super::additive::settled_s;
use super::damping::counted;
use super::guide::{Guide, Guided, Guides};
use super::lattice::{Lattice, squared};
use super::numbers::Numbers;
use super::path::db_per_s;
use super::response::{BandHearing, heard_in_band};
use super::{Coefficients, RATE_HZ};
use crate::bark::{DampingLaw, HIGHEST_BARK, frequency_hz};
use crate::modes::DampedSine;

/// A decay is read off so many dB.
const HEARD_DB: f64 = 40.0;
/// What a level may exceed after that.
const AFTER_DB: f64 = 46.0;
/// An error in every level of a band by so much counts half, dB: what cannot be followed must not spoil what can.
const HOPELESS_DB: f64 = 4.0;
/// Weight of a band that is too quiet to count.
const QUIET_WEIGHT: f64 = 0.05;
/// Weight of a band without a law: what is there has to stay below its nearest neighbour's.
const NEIGHBOUR_WEIGHT: f64 = 0.03;
/// So many bands from the law.
const NEIGHBOURS: f64 = 3.0;
/// Weight of what is too loud before the decay is looked at: a click would do for the loops, but not for the ear.
const BEFORE_WEIGHT: f64 = 0.3;
/// Weight of what is too loud after the decay.
const AFTER_WEIGHT: f64 = 0.3;
/// Price of a loop's gain beyond its bound, dB a unit.
const UNSTABLE_PRICE: f64 = 300.0;
/// What `|F| Σ|B_s|` at the centre of a loop may reach in the descent: between the centres it may be a little more.
pub(crate) const SOUGHT_LOOP_GAIN: f64 = 0.985;
/// Steps at most.
const STEPS: usize = 40;
/// What cannot be followed is looked at anew after so many steps.
const TRUSTED: usize = 4;

/// What is sought.
#[derive(Clone, Debug)]
pub(crate) struct Sought {
    /// Filters at all times.
    pub(crate) filters: Vec<Lattice>,
    /// The logarithm of the noise's level at all times, up to a constant; empty where it stays.
    pub(crate) levels: Vec<f64>,
    /// Modes beside the filter.
    pub(crate) modes: Vec<DampedSine>,
    /// Loops round it.
    pub(crate) guides: Vec<Guide>,
}

impl Sought {
    /// Noise that stays, through filters, alone.
    pub(crate) fn of_filters(filters: Vec<Lattice>) -> Self {
        Self { filters, levels: Vec::new(), modes: Vec::new(), guides: Vec::new() }
    }

    /// The filters' coefficients.
    pub(crate) fn coefficients(&self) -> Vec<Coefficients> {
        self.filters.iter().map(Lattice::coefficients).collect()
    }

    /// The noise's power at all times, as a ratio.
    pub(crate) fn noise_powers(&self) -> Vec<f64> {
        match self.levels.as_slice() {
            [] => vec![1.0; self.filters.len()],
            levels => levels.iter().map(|level| (2.0 * level).exp()).collect(),
        }
    }
}

/// One level that is asked for.
struct Row {
    band: usize,
    time: usize,
    weight: f64,
    level_db: f64,
    /// Only what exceeds the level is an error.
    ceiling: bool,
}

/// The law as levels over time.
pub(crate) struct Joint {
    times_s: Vec<f64>,
    rates: Vec<f64>,
    hearing: Vec<BandHearing>,
    rows: Vec<Row>,
    /// How many bands have a law, and with it an offset.
    lawful: usize,
}

impl Joint {
    /// Of a law at times.
    pub(crate) fn new(law: &DampingLaw, times_s: &[f64]) -> Self {
        let times_s = times_s.to_vec();
        let counts: Vec<f64> = counted(law).map(|band| band.bark).collect();
        let mut rates: Vec<f64> = law.bands.iter().map(|band| band.bark).collect();
        let mut rows = Vec::new();
        for (index, band) in law.bands.iter().enumerate() {
            let weight = if counts.contains(&band.bark) { 1.0 } else { QUIET_WEIGHT };
            let decay = db_per_s(band.decay_per_s);
            let (from_s, heard_s) = (settled_s(band), HEARD_DB / decay);
            let level = |time_s: f64| 20.0 * band.gain.log10() - decay * time_s;
            rows.extend(spread(&times_s, 0.0, from_s, index, BEFORE_WEIGHT * weight, true, level));
            rows.extend(spread(&times_s, from_s, from_s + heard_s, index, weight, false, level));
            let after = |time_s: f64| level(time_s).max(level(AFTER_DB / decay));
            let end_s = from_s + 1.5 * heard_s;
            rows.extend(spread(&times_s, from_s + heard_s, end_s, index, AFTER_WEIGHT * weight, true, after));
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
            rows.extend(spread(&times_s, 0.0, HEARD_DB / decay, rates.len(), NEIGHBOUR_WEIGHT, true, level));
            rates.push(rate);
        }
        let hearing = rates.iter().map(|rate| BandHearing::new(*rate)).collect();
        Self { times_s, rates, hearing, rows, lawful }
    }

    /// Powers that the bands hear, `[time][band]`.
    pub(crate) fn powers(&self, sought: &Sought) -> Vec<Vec<f64>> {
        self.look(sought).0
    }

    /// Powers that the bands hear, `[time][band]`, and how near each loop is to what it may gain.
    fn look(&self, sought: &Sought) -> (Vec<Vec<f64>>, Vec<f64>) {
        let (filters, noise) = (sought.coefficients(), sought.noise_powers());
        let at = |(filter, noise): (&Coefficients, &f64)| -> Vec<f64> {
            let squared = squared(filter);
            self.hearing.iter().map(|hearing| noise * hearing.power(&squared)).collect()
        };
        let mut powers: Vec<Vec<f64>> = filters.iter().zip(&noise).map(at).collect();
        let mut add = |frequency_hz: f64, over_time: &[f64]| {
            for (band, rate) in self.rates.iter().enumerate() {
                let heard = heard_in_band(frequency_hz, *rate);
                if heard > 1e-9 {
                    powers.iter_mut().zip(over_time).for_each(|(powers, own)| powers[band] += heard * own);
                }
            }
        };
        for mode in &sought.modes {
            let fallen = |time_s: &f64| mode.amplitude.powi(2) * (-2.0 * mode.decay_per_s * time_s).exp();
            add(mode.frequency_hz, &self.times_s.iter().map(fallen).collect::<Vec<f64>>());
        }
        let Guided { powers: of_guides, crowding } = Guides::new(&sought.guides, &filters).along(&self.times_s, &noise);
        sought.guides.iter().zip(&of_guides).for_each(|(guide, own)| add(guide.frequency_hz, own));
        (powers, crowding)
    }

    /// Filters, modes and loops that bring the levels of all bands nearest to the law, from a start.
    pub(crate) fn descend(&self, start: &Sought) -> Sought {
        const NUDGE: f64 = 1e-4;
        let mut numbers = Numbers::of(start, self.lawful);
        let mut trust = vec![1.0; self.rates.len()];
        let mut errors = self.errors(&numbers, &trust);
        let mut damping = 1e-2;
        let mut known: Option<(DMatrix<f64>, DVector<f64>)> = None;
        let mut taken = 0;
        for _ in 0..STEPS {
            let (curvature, gradient) = known.get_or_insert_with(|| {
                let mut slopes = DMatrix::zeros(errors.len(), numbers.free.len());
                for index in 0..numbers.free.len() {
                    let mut nudged = numbers.clone();
                    nudged.free[index] += NUDGE;
                    slopes.set_column(index, &((self.errors(&nudged, &trust) - &errors) / NUDGE));
                }
                (slopes.tr_mul(&slopes), slopes.tr_mul(&errors))
            });
            let mut damped = curvature.clone();
            for index in 0..numbers.free.len() {
                damped[(index, index)] += damping * (curvature[(index, index)] + 1e-3);
            }
            let Some(step) = damped.cholesky().map(|factors| factors.solve(gradient)) else { break };
            let mut tried = numbers.clone();
            tried.free.iter_mut().zip(step.iter()).for_each(|(free, step)| *free -= step.clamp(-1.0, 1.0));
            tried.bound();
            let after = self.errors(&tried, &trust);
            let gained = errors.norm_squared() - after.norm_squared();
            if gained <= 0.0 {
                damping *= 10.0;
                if damping > 1e8 {
                    break;
                }
                continue;
            }
            let small = gained < 1e-4 * (1.0 + errors.norm_squared());
            (numbers, errors) = (tried, after);
            known = None;
            damping = (0.2 * damping).max(1e-9);
            taken += 1;
            if taken % TRUSTED == 0 {
                trust = self.trust(&numbers);
                errors = self.errors(&numbers, &trust);
            } else if small {
                break;
            }
        }
        numbers.sought()
    }

    /// What each band's errors count, by how large they are: 1 where there are none.
    fn trust(&self, numbers: &Numbers) -> Vec<f64> {
        let mut sums = vec![(0.0, 1e-9); self.rates.len()];
        for (row, error) in self.rows.iter().zip(self.row_errors(numbers).0) {
            if let Some((sum, weight)) = sums.get_mut(row.band) {
                *sum += row.weight * error * error;
                *weight += row.weight;
            }
        }
        sums.into_iter().map(|(sum, weight)| (1.0 + sum / weight / HOPELESS_DB.powi(2)).recip()).collect()
    }

    fn row_errors(&self, numbers: &Numbers) -> (Vec<f64>, Vec<f64>) {
        let (powers, crowding) = self.look(&numbers.sought());
        let error = |row: &Row| {
            let power = powers.get(row.time).and_then(|powers| powers.get(row.band)).copied().unwrap_or(0.0);
            let error = 10.0 * power.max(1e-30).log10() - row.level_db - numbers.offset_db(row.band);
            if row.ceiling { error.max(0.0) } else { error }
        };
        (self.rows.iter().map(error).collect(), crowding)
    }

    fn errors(&self, numbers: &Numbers, trust: &[f64]) -> DVector<f64> {
        let (rows, crowding) = self.row_errors(numbers);
        let weighed = self.rows.iter().zip(rows).map(|(row, error)| {
            let trust = trust.get(row.band).copied().unwrap_or(1.0);
            (trust * row.weight).sqrt() * error
        });
        let unstable = crowding.iter().map(|gain| UNSTABLE_PRICE * (gain - SOUGHT_LOOP_GAIN).max(0.0));
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
