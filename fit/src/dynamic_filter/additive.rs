//! The additive way: a few modes beside the filter (dynamic-filter §III-B, §IV-B2).

use super::joint::{Joint, Sought};
use super::lattice::Lattice;
use super::path::{db_per_s, first_guess, path_of_filters, times_s};
use super::response::{BandHearing, heard_in_band};
use super::{Form, Model, RATE_HZ};
use crate::bark::{DampingBand, DampingLaw, width_hz};
use crate::modes::DampedSine;

/// Most modes of a model, as in the paper's soundboard.
pub const MOST_MODES: usize = 10;
/// Rounds of choosing modes for a path, and a path for modes.
const ROUNDS: usize = 3;
/// A decay off by so much is as bad as can be counted, in the logarithm.
const WORST: f64 = 0.45;
/// What 10 dB of prominence is worth, in the units of the squared error of a band.
const PROMINENCE: f64 = 2e-3;

/// Chooses at most [`MOST_MODES`] of `modes` and the path of the noise beside them, so that each band decays by the law.
///
/// `modes` as they sound at the strike, with what each stands out of the smooth part of the spectrum (`emergence_db`,
/// [`crate::bark::emergence_db`]). Those are taken that bring the decays of the bands nearest to the law, the more prominent of equals; then filter
/// and modes are fitted together.
pub fn additive(law: &DampingLaw, modes: &[DampedSine], emergence_db: &[f64], form: Form) -> Model {
    let joint = Joint::new(law);
    let (mut sought, _) = joint.descend(&first_guess(law, form));
    let mut best: Option<(f64, Sought)> = None;
    for _ in 0..ROUNDS {
        sought.modes = choose(law, modes, emergence_db, &sought.filters);
        let (found, sum) = joint.descend(&sought);
        sought.filters.clone_from(&found.filters);
        if best.as_ref().is_none_or(|best| sum < best.0) {
            best = Some((sum, found));
        }
    }
    let Some((_, best)) = best else { return Model::default() };
    Model { path: path_of_filters(law, &best.filters), modes: best.modes, loops: Vec::new() }
}

/// The modes that a path lacks most, one after the other.
fn choose(law: &DampingLaw, modes: &[DampedSine], emergence_db: &[f64], filters: &[Lattice]) -> Vec<DampedSine> {
    let times_s = times_s(law);
    let noise: Vec<Vec<f64>> = law
        .bands
        .iter()
        .map(|band| {
            let hearing = BandHearing::new(band.bark, RATE_HZ);
            filters.iter().map(|filter| hearing.power(filter.squared())).collect()
        })
        .collect();
    let mut chosen: Vec<DampedSine> = Vec::new();
    let mut left: Vec<(DampedSine, f64)> = modes.iter().copied().zip(emergence_db.iter().copied()).collect();
    let mut best = misfit(law, &times_s, &noise, &chosen);
    while chosen.len() < MOST_MODES {
        let tried = left.iter().enumerate().map(|(index, (mode, emergence_db))| {
            let mut more = chosen.clone();
            more.push(*mode);
            (misfit(law, &times_s, &noise, &more) - PROMINENCE * emergence_db.max(0.0) / 10.0, index)
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

/// Sum over bands of the squared error of the logarithm of α.
fn misfit(law: &DampingLaw, times_s: &[f64], noise: &[Vec<f64>], modes: &[DampedSine]) -> f64 {
    let counted: Vec<f64> = super::counted(law).map(|band| band.bark).collect();
    law.bands
        .iter()
        .zip(noise)
        .filter(|(band, _)| counted.contains(&band.bark))
        .map(|(band, noise)| {
            // Where modes make a band, the next path will leave them room.
            let held = |mode: &DampedSine| mode.amplitude.powi(2) * heard_in_band(mode.frequency_hz, band.bark);
            let share = modes.iter().map(held).sum::<f64>() / band.gain.powi(2);
            let kept = if share > 0.5 { 0.03 } else { 1.0 - share };
            let power = |(time_s, noise): (&f64, &f64)| {
                let ring = |mode: &DampedSine| {
                    mode.amplitude.powi(2)
                        * heard_in_band(mode.frequency_hz, band.bark)
                        * (-2.0 * mode.decay_per_s * time_s).exp()
                };
                kept * noise + modes.iter().map(ring).sum::<f64>()
            };
            let powers: Vec<f64> = times_s.iter().zip(noise).map(power).collect();
            let decay = decay_db_per_s(band, times_s, &powers);
            let error = (decay / db_per_s(band.decay_per_s)).max(1e-3).ln();
            error.abs().min(WORST).powi(2)
        })
        .sum()
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
