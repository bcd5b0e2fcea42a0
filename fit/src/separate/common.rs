//! Modes that the recordings of a thing, or of a striker, have in common.
//!
//! Between blows every mode rings freely, with amplitudes of its own in each stretch. A thing's
//! poles are shared by all stretches of its recordings, a striker's by all of its own. All are
//! refined together (`crate::modes::refine_shared`), so that what one explains, the other does not.

use std::f64::consts::PI;
use std::ops::Range;

use rayon::prelude::*;

use super::parts::{Parts, common};
use crate::modes::{
    Candidate, Ending, Group, Model, NoiseFloor, Pole, SearchRange, Settings, refine_shared, stands_out,
};
use crate::parabola;

/// A stretch of a recording in which nothing is struck.
#[derive(Clone, Debug)]
pub(super) struct Quiet<'a> {
    /// Index of the recording.
    pub(super) clip: usize,
    /// Samples of the stretch.
    pub(super) samples: &'a [f64],
}

/// Time in seconds before a blow, and behind its beginning, in which its contact lies.
const GUARD_S: [f64; 2] = [0.002, 0.005];
/// Shortest and longest stretch in seconds.
const LENGTHS_S: [f64; 2] = [0.012, 0.8];
/// Maximum number of stretches of a recording, those of most energy.
const MOST_STRETCHES: usize = 4;
/// Maximum number of passes of search and refinement.
const PASSES: usize = 20;
/// Refinement between passes. The ridge keeps two modes in one place from cancelling.
const BETWEEN: Ending = Ending { steps: 4, gain: 1e-2, ridge: 1e-5 };
/// Refinement at the end.
const LAST: Ending = Ending { steps: 12, ..BETWEEN };
/// Refinement after modes were dropped.
const AFTER_DROPPING: Ending = Ending { steps: 2, ..BETWEEN };
/// Least share of modes that a pass has to add; with fewer the search goes on to the next parts.
const LEAST_GROWTH: f64 = 0.02;
/// Largest ratio of significance to a part's strongest candidate in one pass.
const IN_ONE_PASS: f64 = 100.0;

/// Stretches between the blows of a recording, those of most energy.
pub(super) fn quiet<'a>(clip: usize, samples: &'a [f64], blows: &[usize], rate_hz: f64) -> Vec<Quiet<'a>> {
    let in_samples = |seconds: f64| (seconds * rate_hz) as usize;
    let ends = blows.iter().skip(1).map(|next| next.saturating_sub(in_samples(GUARD_S[0]))).chain([samples.len()]);
    let mut stretches: Vec<Range<usize>> = blows
        .iter()
        .zip(ends)
        .map(|(blow, end)| {
            let start = (blow + in_samples(GUARD_S[1])).min(end);
            start..end.min(start + in_samples(LENGTHS_S[1]))
        })
        .filter(|stretch| stretch.len() >= in_samples(LENGTHS_S[0]))
        .collect();
    let energy = |stretch: &Range<usize>| samples[stretch.clone()].iter().map(|x| x * x).sum::<f64>();
    stretches.sort_by(|a, b| energy(b).total_cmp(&energy(a)));
    stretches.truncate(MOST_STRETCHES);
    stretches.into_iter().map(|stretch| Quiet { clip, samples: &samples[stretch] }).collect()
}

/// Poles, each with the part that it belongs to.
#[derive(Clone, Debug, Default)]
pub(super) struct Owned {
    pub(super) poles: Vec<Pole>,
    /// Part of each pole.
    pub(super) part: Vec<usize>,
}

impl Owned {
    /// Indices of the poles of a recording's two parts.
    pub(super) fn of_clip(&self, parts: &Parts, clip: usize) -> Vec<usize> {
        let mine = parts.of_clip[clip];
        (0..self.poles.len()).filter(|&pole| mine.contains(&self.part[pole])).collect()
    }
}

/// The search for common modes: what it has found, and what that leaves.
struct Search<'a> {
    parts: &'a Parts,
    stretches: &'a [Quiet<'a>],
    groups: Vec<Group<'a>>,
    range: SearchRange,
    /// Energy in units of the noise that a mode has to explain, for each part.
    thresholds: Vec<f64>,
    /// Number of poles at the beginning that are known and stay.
    known: usize,
}

/// Modes of all parts, searched for from known ones on. Parts that are `closed` get no others.
///
/// `report` hears the number of passes that are done, of at most [`passes`].
pub(super) fn common_modes(
    parts: &Parts,
    stretches: &[Quiet<'_>],
    rate_hz: f64,
    settings: Settings,
    known: Owned,
    closed: &[bool],
    report: &dyn Fn(usize),
) -> Option<Owned> {
    let longest = stretches.iter().map(|stretch| stretch.samples.len()).max()?;
    let samples: usize = stretches.iter().map(|stretch| stretch.samples.len()).sum();
    let of_part = |part: &usize| {
        let count = stretches.iter().filter(|stretch| parts.partner(*part, stretch.clip).is_some()).count();
        // Amplitudes explain two noise variances in each stretch; their scatter counts six times.
        6.0 * (4.0 * count as f64).sqrt() + 4.0 * (samples as f64).ln()
    };
    let search = Search {
        parts,
        stretches,
        groups: stretches.iter().map(|stretch| Group::ringing(stretch.samples)).collect(),
        range: SearchRange {
            slowest: 0.5 / longest as f64,
            fastest: (settings.fastest_decay_per_s / rate_hz).min(0.3),
            angular: (2.0 * PI * settings.lowest_hz / rate_hz, PI * 0.98),
        },
        thresholds: (0..parts.count).map(|part| of_part(&part)).collect(),
        known: known.poles.len(),
    };
    let mut owned = known;
    let (mut model, mut noise) = search.refined(&owned, BETWEEN)?;
    // Parts with several partners go first: what is left to a part with one is then its own.
    let mut with_one = false;
    for pass in 0..PASSES {
        report(pass);
        let open = |part: usize| !closed[part] && (with_one || parts.partners(part) > 1);
        let candidates = search.candidates(&owned, &model, &noise, settings.most_modes, &open);
        if candidates.is_empty() {
            if with_one {
                break;
            }
            with_one = true;
            continue;
        }
        let before = owned.poles.len();
        for (part, candidate) in candidates {
            owned.poles.push(candidate.pole);
            owned.part.push(part);
        }
        (owned, model, noise) = search.pruned(owned, BETWEEN)?;
        if (owned.poles.len() as f64) < (1.0 + LEAST_GROWTH) * before as f64 {
            if with_one {
                break;
            }
            with_one = true;
        }
    }
    let (owned, _, _) = search.pruned(owned, LAST)?;
    Some(owned)
}

/// Maximum number of passes that a search reports.
pub(super) fn passes() -> usize {
    PASSES
}

impl Search<'_> {
    fn members(&self, owned: &Owned) -> Vec<Vec<usize>> {
        self.stretches.iter().map(|stretch| owned.of_clip(self.parts, stretch.clip)).collect()
    }

    /// Poles refined, with the noise that they leave in each stretch.
    fn refined(&self, owned: &Owned, ending: Ending) -> Option<(Model, Vec<NoiseFloor>)> {
        let model = refine_shared(&self.groups, &self.members(owned), &owned.poles, self.known, ending)?;
        let noise = self.residuals(&model).par_iter().map(|left| NoiseFloor::of_residual(left)).collect();
        Some((model, noise))
    }

    fn residuals(&self, model: &Model) -> Vec<Vec<f64>> {
        let of_group = |index: usize| model.residual(index, &self.groups[index].stretches[0]);
        (0..self.groups.len()).into_par_iter().map(of_group).collect()
    }

    /// The refined model without modes that have left the range, or that explain too little with
    /// all partners but one.
    fn pruned(&self, owned: Owned, ending: Ending) -> Option<(Owned, Model, Vec<NoiseFloor>)> {
        let (mut owned, mut ending) = (owned, ending);
        loop {
            let (model, noise) = self.refined(&owned, ending)?;
            ending = AFTER_DROPPING;
            owned.poles.clone_from(&model.poles);
            let least: Vec<f64> =
                (0..owned.poles.len()).map(|pole| self.excess(&owned, &model, &noise, pole)).collect();
            let mut unworthy: Vec<usize> = (self.known..owned.poles.len()).filter(|&pole| least[pole] < 1.0).collect();
            if unworthy.is_empty() {
                return Some((owned, model, noise));
            }
            unworthy.sort_by(|a, b| least[*a].total_cmp(&least[*b]));
            // Of modes that may share what they explain, one goes at a time.
            let apart = |a: usize, b: usize| {
                let (near, width) =
                    (owned.poles[a].angular - owned.poles[b].angular, owned.poles[a].decay + owned.poles[b].decay);
                !self.parts.may_meet(owned.part[a], owned.part[b]) || near.abs() > 10.0 * width
            };
            let mut dropped: Vec<usize> = Vec::new();
            for pole in unworthy {
                if dropped.iter().all(|&other| apart(pole, other)) {
                    dropped.push(pole);
                }
            }
            let kept: Vec<usize> = (0..owned.poles.len()).filter(|pole| !dropped.contains(pole)).collect();
            owned = Owned {
                poles: kept.iter().map(|&pole| owned.poles[pole]).collect(),
                part: kept.iter().map(|&pole| owned.part[pole]).collect(),
            };
        }
    }

    /// Energy that a mode explains, as a share of what it has to; below 1 it goes.
    fn excess(&self, owned: &Owned, model: &Model, noise: &[NoiseFloor], index: usize) -> f64 {
        let (pole, part) = (owned.poles[index], owned.part[index]);
        let (lowest, highest) = self.range.angular;
        if pole.angular < 0.9 * lowest || pole.angular > highest || pole.decay > 1.5 * self.range.fastest {
            return 0.0;
        }
        let explained = self.stretches.iter().enumerate().map(|(group, stretch)| {
            let amplitude = model.gains[group].modes[index].norm_sqr();
            let energy = 0.5 * amplitude * energy_of(pole, stretch.samples.len());
            (stretch.clip, energy / noise[group].variance(pole.angular))
        });
        let own =
            self.stretches.iter().zip(noise).filter(|(stretch, _)| self.parts.partner(part, stretch.clip).is_some());
        let levels: Vec<f64> = own.map(|(_, noise)| noise.variance(pole.angular)).collect();
        let mean = levels.iter().sum::<f64>() / levels.len().max(1) as f64;
        let alone = model.worth(index) / mean;
        self.parts.shared(part, explained).min(alone) / self.thresholds[part]
    }

    /// Further modes, each for the part whose recordings have most of it in common.
    fn candidates(
        &self,
        owned: &Owned,
        model: &Model,
        noise: &[NoiseFloor],
        most: usize,
        open: &dyn Fn(usize) -> bool,
    ) -> Vec<(usize, Candidate)> {
        let residuals = self.residuals(model);
        let length = residuals.iter().map(Vec::len).max().unwrap_or(1);
        let open: Vec<usize> = (0..self.parts.count).filter(|&part| open(part)).collect();
        let decays: Vec<f64> = self.range.decays().collect();
        let mut found: Vec<(usize, Candidate)> = decays
            .par_iter()
            .flat_map_iter(|&decay| {
                let spectra: Vec<Vec<f64>> =
                    residuals.iter().zip(noise).map(|(left, noise)| significance(left, noise, decay, length)).collect();
                open.iter().flat_map(|&part| self.peaks(part, &spectra, decay)).collect::<Vec<_>>()
            })
            .filter(|(part, candidate)| {
                candidate.significance > self.thresholds[*part] && self.range.holds(candidate.pole.angular)
            })
            .collect();
        found.sort_by(|a, b| b.1.significance.total_cmp(&a.1.significance));
        let mut chosen: Vec<(usize, Candidate)> = Vec::new();
        let mut best = vec![0.0f64; self.parts.count];
        for (part, candidate) in found {
            best[part] = best[part].max(candidate.significance);
            let of_part = owned.part.iter().filter(|other| **other == part).count()
                + chosen.iter().filter(|other| other.0 == part).count();
            let stands_out = |(other, stronger): &(usize, Candidate)| {
                !self.parts.may_meet(part, *other) || stands_out(&candidate, stronger, length)
            };
            if of_part < most && candidate.significance * IN_ONE_PASS > best[part] && chosen.iter().all(stands_out) {
                chosen.push((part, candidate));
            }
        }
        chosen
    }

    /// Frequencies at which one more mode of a decay explains most of what a part's recordings have
    /// in common.
    fn peaks(&self, part: usize, spectra: &[Vec<f64>], decay: f64) -> Vec<(usize, Candidate)> {
        let own: Vec<usize> = (0..spectra.len())
            .filter(|&group| self.parts.partner(part, self.stretches[group].clip).is_some())
            .collect();
        let Some(length) = own.first().map(|&group| spectra[group].len()) else { return Vec::new() };
        let mut of_partner: Vec<Option<Vec<f64>>> = vec![None; self.parts.count];
        for &group in &own {
            let Some(partner) = self.parts.partner(part, self.stretches[group].clip) else { continue };
            let sums = of_partner[partner].get_or_insert_with(|| vec![0.0; length]);
            sums.iter_mut().zip(&spectra[group]).for_each(|(sum, energy)| *sum += energy);
        }
        let of_partner: Vec<Vec<f64>> = of_partner.into_iter().flatten().collect();
        let common: Vec<f64> =
            (0..length).map(|bin| common(of_partner.iter().map(|sums| sums[bin]), of_partner.len())).collect();
        let peaks = parabola::peaks(&common);
        peaks
            .map(|(place, significance)| {
                let angular = PI * place / (length - 1) as f64;
                (part, Candidate { pole: Pole { decay, angular }, significance })
            })
            .collect()
    }
}

/// Energy over the noise that one more mode of a decay explains, less the two variances that any
/// mode explains, at each frequency.
fn significance(residual: &[f64], noise: &NoiseFloor, decay: f64, longest: usize) -> Vec<f64> {
    let lasting = (6.0 / decay).ceil() as usize + 2;
    let size = (2 * longest.min(lasting)).next_power_of_two().max(64);
    let length = residual.len().min(lasting);
    let transform = fourier::forward(size);
    let (mut input, mut output) = (transform.make_input_vec(), transform.make_output_vec());
    let (mut weight, ratio, mut energy) = (1.0, (-decay).exp(), 0.0);
    for (slot, x) in input.iter_mut().zip(&residual[..length]) {
        *slot = x * weight;
        energy += weight * weight;
        weight *= ratio;
    }
    if transform.process(&mut input, &mut output).is_err() {
        return vec![0.0; output.len()];
    }
    let angular = |bin: usize| PI * bin as f64 / (size / 2) as f64;
    let bins = output.iter().enumerate();
    bins.map(|(bin, value)| 2.0 * value.norm_sqr() / energy / noise.variance(angular(bin)) - 2.0).collect()
}

/// Energy `Σ |z|²ⁿ` of a mode in a stretch.
fn energy_of(pole: Pole, length: usize) -> f64 {
    let twice = 2.0 * pole.decay;
    (1.0 - (-twice * length as f64).exp()) / (1.0 - (-twice).exp())
}
