//! The additive way: a few modes beside the filter (dynamic-filter §III-B, §IV-B2).

use super::heard::{Mended, complete, descend, lacking, mend};
use super::joint::{Joint, Sought};
use super::lattice::Lattice;
use super::path::{db_per_s, path_of_filters, starts, times_s};
use super::response::{BandHearing, heard_in_band};
use super::{Comparison, Form, Model};
use crate::bark::{DampingBand, DampingLaw, width_hz};
use crate::modes::DampedSine;

/// Most modes of a model, as in the paper's soundboard.
pub const MOST_MODES: usize = 10;
/// Rounds of choosing modes for a path, and a path for modes.
const ROUNDS: usize = 3;
/// Modes that hold more than this share of a band's power at the strike make it ...
const MODES_MAKE: f64 = 0.5;
/// ... and the filter's noise will be left this share.
const ROOM: f64 = 0.03;
/// A decay off by so much is as bad as can be counted, in the logarithm.
const WORST: f64 = 0.45;
/// Bands that are offered modes at most.
const OFFERED: usize = 16;
/// A law of which so little is missed needs no other beginning.
const MET: f64 = 0.1;
/// What 10 dB of prominence is worth, in the units of the squared error of a band.
const PROMINENCE: f64 = 2e-3;

/// Chooses at most [`MOST_MODES`] of `modes` and the path of the noise beside them, so that each band decays by the law.
///
/// `modes` as they sound at the strike, with what each stands out of the smooth part of the spectrum (`emergence_db`,
/// [`crate::bark::emergence_db`]). Those are taken that bring the decays of the bands nearest to the law, the more prominent of equals; then filter
/// and modes are fitted together, and what is heard to be off is asked for anew.
pub fn additive(law: &DampingLaw, modes: &[DampedSine], emergence_db: &[f64], form: Form) -> Model {
    let times_s = times_s(law);
    let joint = Joint::new(law, &times_s);
    let off = |sought: &Sought| misfit(law, &times_s, &joint.powers(sought));
    let model_of =
        |sought: &Sought| Model { path: path_of_filters(law, sought), modes: sought.modes.clone(), loops: Vec::new() };
    let offered = |sought: &Sought, worst: &Comparison| {
        let taken: Vec<f64> = sought.modes.iter().map(|mode| mode.frequency_hz).collect();
        let with = |mode: DampedSine| {
            let mut more = with_room(law, &joint, sought);
            more.modes.push(DampedSine { decay_per_s: worst.recorded.decay_per_s, ..mode });
            more
        };
        lacking(worst, modes, &taken).into_iter().map(with).collect()
    };
    let mut best: Option<Mended<Sought>> = None;
    for mut sought in starts(law, &joint, form) {
        let mut tried = Vec::new();
        for _ in 0..ROUNDS {
            sought.modes = choose(law, modes, emergence_db, &sought.filters);
            let found = joint.descend(&sought);
            sought.filters.clone_from(&found.filters);
            tried.push(found);
        }
        let Some(found) = tried.into_iter().min_by(|a, b| off(a).total_cmp(&off(b))) else { continue };
        let now = complete(law, mend(law, &found, model_of, descend(law)), OFFERED, offered, model_of, descend(law));
        if best.as_ref().is_none_or(|best| now.heard.missed < best.heard.missed) {
            best = Some(now);
        }
        if best.as_ref().is_some_and(|best| best.heard.missed < MET) {
            break;
        }
    }
    best.map_or_else(Model::default, |best| best.model)
}

/// Without the mode whose loss is least, where there are as many as there may be.
fn with_room(law: &DampingLaw, joint: &Joint, sought: &Sought) -> Sought {
    let without = |at: usize| {
        let mut less = sought.clone();
        less.modes.remove(at);
        (misfit(law, &joint.times_s, &joint.powers(&less)), less)
    };
    let fewer = (0..sought.modes.len()).map(without).min_by(|a, b| a.0.total_cmp(&b.0));
    fewer.filter(|_| sought.modes.len() >= MOST_MODES).map_or_else(|| sought.clone(), |(_, less)| less)
}

/// The modes that filters lack most, one after the other.
fn choose(law: &DampingLaw, modes: &[DampedSine], emergence_db: &[f64], filters: &[Lattice]) -> Vec<DampedSine> {
    let times_s = times_s(law);
    let hearing: Vec<BandHearing> = law.bands.iter().map(|band| BandHearing::new(band.bark)).collect();
    let noise: Vec<Vec<f64>> = filters
        .iter()
        .map(|filter| {
            let squared = filter.squared();
            hearing.iter().map(|hearing| hearing.power(&squared)).collect()
        })
        .collect();
    let mut chosen: Vec<DampedSine> = Vec::new();
    let mut left: Vec<(DampedSine, f64)> = modes.iter().copied().zip(emergence_db.iter().copied()).collect();
    let measure = |modes: &[DampedSine]| misfit(law, &times_s, &with_modes(law, &times_s, &noise, modes));
    let mut best = measure(&chosen);
    while chosen.len() < MOST_MODES {
        let tried = left.iter().enumerate().map(|(index, (mode, emergence_db))| {
            let mut more = chosen.clone();
            more.push(*mode);
            (measure(&more) - PROMINENCE * emergence_db.max(0.0) / 10.0, index)
        });
        let Some((now, index)) = tried.min_by(|a, b| a.0.total_cmp(&b.0)) else { break };
        if now >= best {
            break;
        }
        best = now;
        chosen.push(left.remove(index).0);
    }
    chosen
}

/// Powers of noise and modes, `[time][band]`.
fn with_modes(law: &DampingLaw, times_s: &[f64], noise: &[Vec<f64>], modes: &[DampedSine]) -> Vec<Vec<f64>> {
    let held: Vec<Vec<f64>> = law
        .bands
        .iter()
        .map(|band| {
            let held = |mode: &DampedSine| mode.amplitude.powi(2) * heard_in_band(mode.frequency_hz, band.bark);
            modes.iter().map(held).collect()
        })
        .collect();
    // Where modes make a band, the next filter will leave them room.
    let kept: Vec<f64> = held
        .iter()
        .zip(&law.bands)
        .map(|(held, band)| {
            let share = held.iter().sum::<f64>() / band.gain.powi(2);
            if share > MODES_MAKE { ROOM } else { 1.0 - share }
        })
        .collect();
    let at = |(time_s, noise): (&f64, &Vec<f64>)| {
        let fallen: Vec<f64> = modes.iter().map(|mode| (-2.0 * mode.decay_per_s * time_s).exp()).collect();
        let bands = noise.iter().zip(&kept).zip(&held);
        bands
            .map(|((noise, kept), held)| kept * noise + held.iter().zip(&fallen).map(|(a, b)| a * b).sum::<f64>())
            .collect()
    };
    times_s.iter().zip(noise).map(at).collect()
}

/// Sum over the bands that count of the squared error of the logarithm of α, for powers `[time][band]`.
pub(crate) fn misfit(law: &DampingLaw, times_s: &[f64], powers: &[Vec<f64>]) -> f64 {
    let counts: Vec<f64> = super::counted(law).map(|band| band.bark).collect();
    let error = |(index, band): (usize, &DampingBand)| {
        let powers: Vec<f64> = powers.iter().map(|powers| powers.get(index).copied().unwrap_or(0.0)).collect();
        let decay = decay_db_per_s(band, times_s, &powers);
        (decay / db_per_s(band.decay_per_s)).max(1e-3).ln().abs().min(WORST).powi(2)
    };
    law.bands.iter().enumerate().filter(|(_, band)| counts.contains(&band.bark)).map(error).sum()
}

/// The straight line through a band's level over its first 40 dB, every second weighed alike, as the analysis sees it; dB/s.
pub(crate) fn decay_db_per_s(band: &DampingBand, times_s: &[f64], powers: &[f64]) -> f64 {
    let from_s = settled_s(band);
    let loudest = powers.iter().copied().fold(0.0, f64::max);
    let mut sums = [0.0; 5];
    for (pair, power) in times_s.windows(2).zip(powers.windows(2)) {
        let &[from, to] = pair else { continue };
        let time_s = 0.5 * (from + to);
        let mean = (power[0] * power[1]).sqrt();
        if time_s < from_s || mean < 1e-4 * loudest {
            continue;
        }
        let (weight, level) = (to - from, 10.0 * mean.max(1e-30).log10());
        for (sum, term) in sums.iter_mut().zip([1.0, time_s, level, time_s * time_s, time_s * level]) {
            *sum += weight * term;
        }
    }
    let [count, time, level, squared, product] = sums;
    let spread = count * squared - time * time;
    if spread <= 0.0 { 0.0 } else { -(count * product - time * level) / spread }
}

/// The analysis begins three standard deviations of the band's response behind the strike; seconds.
pub(crate) fn settled_s(band: &DampingBand) -> f64 {
    3.0 / (std::f64::consts::TAU * 0.5 * width_hz(band.centre_hz))
}
