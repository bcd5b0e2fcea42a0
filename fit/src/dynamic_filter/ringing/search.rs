//! The search: many first guesses, what is heard of the best of them mended.

use rayon::prelude::*;

use super::super::heard::{Mended, complete, hear, lacking, mend};
use super::super::joint::Joint;
use super::super::lattice::Lattice;
use super::super::{Comparison, RATE_HZ};
use super::numbers::Ringing;
use super::start::starts;
use crate::bark::DampingLaw;
use crate::modes::DampedSine;

/// So many of what the descents find are mended.
const MENDED: usize = 4;
/// Bands that are offered loops at most.
const OFFERED: usize = 5;
/// Modes of loops lie below so much of the rate.
const HIGHEST_PART: f64 = 0.42;

/// Loops that ring while the noise falls by its level: the best of what descents find, mended, with loops where it is heard to lack them.
pub(crate) fn search(
    law: &DampingLaw,
    joint: &Joint,
    modes: &[DampedSine],
    followed: Vec<Ringing>,
    filters: &[Lattice],
) -> Option<Mended<Ringing>> {
    let times_s = &joint.times_s;
    let usual: Vec<DampedSine> =
        modes.iter().filter(|mode| mode.frequency_hz < HIGHEST_PART * RATE_HZ).copied().collect();
    let starts: Vec<Ringing> = followed.into_iter().chain(starts(law, joint, filters, &usual)).collect();
    let found = starts.into_par_iter().map(|start| {
        let found = start.descend(joint);
        (hear(law, &found.model(times_s)).missed, found)
    });
    let mut found: Vec<(f64, Ringing)> = found.collect();
    found.sort_by(|a, b| a.0.total_cmp(&b.0));
    found.truncate(MENDED);
    let descend = |asked: &DampingLaw, found: &Ringing| found.follow(&Joint::new(asked, times_s));
    let model_of = |found: &Ringing| found.model(times_s);
    let mended: Vec<_> = found.into_par_iter().map(|(_, found)| mend(law, &found, model_of, descend)).collect();
    let best = mended.into_iter().min_by(|a, b| a.heard.missed.total_cmp(&b.heard.missed))?;
    let offered = |found: &Ringing, worst: &Comparison| {
        let lacking = lacking(worst, &usual, &found.frequencies_hz());
        lacking.iter().map(|mode| found.with(law, joint, mode, &worst.recorded)).collect()
    };
    Some(complete(law, best, OFFERED, offered, model_of, descend))
}
