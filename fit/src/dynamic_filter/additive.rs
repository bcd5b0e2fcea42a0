//! The additive method: a few modes beside the filter (dynamic-filter §III-B, §IV-B2).

use super::damping::Comparison;
use super::evaluation::{Corrected, complete, correct, descend, missing_modes};
use super::lattice::Lattice;
use super::misfit::misfit;
use super::model::{Form, MOST_MODES, Model};
use super::objective::{Candidate, Objective};
use super::path::{path_of_filters, starts};
use super::response::{NoiseBand, sine_power_in_band};
use super::times::times_s;
use crate::bark::DampingLaw;
use crate::modes::DampedSine;

/// Number of rounds in which modes are chosen for a path, and a path for the modes.
const ROUNDS: usize = 3;
/// Share of a band's power at the strike from which modes count as making up the band.
const MODES_MAKE: f64 = 0.5;
/// Share of the filter's noise that is assumed to remain in a band that modes make up.
const ROOM: f64 = 0.03;
/// Maximum number of bands for which modes are tried after the first fit.
const OFFERED: usize = 16;
/// Share of the work on a start that is done when modes are chosen, for the progress bar.
const CHOSEN: f64 = 0.3;
/// Share of that work that is done when the law asked for is corrected.
const CORRECTED: f64 = 0.6;
/// Value of `Evaluation::missed` below which no other start is tried.
const MET: f64 = 0.1;
/// Value of 10 dB of emergence when modes are compared, in units of a band's squared error.
const PROMINENCE: f64 = 2e-3;

/// Chooses at most [`MOST_MODES`] of `modes`, and the path of the noise beside them, so that each
/// band decays by the law.
///
/// Amplitudes and phases of `modes` are those at the strike. `emergence_db` is the level in dB by
/// which each stands out of the smooth part of the spectrum ([`crate::bark::emergence_db`]). The
/// modes that bring the bands' decays nearest to the law are chosen; of equals, the more prominent
/// one. Then filter and modes are fitted together, and the law asked for is corrected by the errors
/// measured in the rendered sound.
///
/// `told` gets the share of the work that is done.
pub fn additive(
    law: &DampingLaw,
    modes: &[DampedSine],
    emergence_db: &[f64],
    form: Form,
    told: &(dyn Fn(f64) + Sync),
) -> Model {
    let times_s = times_s(law);
    let objective = Objective::new(law, &times_s);
    let off = |candidate: &Candidate| misfit(law, &times_s, &objective.powers(candidate));
    let model_of = |candidate: &Candidate| Model {
        path: path_of_filters(law, candidate),
        modes: candidate.modes.clone(),
        loops: Vec::new(),
    };
    let offered = |candidate: &Candidate, worst: &Comparison| {
        let taken: Vec<f64> = candidate.modes.iter().map(|mode| mode.frequency_hz).collect();
        let with = |mode: DampedSine| {
            let mut more = with_room(law, &objective, candidate);
            more.modes.push(DampedSine { decay_per_s: worst.recorded.decay_per_s, ..mode });
            more
        };
        missing_modes(worst, modes, &taken).into_iter().map(with).collect()
    };
    let mut best: Option<Corrected<Candidate>> = None;
    let starts = starts(law, &objective, form);
    let count = starts.len() as f64;
    for (start, mut candidate) in starts.into_iter().enumerate() {
        let told = |share: f64| told((start as f64 + share) / count);
        let mut tried = Vec::new();
        for _ in 0..ROUNDS {
            candidate.modes = choose(law, modes, emergence_db, &candidate.filters);
            let found = objective.descend(&candidate);
            candidate.filters.clone_from(&found.filters);
            tried.push(found);
            told(CHOSEN * tried.len() as f64 / ROUNDS as f64);
        }
        let Some(found) = tried.into_iter().min_by(|a, b| off(a).total_cmp(&off(b))) else { continue };
        let corrected = correct(law, &found, model_of, descend(law));
        let told = |share: f64| told(CORRECTED + (1.0 - CORRECTED) * share);
        let now = complete(law, corrected, OFFERED, &told, offered, model_of, descend(law));
        if best.as_ref().is_none_or(|best| now.evaluation.missed < best.evaluation.missed) {
            best = Some(now);
        }
        if best.as_ref().is_some_and(|best| best.evaluation.missed < MET) {
            break;
        }
    }
    best.map_or_else(Model::default, |best| best.model)
}

/// The candidate, reduced by its least important mode if it has [`MOST_MODES`].
fn with_room(law: &DampingLaw, objective: &Objective, candidate: &Candidate) -> Candidate {
    let without = |at: usize| {
        let mut less = candidate.clone();
        less.modes.remove(at);
        (misfit(law, &objective.times_s, &objective.powers(&less)), less)
    };
    let fewer = (0..candidate.modes.len()).map(without).min_by(|a, b| a.0.total_cmp(&b.0));
    fewer.filter(|_| candidate.modes.len() >= MOST_MODES).map_or_else(|| candidate.clone(), |(_, less)| less)
}

/// Modes that improve the misfit of filters most, chosen one after the other.
fn choose(law: &DampingLaw, modes: &[DampedSine], emergence_db: &[f64], filters: &[Lattice]) -> Vec<DampedSine> {
    let times_s = times_s(law);
    let noise_bands: Vec<NoiseBand> = law.bands.iter().map(|band| NoiseBand::new(band.bark)).collect();
    let noise: Vec<Vec<f64>> = filters
        .iter()
        .map(|filter| {
            let squared = filter.squared();
            noise_bands.iter().map(|band| band.power(&squared)).collect()
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

/// Powers of noise and modes as `[time][band]`.
fn with_modes(law: &DampingLaw, times_s: &[f64], noise: &[Vec<f64>], modes: &[DampedSine]) -> Vec<Vec<f64>> {
    let held: Vec<Vec<f64>> = law
        .bands
        .iter()
        .map(|band| {
            let held = |mode: &DampedSine| mode.amplitude.powi(2) * sine_power_in_band(mode.frequency_hz, band.bark);
            modes.iter().map(held).collect()
        })
        .collect();
    // Where modes make up a band, the next fit of the filter leaves little noise there.
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
