//! Strikes as changes of the amplitudes of known modes: a likelihood ratio for each moment.
//!
//! In a window before and one behind a moment, the modes ring with amplitudes that fit both, or
//! with amplitudes of their own in each. Without a strike the difference of explained energy is
//! chi-squared, with two degrees of freedom for each mode.

use nalgebra::{Cholesky, Complex, DMatrix, DVector, Dyn};
use rayon::prelude::*;

use crate::modes::{Basis, Pole, Stretch, project};

type C64 = Complex<f64>;

/// Length of a window in seconds.
const WINDOW_S: f64 = 0.024;
/// Number of hops in a window.
const HOPS: usize = 16;
/// Standard deviations of the chi-squared over its mean that a strike exceeds.
const OVER_MEAN: f64 = 9.0;
/// Least ratio to the strongest change within two windows.
const UNDER_NEIGHBOUR: f64 = 1e-3;

/// Samples near which amplitudes change, with the energy of each change in units of `variance`.
pub(crate) fn changes(samples: &[f64], poles: &[Pole], rate_hz: f64, variance: f64) -> Vec<(usize, f64)> {
    let hop = ((WINDOW_S * rate_hz) as usize / HOPS).max(1);
    // Factors of the inner products over every number of hops, from one on.
    let factors: Vec<Option<Cholesky<f64, Dyn>>> =
        (1..=3 * HOPS).into_par_iter().map(|count| normal(poles, count * hop)).collect();
    let (Some(one), Some(two)) = (&factors[HOPS - 1], &factors[2 * HOPS - 1]) else { return Vec::new() };
    let hops: Vec<Vec<C64>> =
        samples.par_chunks(hop).map(|chunk| poles.iter().map(|&pole| project(pole, chunk)[0]).collect()).collect();
    let of_hops: Vec<Vec<C64>> =
        poles.iter().map(|pole| (0..3 * HOPS).map(|index| pole.power((index * hop) as f64)).collect()).collect();
    // Sums from a hop on, over a number of hops.
    let sums = |from: usize, count: usize| {
        let of_mode = |mode: usize| -> C64 {
            hops[from..from + count].iter().zip(&of_hops[mode]).map(|(sums, power)| sums[mode] * power).sum()
        };
        (0..poles.len()).map(of_mode).collect::<Vec<C64>>()
    };
    let explained = |factor: &Cholesky<f64, Dyn>, sums: &[C64]| {
        let mut right = DVector::from_iterator(2 * sums.len(), sums.iter().flat_map(|sum| [sum.re, -sum.im]));
        factor.l_dirty().solve_lower_triangular_mut(&mut right);
        right.norm_squared()
    };
    let count = hops.len().saturating_sub(2 * HOPS);
    // Moment within a window of a hop at which a change explains most, from two windows before it
    // to two behind.
    let placed = |middle: usize| {
        let (start, end) = (middle.saturating_sub(2 * HOPS), (middle + 2 * HOPS).min(hops.len()));
        let split = |at: &usize| {
            let part = |from: usize, to: usize| {
                factors[to - from - 1].as_ref().map_or(0.0, |factor| explained(factor, &sums(from, to - from)))
            };
            part(start, *at) + part(*at, end)
        };
        let (first, last) = ((middle - HOPS).max(start + 1), (middle + HOPS).min(end - 1));
        let splits: Vec<(usize, f64)> = (first..=last).map(|at| (at, split(&at))).collect();
        splits.into_iter().max_by(|a, b| a.1.total_cmp(&b.1)).map_or(middle, |(at, _)| at)
    };
    let ratio: Vec<f64> = (0..count)
        .into_par_iter()
        .map(|from| {
            let (before, behind, both) = (sums(from, HOPS), sums(from + HOPS, HOPS), sums(from, 2 * HOPS));
            (explained(one, &before) + explained(one, &behind) - explained(two, &both)) / variance
        })
        .collect();
    let free = 2.0 * poles.len() as f64;
    let threshold = free + OVER_MEAN * (2.0 * free).sqrt() + 2.0 * (samples.len() as f64).ln();
    let mut found = Vec::new();
    for (from, &here) in ratio.iter().enumerate() {
        let near = |reach: usize| from.saturating_sub(reach)..(from + reach + 1).min(count);
        let close = near(HOPS);
        if here > threshold
            && ratio[close.start..from].iter().all(|other| *other < here)
            && ratio[from..close.end].iter().all(|other| *other <= here)
            && ratio[near(2 * HOPS)].iter().all(|other| other * UNDER_NEIGHBOUR < here)
        {
            found.push((placed(from + HOPS) * hop, here));
        }
    }
    found.sort_by_key(|(at, _)| *at);
    found.dedup_by_key(|(at, _)| *at);
    found
}

/// Factor of the inner products of all modes in a window.
fn normal(poles: &[Pole], length: usize) -> Option<Cholesky<f64, Dyn>> {
    let silence = vec![0.0; length];
    let stretch = Stretch::ringing(&silence);
    let bases: Vec<Basis> = poles.iter().map(|&pole| Basis::new(pole, &stretch)).collect();
    let units = [C64::new(1.0, 0.0), C64::new(0.0, 1.0)];
    let mut normal = DMatrix::zeros(2 * poles.len(), 2 * poles.len());
    for (k, a) in bases.iter().enumerate() {
        for (l, b) in bases.iter().enumerate() {
            let products = a.products(b).uu;
            for (i, alpha) in units.into_iter().enumerate() {
                for (j, beta) in units.into_iter().enumerate() {
                    normal[(2 * k + i, 2 * l + j)] = products.real(alpha, beta);
                }
            }
        }
    }
    // Modes too close to be told apart in a window share what they explain.
    (0..normal.nrows()).for_each(|index| normal[(index, index)] *= 1.0 + 1e-6);
    Cholesky::new(normal)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::multi_strike::synthetic::plain;
    use crate::multi_strike::truth::model_of;

    #[test]
    fn all_strikes_change_amplitudes_of_known_modes_and_nothing_else_does() {
        for seed in 1..4 {
            let sound = plain(seed, 6.0, 10, -60.0);
            let found = changes(&sound.samples, &model_of(&sound).poles, sound.rate_hz, sound.noise_rms.powi(2));
            let near = |at_s: f64| found.iter().any(|(at, _)| (*at as f64 / sound.rate_hz - at_s).abs() < 0.004);
            let all = sound.strikes.iter().filter(|strike| near(strike.at_s)).count();
            assert!(all >= 9 && found.len() <= 10, "{all} of 10, {found:?}");
        }
    }
}
