//! The waveguide way: loops round the filter that favour a few modes (dynamic-filter §III-B, §IV-B2, eq. 8 to 13 and 22).
//!
//! A loop's mode cannot decay slower than the filter round which it runs while that closes. So the decay that all bands share is in the level of the
//! noise, the strike of eq. 8's x(n), and the filter only changes its colour: struck by that noise, a loop rings on at a decay of its own,
//! `πΔf (1 - |F| γ_s)`. Bands that are gone early are the noise's, those that last the loops'.

use std::f64::consts::{PI, TAU};

use super::additive::{MOST_MODES, PROMINENCE, misfit};
use super::counted;
use super::guide::{Guide, Guides, usual_over_last};
use super::heard::mend;
use super::joint::{Joint, SOUGHT_LOOP_GAIN, Sought};
use super::lattice::Lattice;
use super::numbers::{DEEPEST, mild};
use super::path::{path_of, starts, times_s};
use super::response::heard_in_band;
use super::stability::stabilise;
use super::{Form, Loop, Model, RATE_HZ};
use crate::bark::{DampingLaw, bark};
use crate::modes::DampedSine;
use crate::score::quantile;

/// A loop's delay is at least so many samples, so that a board computes it a tick at a time.
pub const SHORTEST_DELAY: f64 = 32.0;
/// Rounds of choosing loops for noise and filter, and noise and filter for loops.
const ROUNDS: usize = 2;
/// Where the noise's level begins to fall as fast as a band: these quantiles of the law's decays.
const FALLS: [f64; 2] = [0.5, 1.0];
/// Where the noise ends, in the other beginning, as parts of the time until the slowest band has died away.
const ENDS: [f64; 2] = [0.06, 0.25];
/// Gains of loops that are tried.
const GAINS: [f64; 5] = [0.3, 0.6, 0.8, 0.9, 0.96];
/// What a loop's decay hangs on the filter's gain costs, in the units of the squared error of a band, a unit of 1/(1 - |F| γ_s).
const DEPENDENCE: f64 = 5e-4;
/// So much more error may cost a loop that the fit of all together may need.
const WORTH: f64 = 0.03;
/// Loops are at least so many Bark apart: two in a band would beat, and each would turn the other's phase.
const APART_BARK: f64 = 0.4;

/// Delay in seconds that brings a wave round a loop back in phase (eq. 22).
pub(crate) fn delay_s(frequency_hz: f64, filter_phase: f64) -> f64 {
    let period = RATE_HZ / frequency_hz;
    let first = filter_phase / TAU * period;
    let turns = ((SHORTEST_DELAY - first) / period).ceil();
    (first + turns * period) / RATE_HZ
}

/// Chooses at most [`MOST_MODES`] loops at modes of the recording, and noise, path, gains and widths so that each band decays by the law.
///
/// Begins with a filter that stands still, the colour of the strike, and noise that falls like one of the bands; or with the filter of noise alone,
/// which stands still from where the noise ends. Loops are taken that bring the decays of the bands nearest to the law, one after the other; then all
/// is fitted together, delays are tuned to the filter found, and what is heard to be off is asked for anew. What sounds best of both beginnings is kept.
pub fn waveguide(law: &DampingLaw, modes: &[DampedSine], emergence_db: &[f64], form: Form) -> Model {
    let times_s = times_s(law);
    let joint = Joint::new(law, &times_s);
    let off = |sought: &Sought| misfit(law, &times_s, &joint.powers(sought));
    let first = starts(law, &joint, form).into_iter().min_by(|a, b| off(a).total_cmp(&off(b)));
    let Some(first) = first else { return Model::default() };
    let decays: Vec<f64> = counted(law).map(|band| band.decay_per_s).collect();
    let fitted = |start: Sought| {
        let mut sought = start;
        let mut best: Option<(f64, Sought)> = None;
        for _ in 0..ROUNDS {
            sought.guides = choose(law, &times_s, &joint, modes, emergence_db, &sought);
            tune(&times_s, &mut sought);
            sought = joint.descend(&sought);
            tune(&times_s, &mut sought);
            let now = off(&sought);
            if best.as_ref().is_none_or(|best| now < best.0) {
                best = Some((now, sought.clone()));
            }
        }
        best
    };
    let standing = FALLS.map(|part| fitted(standing(&times_s, &first, quantile(&decays, part))));
    let ending = ENDS.map(|part| fitted(ending(&times_s, &first, part)));
    let best = [standing, ending].map(|found| found.into_iter().flatten().min_by(|a, b| a.0.total_cmp(&b.0)));
    let heard = best.iter().flatten().map(|(_, sought)| mend(law, sought, &model_of));
    heard.min_by(|a, b| a.0.total_cmp(&b.0)).map_or_else(Model::default, |(_, model)| model)
}

/// The path and the loops as a table has them, stable.
fn model_of(law: &DampingLaw, sought: &Sought) -> Model {
    let (path, louder) = path_of(law, sought);
    let filters = sought.coefficients();
    let gains = Guides::new(&sought.guides, &filters);
    let loops = sought.guides.iter().zip(gains.gains()).map(|(guide, gain)| {
        let Guide { frequency_hz, bandwidth_hz, delay_s, .. } = *guide;
        Loop { frequency_hz, bandwidth_hz, gain: gain / louder, delay_s }
    });
    let mut loops: Vec<Loop> = loops.collect();
    stabilise(&path, &mut loops);
    Model { path, modes: Vec::new(), loops }
}

/// A filter that stands still as another begins, with noise whose level falls at a rate in 1/s.
fn standing(times_s: &[f64], start: &Sought, fall_per_s: f64) -> Sought {
    let mut filter = start.filters.first().cloned();
    filter.iter_mut().for_each(soften);
    let filters = times_s.iter().filter_map(|_| filter.clone()).collect();
    let levels = times_s.iter().map(|time_s| (-fall_per_s * time_s).max(-DEEPEST)).collect();
    Sought { levels, ..Sought::of_filters(filters) }
}

/// A filter that moves as another, with noise at its full level, until a part of the time is over: then the filter stands still, and there is no noise.
fn ending(times_s: &[f64], start: &Sought, part: f64) -> Sought {
    let last_s = times_s.last().copied().unwrap_or(0.0);
    let end = times_s.partition_point(|time_s| *time_s < part * last_s);
    let mut sought = start.clone();
    if let Some(last) = sought.filters.get(end).cloned() {
        sought.filters.iter_mut().skip(end).for_each(|filter| filter.clone_from(&last));
    }
    sought.filters.iter_mut().for_each(soften);
    sought.levels = (0..times_s.len()).map(|time| if time > end { -DEEPEST } else { 0.0 }).collect();
    sought
}

/// Brings a filter's poles to where loops can be round it.
fn soften(filter: &mut Lattice) {
    let shape = filter.shape();
    for (place, number) in filter.free.iter_mut().enumerate().skip(1) {
        let [least, most] = mild(shape, place);
        *number = number.clamp(least, most);
    }
}

/// Loops that bring the decays of bands nearest to the law, one after the other, the more prominent of equals.
fn choose(
    law: &DampingLaw,
    times_s: &[f64],
    joint: &Joint,
    modes: &[DampedSine],
    emergence_db: &[f64],
    sought: &Sought,
) -> Vec<Guide> {
    let (filters, noise) = (sought.coefficients(), sought.noise_powers());
    let mut powers = joint.powers(&Sought { guides: Vec::new(), ..sought.clone() });
    let mut left: Vec<Candidate> = Vec::new();
    for (mode, emergence_db) in modes.iter().zip(emergence_db) {
        let heard: Vec<f64> = law.bands.iter().map(|band| heard_in_band(mode.frequency_hz, band.bark)).collect();
        let usual_over_last = usual_over_last(mode.frequency_hz, &filters);
        for guide in GAINS.iter().filter_map(|gain| alone(mode, *gain, usual_over_last)) {
            let mut own = Sought { guides: vec![guide], ..sought.clone() };
            tune(times_s, &mut own);
            let over_time = Guides::new(&own.guides, &filters).along(times_s, &noise).powers;
            left.extend(own.guides.into_iter().zip(over_time).map(|(guide, over_time)| {
                let price = DEPENDENCE / (1.0 - guide.loop_gain).max(0.01) - PROMINENCE * emergence_db.max(0.0) / 10.0;
                Candidate { guide, heard: heard.clone(), over_time, price }
            }));
        }
    }
    let mut chosen: Vec<Guide> = Vec::new();
    let mut best = misfit(law, times_s, &powers);
    while chosen.len() < MOST_MODES {
        let tried = left.iter().map(|candidate| {
            let with = candidate.added_to(&powers);
            (misfit(law, times_s, &with) + candidate.price, candidate.guide, with)
        });
        let Some((now, guide, with)) = tried.min_by(|a, b| a.0.total_cmp(&b.0)) else { break };
        if now >= best + WORTH {
            break;
        }
        let all: Vec<Guide> = chosen.iter().copied().chain([guide]).collect();
        let crowded =
            Guides::new(&all, &filters).along(times_s, &noise).crowding.iter().any(|gain| *gain >= SOUGHT_LOOP_GAIN);
        if crowded {
            left.retain(|candidate| candidate.guide != guide);
            continue;
        }
        let apart = |other: &Guide| (bark(other.frequency_hz) - bark(guide.frequency_hz)).abs();
        left.retain(|candidate| apart(&candidate.guide) >= APART_BARK);
        (best, powers, chosen) = (now, with, all);
    }
    chosen
}

/// A loop that may be taken.
struct Candidate {
    guide: Guide,
    /// What each band of the law hears of it.
    heard: Vec<f64>,
    over_time: Vec<f64>,
    price: f64,
}

impl Candidate {
    fn added_to(&self, powers: &[Vec<f64>]) -> Vec<Vec<f64>> {
        let with = |(powers, own): (&Vec<f64>, &f64)| {
            // Behind the law's bands stand those that have none.
            let heard = self.heard.iter().chain(std::iter::repeat(&0.0));
            powers.iter().zip(heard).map(|(power, heard)| power + heard * own).collect()
        };
        powers.iter().zip(&self.over_time).map(with).collect()
    }
}

/// The loop of a gain that decays as a mode does round the last filter, where its band is not too wide for that.
fn alone(mode: &DampedSine, loop_gain: f64, usual_over_last: f64) -> Option<Guide> {
    let frequency_hz = mode.frequency_hz;
    let angular = TAU * frequency_hz / RATE_HZ;
    let bandwidth_hz = mode.decay_per_s / (1.0 - loop_gain) / PI * angular / angular.sin();
    let fits = frequency_hz < 0.45 * RATE_HZ && (1.0..0.2 * frequency_hz).contains(&bandwidth_hz);
    let delay_s = delay_s(frequency_hz, 0.0);
    fits.then(|| Guide { frequency_hz, bandwidth_hz, loop_gain: loop_gain * usual_over_last, delay_s })
}

/// Tunes delays to the filter, and to each other.
fn tune(times_s: &[f64], sought: &mut Sought) {
    let filters = sought.coefficients();
    for _ in 0..3 {
        let decays: Vec<f64> = sought.guides.iter().map(|guide| guide.beta_per_s() * (1.0 - guide.loop_gain)).collect();
        let delays_s = Guides::new(&sought.guides, &filters).tuned_delays_s(times_s, &decays);
        sought.guides.iter_mut().zip(delays_s).for_each(|(guide, delay_s)| guide.delay_s = delay_s);
    }
}
