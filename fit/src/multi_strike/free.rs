//! Modes that ring freely between strikes, each with an amplitude of its own in every stretch.
//!
//! The amplitudes follow in closed form, stretch by stretch; the poles are shared
//! (`crate::modes::refine`). So the modes need no knowledge of the forces.

use std::f64::consts::PI;
use std::ops::Range;

use rayon::prelude::*;

use super::layout::Layout;
use super::whitening::Whitening;
use crate::modes::{Candidate, Ending, Group, Model, NoiseFloor, Pole, SearchRange, Settings, refine, standing_out};
use crate::parabola;

/// Time in seconds in which a contact lies, about the moment near which it was found.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Guard {
    /// Time before the moment.
    pub(crate) before_s: f64,
    /// Time behind the moment, contact time included.
    pub(crate) behind_s: f64,
    /// Maximum length in seconds of a stretch in which modes are searched for.
    longest_s: f64,
    left_out: LeftOut,
}

/// Numbers of stretches, those that tell most of a mode, that do not count for it.
///
/// A strike that was missed spoils one stretch, and modes could be found in it alone.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LeftOut {
    searching: usize,
    dropping: usize,
}

impl LeftOut {
    /// Stretches with strikes at one place. Where modes are dropped all count: a room leaves more
    /// than noise in all.
    const AT_ONE_PLACE: Self = Self { searching: 2, dropping: 0 };
    /// Stretches with strikes at several places or by several strikers, of which more are missed at
    /// first. With the numbers for one place, 12 of 64 modes were true ones in
    /// `cargo bench -p fit --bench strikes -- 1 312 places`, and 21 of 90 strikes were lost.
    const AT_PLACES: Self = Self { searching: 3, dropping: 3 };
}

/// Number of stretches of a count that are left out, `most` or none: others must tell the mode.
fn left_out(most: usize, count: usize) -> usize {
    if count > 3 * most { most } else { 0 }
}

impl Guard {
    /// Guard about a rise in the ear's bands.
    pub(crate) const OF_RISE: Self =
        Self { before_s: 0.010, behind_s: 0.014, longest_s: LONGEST_S, left_out: LeftOut::AT_ONE_PLACE };
    /// Guard about a change of amplitudes.
    pub(crate) const OF_CHANGE: Self =
        Self { before_s: 0.004, behind_s: 0.006, longest_s: LONGEST_S, left_out: LeftOut::AT_ONE_PLACE };

    /// Guard of a recording of such a layout.
    pub(super) fn of_layout(self, layout: Layout) -> Self {
        if layout == Layout::default() { self } else { Self { left_out: LeftOut::AT_PLACES, ..self } }
    }

    /// Guard with short stretches, of which missed strikes spoil few: in longer ones no mode was
    /// found in `cargo bench -p fit --bench strikes -- 1 321 places`.
    pub(super) fn with_short_stretches(self) -> Self {
        Self { longest_s: SHORT_S, ..self }
    }
}

/// Poles, and what they leave between strikes: its variance, and the filter that makes it white.
#[derive(Clone, Debug)]
pub(crate) struct FreeModes {
    pub(crate) poles: Vec<Pole>,
    pub(crate) variance: f64,
    pub(crate) whitening: Whitening,
    /// Variance of what is left, filtered.
    pub(crate) white_variance: f64,
}

/// Maximum number of stretches that are left out.
const MOST_LEFT_OUT: usize = 3;
/// Least length of a stretch in seconds.
const SHORTEST_S: f64 = 0.015;
/// Maximum length of a stretch in seconds in which modes are searched for.
const LONGEST_S: f64 = 0.8;
/// Maximum length of such a stretch in seconds where missed strikes spoil longer ones.
const SHORT_S: f64 = 0.1;
/// Maximum number of stretches in which modes are searched for, those of most energy.
const MOST_STRETCHES: usize = 14;
/// Maximum number of passes of search and refinement.
const PASSES: usize = 16;

/// Stretch behind each strike in which the modes ring freely; empty if there is no time for one.
pub(crate) fn stretches(onsets: &[usize], guard: Guard, length: usize, rate_hz: f64) -> Vec<Range<usize>> {
    let [guard, lead] = [guard.behind_s, guard.before_s].map(|seconds| samples_in(seconds, rate_hz));
    let shortest = shortest(rate_hz);
    let ends = onsets.iter().skip(1).map(|next| next.saturating_sub(lead)).chain([length]);
    let of_strike = |(onset, end): (&usize, usize)| {
        let start = (onset + guard).min(length);
        if end < start + shortest { start..start } else { start..end }
    };
    onsets.iter().zip(ends).map(of_strike).collect()
}

/// Least length of a stretch in samples.
pub(super) fn shortest(rate_hz: f64) -> usize {
    samples_in(SHORTEST_S, rate_hz)
}

fn samples_in(seconds: f64, rate_hz: f64) -> usize {
    (seconds * rate_hz) as usize
}

/// The stretches of most energy, of each at most `longest` samples; in order of time.
fn loudest(samples: &[f64], stretches: &[Range<usize>], longest: usize, most: usize) -> Vec<Range<usize>> {
    let mut chosen: Vec<Range<usize>> = stretches
        .iter()
        .filter(|stretch| !stretch.is_empty())
        .map(|stretch| stretch.start..stretch.end.min(stretch.start + longest))
        .collect();
    let energy = |stretch: &Range<usize>| samples[stretch.clone()].iter().map(|x| x * x).sum::<f64>();
    chosen.sort_by(|a, b| energy(b).total_cmp(&energy(a)));
    chosen.truncate(most);
    chosen.sort_by_key(|stretch| stretch.start);
    chosen
}

/// Maximum number of modes that are looked for where fewer leave a coloured residual.
pub(super) const MORE_MODES: usize = 24;

/// Modes that ring between strikes, searched for from known ones on; `None` if there is no time
/// between any.
pub(crate) fn free_modes(
    samples: &[f64],
    onsets: &[usize],
    guard: Guard,
    rate_hz: f64,
    settings: Settings,
    known: &[Pole],
) -> Option<FreeModes> {
    let stretches = stretches(onsets, guard, samples.len(), rate_hz);
    free_modes_of(samples, (&stretches, guard), rate_hz, settings, known)
}

/// Modes that ring in stretches, searched for from known ones on; `None` if all are empty.
pub(super) fn free_modes_of(
    samples: &[f64],
    (stretches, guard): (&[Range<usize>], Guard),
    rate_hz: f64,
    settings: Settings,
    known: &[Pole],
) -> Option<FreeModes> {
    let Guard { longest_s, left_out, .. } = guard;
    let chosen = loudest(samples, stretches, samples_in(longest_s, rate_hz), MOST_STRETCHES);
    let groups: Vec<Group<'_>> = chosen.iter().map(|stretch| Group::ringing(&samples[stretch.clone()])).collect();
    let length = chosen.iter().map(Range::len).max()?;
    let range = search_range(length, rate_hz, settings);
    let threshold = threshold(groups.len(), samples.len());
    let mut model = refine(&groups, known, Ending::COARSE)?;
    if !known.is_empty() {
        let noise = NoiseFloor::of_residual(&residuals(&groups, &model).concat());
        model = pruned(&groups, model, &noise, range, (threshold, left_out.dropping))?;
    }
    for _ in 0..PASSES {
        let residuals = residuals(&groups, &model);
        let noise = NoiseFloor::of_residual(&residuals.concat());
        let free = settings.most_modes.saturating_sub(model.poles.len());
        let candidates = search(&residuals, &noise, range, (threshold, left_out.searching), free);
        if candidates.is_empty() {
            break;
        }
        let with = |candidates: &[Pole]| {
            let poles = [&model.poles, candidates].concat();
            pruned(&groups, refine(&groups, &poles, Ending::COARSE)?, &noise, range, (threshold, left_out.dropping))
        };
        let mut count = candidates.len();
        let mut more = with(&candidates);
        // Many first modes may share their energy so that none is worth its numbers.
        while count > 1 && more.as_ref().is_some_and(|more| more.poles.is_empty()) {
            count /= 2;
            more = with(&candidates[..count]);
        }
        let Some(more) = more else { break };
        model = more;
    }
    // A stretch with a missed strike in it tells no noise.
    let mut quiet = residuals(&groups, &model);
    let power = |left: &Vec<f64>| left.iter().map(|x| x * x).sum::<f64>() / left.len() as f64;
    quiet.sort_by(|a, b| power(a).total_cmp(&power(b)));
    let variance = power(&quiet[quiet.len() / 4]).max(LEAST_VARIANCE);
    quiet.truncate(quiet.len() / 2 + 1);
    let whitening = Whitening::of_residual(&quiet.concat(), WHITENING);
    let mut white: Vec<f64> =
        quiet.iter().map(|left| power(&whitening.filtered(left, whitening.order()..left.len()))).collect();
    white.sort_by(f64::total_cmp);
    let white_variance = white[white.len() / 2].max(LEAST_VARIANCE);
    let mut poles = model.poles;
    poles.sort_by(|a, b| a.angular.total_cmp(&b.angular));
    Some(FreeModes { poles, variance, whitening, white_variance })
}

/// Order of the filter that makes the noise between strikes white.
const WHITENING: usize = 12;
/// Least variance of the noise: that of 24 bits.
const LEAST_VARIANCE: f64 = 1e-15;

/// Complex amplitudes of the modes at the first sample of each stretch; empty for an empty one.
pub(crate) fn amplitudes(
    samples: &[f64],
    stretches: &[Range<usize>],
    poles: &[Pole],
) -> Vec<Vec<nalgebra::Complex<f64>>> {
    let of_stretch = |stretch: &Range<usize>| {
        let groups = [Group::ringing(&samples[stretch.clone()])];
        let model = (!stretch.is_empty()).then(|| refine(&groups, poles, Ending { steps: 0, ..Ending::COARSE }));
        model.flatten().map_or(Vec::new(), |mut model| std::mem::take(&mut model.gains[0].modes))
    };
    stretches.par_iter().map(of_stretch).collect()
}

/// Energy in units of the noise that a mode has to explain in a number of stretches.
///
/// Its two amplitudes in each stretch explain a noise variance each; their scatter is allowed for
/// six times over. The Bayesian information criterion asks for the rest.
fn threshold(stretches: usize, length: usize) -> f64 {
    let free = 2.0 * stretches as f64;
    6.0 * (2.0 * free).sqrt() + 4.0 * (length as f64).ln()
}

fn residuals(groups: &[Group<'_>], model: &Model) -> Vec<Vec<f64>> {
    if model.poles.is_empty() {
        return groups.iter().map(|group| group.stretches[0].samples.to_vec()).collect();
    }
    let of_group = |index: usize| model.residual(index, &groups[index].stretches[0]);
    (0..groups.len()).into_par_iter().map(of_group).collect()
}

/// Modes that ring in what a model leaves between its strikes, each stretch with an amplitude of
/// its own; the most significant first.
pub(crate) fn left_over(residual: &[f64], onsets: &[usize], rate_hz: f64, settings: Settings) -> Vec<Pole> {
    let stretches = stretches(onsets, Guard::OF_CHANGE, residual.len(), rate_hz);
    let chosen = loudest(residual, &stretches, samples_in(LONGEST_S, rate_hz), MOST_LEFT_OVER);
    let Some(length) = chosen.iter().map(Range::len).max() else { return Vec::new() };
    let residuals: Vec<Vec<f64>> = chosen.iter().map(|stretch| residual[stretch.clone()].to_vec()).collect();
    let noise = NoiseFloor::of_residual(&residuals.concat());
    let range = search_range(length, rate_hz, settings);
    let threshold = threshold(residuals.len(), residual.len());
    search(&residuals, &noise, range, (threshold, LeftOut::AT_ONE_PLACE.searching), settings.most_modes)
}

/// Maximum number of stretches in which left over modes are searched for.
const MOST_LEFT_OVER: usize = 28;

/// Range of the search in stretches of up to `length` samples.
pub(crate) fn search_range(length: usize, rate_hz: f64, settings: Settings) -> SearchRange {
    SearchRange {
        slowest: 0.5 / length as f64,
        fastest: (settings.fastest_decay_per_s / rate_hz).min(0.3),
        angular: (2.0 * PI * settings.lowest_hz / rate_hz, PI * 0.98),
    }
}

/// Most significant poles that the residuals of all stretches have in common.
fn search(
    residuals: &[Vec<f64>],
    noise: &NoiseFloor,
    range: SearchRange,
    (threshold, left_out): (f64, usize),
    most: usize,
) -> Vec<Pole> {
    let decays: Vec<f64> = range.decays().collect();
    let expected = 2.0 * residuals.len() as f64;
    let found: Vec<Candidate> = decays
        .par_iter()
        .flat_map_iter(|&decay| {
            peaks(residuals, decay, left_out).into_iter().map(move |(angular, energy)| Candidate {
                pole: Pole { decay, angular },
                significance: energy / noise.variance(angular) - expected,
            })
        })
        .filter(|candidate| candidate.significance > threshold && range.holds(candidate.pole.angular))
        .collect();
    let length = residuals.iter().map(Vec::len).max().unwrap_or(1);
    standing_out(found, threshold, most, length).into_iter().map(|candidate| candidate.pole).collect()
}

/// Frequencies at which one more mode of a decay explains most energy of all stretches.
fn peaks(residuals: &[Vec<f64>], decay: f64, most_left_out: usize) -> Vec<(f64, f64)> {
    let lasting = (6.0 / decay).ceil() as usize + 2;
    let longest = residuals.iter().map(|residual| residual.len().min(lasting)).max().unwrap_or(1);
    let size = (2 * longest).next_power_of_two().max(64);
    let transform = fourier::forward(size);
    let (mut input, mut output) = (transform.make_input_vec(), transform.make_output_vec());
    let left_out = left_out(most_left_out, residuals.len());
    let mut power = vec![0.0; output.len()];
    let mut largest = vec![[0.0; MOST_LEFT_OUT]; output.len()];
    for residual in residuals {
        let length = residual.len().min(lasting);
        let (mut weight, ratio, mut energy) = (1.0, (-decay).exp(), 0.0);
        input.fill(0.0);
        for (slot, x) in input.iter_mut().zip(&residual[..length]) {
            *slot = x * weight;
            energy += weight * weight;
            weight *= ratio;
        }
        if energy == 0.0 || transform.process(&mut input, &mut output).is_err() {
            continue;
        }
        for ((sum, largest), bin) in power.iter_mut().zip(&mut largest).zip(&output) {
            let mut here = 2.0 * bin.norm_sqr() / energy;
            *sum += here;
            for slot in largest.iter_mut().take(left_out) {
                if here > *slot {
                    std::mem::swap(slot, &mut here);
                }
            }
        }
    }
    power.iter_mut().zip(&largest).for_each(|(sum, largest)| *sum -= largest.iter().sum::<f64>());
    parabola::peaks(&power).map(|(place, power)| (PI * place / (size / 2) as f64, power)).collect()
}

/// Worth of a mode but for the stretches that tell most of it.
fn worth(by_stretch: &[f64], most_left_out: usize) -> f64 {
    let mut sorted = by_stretch.to_vec();
    sorted.sort_by(f64::total_cmp);
    sorted.iter().take(by_stretch.len() - left_out(most_left_out, by_stretch.len())).sum()
}

/// The model without poles that have left the search's range or explain too little.
fn pruned(
    groups: &[Group<'_>],
    model: Model,
    noise: &NoiseFloor,
    range: SearchRange,
    (threshold, left_out): (f64, usize),
) -> Option<Model> {
    let mut model = model;
    let least = threshold + 2.0 * groups.len() as f64;
    loop {
        let (lowest, highest) = range.angular;
        let unworthy = |mode: &usize| {
            let pole = model.poles[*mode];
            let strayed = pole.angular < 0.9 * lowest || pole.angular > highest || pole.decay > 1.5 * range.fastest;
            strayed || worth(&model.worth_by_group[*mode], left_out) < least * noise.variance(pole.angular)
        };
        let order = |a: &usize, b: &usize| {
            worth(&model.worth_by_group[*a], left_out).total_cmp(&worth(&model.worth_by_group[*b], left_out))
        };
        let worst = (0..model.poles.len()).filter(unworthy).min_by(order);
        let Some(worst) = worst else { return Some(model) };
        model = refine(groups, &model.without(&[worst]), Ending::COARSE)?;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::multi_strike::synthetic::plain;

    #[test]
    fn poles_of_all_loud_modes_are_found_between_strikes() {
        let sound = plain(2, 5.0, 8, -60.0);
        let onsets: Vec<usize> = sound.strikes.iter().map(|strike| (strike.at_s * sound.rate_hz) as usize).collect();
        let found = free_modes(&sound.samples, &onsets, Guard::OF_CHANGE, sound.rate_hz, Settings::default(), &[])
            .map_or(Vec::new(), |free| free.poles);
        let cents = |mode: &crate::multi_strike::synthetic::TrueMode| {
            let distance = |pole: &Pole| (1200.0 * (pole.frequency_hz(sound.rate_hz) / mode.frequency_hz).log2()).abs();
            found.iter().map(distance).fold(f64::INFINITY, f64::min)
        };
        let near = sound.modes.iter().filter(|mode| cents(mode) < 1.0).count();
        assert!(
            near + 1 >= sound.modes.len() && found.len() <= near + 1,
            "{near} of {}, {}",
            sound.modes.len(),
            found.len()
        );
    }
}
