//! Search over many first guesses, with corrections of the best.

use std::sync::atomic::{AtomicUsize, Ordering};

use rayon::prelude::*;

use super::numbers::Ringing;
use super::start::starts;
use crate::bark::DampingLaw;
use crate::dynamic_filter::damping::Comparison;
use crate::dynamic_filter::evaluation::{Corrected, complete, correct, evaluate, missing_modes};
use crate::dynamic_filter::lattice::Lattice;
use crate::dynamic_filter::model::RATE_HZ;
use crate::dynamic_filter::objective::Objective;
use crate::modes::DampedSine;

/// Number of the descents' best results that are corrected.
const CORRECTED: usize = 4;
/// Maximum number of bands for which loops are tried after that.
const OFFERED: usize = 5;
/// Share of the search that is done when the descents have ended, for the progress bar.
const DESCENDED: f64 = 0.5;
/// Share of the search that is done when the best results are corrected.
const COMPLETED_FROM: f64 = 0.7;
/// Upper bound of the loops' frequencies, as a part of the sample rate.
const HIGHEST_PART: f64 = 0.42;

/// Finds loops that ring while the noise falls by its level.
///
/// The best results of all descents are corrected by their evaluation. Loops are then added in
/// bands that are missed. `told` gets the share of the work that is done.
pub(crate) fn search(
    law: &DampingLaw,
    objective: &Objective,
    modes: &[DampedSine],
    followed: Vec<Ringing>,
    filters: &[Lattice],
    told: &(dyn Fn(f64) + Sync),
) -> Option<Corrected<Ringing>> {
    let times_s = &objective.times_s;
    let usual: Vec<DampedSine> =
        modes.iter().filter(|mode| mode.frequency_hz < HIGHEST_PART * RATE_HZ).copied().collect();
    let starts: Vec<Ringing> = followed.into_iter().chain(starts(law, objective, filters, &usual)).collect();
    let (count, done) = (starts.len() as f64, AtomicUsize::new(0));
    let found = starts.into_par_iter().map(|start| {
        let found = start.descend(objective);
        let missed = evaluate(law, &found.model(times_s)).missed;
        told(DESCENDED * (done.fetch_add(1, Ordering::Relaxed) + 1) as f64 / count);
        (missed, found)
    });
    let mut found: Vec<(f64, Ringing)> = found.collect();
    found.sort_by(|a, b| a.0.total_cmp(&b.0));
    found.truncate(CORRECTED);
    let descend = |asked: &DampingLaw, found: &Ringing| found.follow(&Objective::new(asked, times_s));
    let model_of = |found: &Ringing| found.model(times_s);
    let corrected: Vec<_> = found.into_par_iter().map(|(_, found)| correct(law, &found, model_of, descend)).collect();
    let best = corrected.into_iter().min_by(|a, b| a.evaluation.missed.total_cmp(&b.evaluation.missed))?;
    let offered = |found: &Ringing, worst: &Comparison| {
        let missing_modes = missing_modes(worst, &usual, &found.frequencies_hz());
        missing_modes.iter().map(|mode| found.with(law, objective, mode, &worst.recorded)).collect()
    };
    let told = |share: f64| told(COMPLETED_FROM + (1.0 - COMPLETED_FROM) * share);
    Some(complete(law, best, OFFERED, &told, offered, model_of, descend))
}
