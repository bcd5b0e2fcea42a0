//! Times of contacts, and phases of modes, whatever positions, contact times and signs are.
//!
//! Modes of a thing have real shapes, so that the squares of a strike's amplitudes have the phases
//! `2θ_k - 2ω_k δ`, δ from a moment near the strike to the middle of its contact.

use nalgebra::Complex;
use rayon::prelude::*;

use super::amplitudes::Change;
use super::contact_grid::REACH_S;
use super::start::strongest_but;

type C64 = Complex<f64>;

/// Step of δ in samples.
const STEP: f64 = 0.25;
/// Number of rounds of times and phases in turn.
const TIMING_ROUNDS: usize = 6;

/// Amplitudes of a strike, turned to the middle of its contact and to the modes' phases.
pub(super) struct Turned {
    pub(super) values: Vec<f64>,
    pub(super) variances: Vec<f64>,
}

/// Time of each contact's middle behind its moment, and the phase of each mode.
///
/// The phases begin as those of the strike of most energy but `attempt`.
pub(super) fn timed(
    changes: &[Change],
    exponents: &[C64],
    rate_hz: f64,
    attempt: usize,
) -> Option<(Vec<f64>, Vec<f64>)> {
    let doubled: Vec<Vec<C64>> = changes.iter().map(doubled).collect();
    let sizes: Vec<f64> = doubled.iter().map(|strike| strike.iter().map(|x| x.norm()).sum()).collect();
    let mut phases: Vec<C64> = doubled[strongest_but(&sizes, attempt)?].clone();
    let mut shifts = vec![0.0; changes.len()];
    let steps = ((REACH_S[0] + REACH_S[1]) * rate_hz / STEP) as usize;
    for _ in 0..TIMING_ROUNDS {
        shifts = doubled
            .par_iter()
            .map(|strike| {
                let mut along: Vec<C64> = (strike.iter().zip(&phases).zip(exponents))
                    .map(|((x, phase), s)| x * phase.conj() * C64::new(0.0, -2.0 * s.im * REACH_S[0] * rate_hz).exp())
                    .collect();
                let turns: Vec<C64> = exponents.iter().map(|s| C64::new(0.0, 2.0 * s.im * STEP).exp()).collect();
                let mut best = (f64::NEG_INFINITY, 0.0);
                for step in 0..steps {
                    let sum: f64 = along.iter().map(|x| x.re).sum();
                    if sum > best.0 {
                        best = (sum, step as f64 * STEP - REACH_S[0] * rate_hz);
                    }
                    along.iter_mut().zip(&turns).for_each(|(x, turn)| *x *= turn);
                }
                best.1
            })
            .collect();
        for (mode, phase) in phases.iter_mut().enumerate() {
            let turn = |shift: f64| C64::new(0.0, 2.0 * exponents[mode].im * shift).exp();
            let sum: C64 = doubled.iter().zip(&shifts).map(|(strike, shift)| strike[mode] * turn(*shift)).sum();
            let weight: f64 = doubled.iter().map(|strike| strike[mode].norm()).sum();
            // A mode whose phases do not agree tells no times.
            *phase = sum / weight.max(1e-300);
        }
    }
    Some((shifts, phases.into_iter().map(|phase| 0.5 * phase.arg()).collect()))
}

/// Squares of the amplitudes' phases, each with the share of the amplitude that is no noise.
fn doubled(change: &Change) -> Vec<C64> {
    let of_mode = |(amplitude, variance): (&C64, &f64)| {
        let energy = amplitude.norm_sqr();
        amplitude * amplitude / energy.max(1e-300) * (energy / (energy + 4.0 * variance))
    };
    change.amplitudes.iter().zip(&change.variances).map(of_mode).collect()
}

/// Amplitudes of a strike, turned by the time of its contact and by the phases of the modes.
pub(super) fn turned(change: &Change, shift: f64, exponents: &[C64], phases: &[f64]) -> Turned {
    let turn = |mode: usize| (exponents[mode] * shift - C64::new(0.0, phases[mode])).exp();
    let values = change.amplitudes.iter().enumerate().map(|(mode, a)| (a * turn(mode)).re).collect();
    let variances = change.variances.iter().enumerate().map(|(mode, v)| 0.5 * v * turn(mode).norm_sqr()).collect();
    Turned { values, variances }
}
