//! Contacts of a recording's blows: when and how long the force acts, and what rings through it.
//!
//! The force is a half-sine of unit impulse. For given middle and contact time the gains of all
//! modes, and of the force itself (acceleration sound), follow in closed form. Middle and contact
//! time are those that leave least: on a grid, then by halved steps.

use std::f64::consts::PI;

use nalgebra::{Cholesky, Complex, DMatrix, DVector};

use crate::modes::{Basis, Gains, Pole, Stretch};

/// The force of one blow.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Contact {
    /// Beginning of the contact in samples of the recording.
    pub(super) start: f64,
    /// Contact time in samples.
    pub(super) time: f64,
}

impl Contact {
    /// First sample of the force.
    pub(super) fn first_sample(self) -> usize {
        self.start.ceil().max(0.0) as usize
    }

    /// Samples of the half-sine, with a sum of 1.
    pub(super) fn force(self) -> Vec<f64> {
        let first = self.first_sample() as f64;
        let count = (self.start + self.time - first).max(0.0).floor() as usize + 1;
        let at = |n: usize| (PI * (first + n as f64 - self.start) / self.time).sin().max(0.0);
        let force: Vec<f64> = (0..count).map(at).collect();
        let sum: f64 = force.iter().sum();
        if sum > 0.0 { force.iter().map(|x| x / sum).collect() } else { vec![1.0; count.min(1)] }
    }
}

/// Variance of each gain that is expected before the sound is heard, the noise's variance being 1.
///
/// A large variance leaves a gain free. The last one is that of the force.
pub(super) type Expected = Vec<f64>;

/// Gains of modes and of the force, and the energy that they leave, in samples that begin with the
/// force. `None` if the equations cannot be solved.
pub(super) fn gains(
    samples: &[f64],
    force: &[f64],
    poles: &[Pole],
    expected: Option<&Expected>,
) -> Option<(Gains, f64)> {
    let force = &force[..force.len().min(samples.len())];
    let stretch = Stretch { samples, force: Some(force) };
    let bases: Vec<Basis> = poles.iter().map(|&pole| Basis::new(pole, &stretch)).collect();
    let size = 2 * poles.len() + 1;
    let (mut normal, mut right) = (DMatrix::<f64>::zeros(size, size), DVector::<f64>::zeros(size));
    let units = [Complex::new(1.0, 0.0), Complex::new(0.0, 1.0)];
    for (k, a) in bases.iter().enumerate() {
        let along = a.project(samples)[0];
        (right[2 * k], right[2 * k + 1]) = (along.re, -along.im);
        let along = a.along_force(force)[0];
        (normal[(size - 1, 2 * k)], normal[(size - 1, 2 * k + 1)]) = (along.re, -along.im);
        for (l, b) in bases.iter().enumerate().take(k + 1) {
            let products = a.products(b).uu;
            for (i, alpha) in units.into_iter().enumerate() {
                for (j, beta) in units.into_iter().enumerate() {
                    normal[(2 * k + i, 2 * l + j)] = products.real(alpha, beta);
                }
            }
        }
    }
    right[size - 1] = force.iter().zip(samples).map(|(f, x)| f * x).sum();
    normal[(size - 1, size - 1)] = force.iter().map(|f| f * f).sum();
    for row in 0..size {
        for column in row + 1..size {
            normal[(row, column)] = normal[(column, row)];
        }
        normal[(row, row)] *= 1.0 + HAIR;
        normal[(row, row)] += expected.map_or(0.0, |expected| 1.0 / expected[row / 2].max(f64::MIN_POSITIVE));
    }
    let solution = Cholesky::new(normal)?.solve(&right);
    let energy: f64 = samples.iter().map(|x| x * x).sum();
    let modes = (0..poles.len()).map(|k| Complex::new(solution[2 * k], solution[2 * k + 1])).collect();
    Some((Gains { modes, force: solution[size - 1] }, energy - solution.dot(&right)))
}

/// Share of each column's energy that keeps the equations definite.
const HAIR: f64 = 1e-6;
/// Contact times of the grid in seconds.
const TIMES_S: [f64; 8] = [2e-4, 3e-4, 4.5e-4, 6.7e-4, 1e-3, 1.5e-3, 2.2e-3, 3.3e-3];
/// Beginnings of the grid, from and to, about the place where a blow was found, in seconds.
const STARTS_S: [f64; 2] = [-1.2e-3, 5e-4];
/// Step of the grid's beginnings in seconds.
const STEP_S: f64 = 1e-4;
/// Length in seconds of the sound by which a contact is judged.
const JUDGED_S: f64 = 0.03;
/// Number of contact times of the grid from which a descent starts.
const STARTS: usize = 3;
/// Number of step lengths, each half of the one before.
const HALVINGS: usize = 5;

/// The contact that leaves least of the sound behind a blow, which ends before sample `end`.
pub(super) fn find(left: &[f64], blow: usize, end: usize, poles: &[Pole], rate_hz: f64) -> Contact {
    let window = blow.saturating_sub((3e-3 * rate_hz) as usize)..end.min(blow + (JUDGED_S * rate_hz) as usize);
    let leaves = |contact: Contact| {
        let first = contact.first_sample();
        if contact.start < window.start as f64 || first + 8 >= window.end || contact.time < 3.0 {
            return f64::INFINITY;
        }
        let before: f64 = left[window.start..first].iter().map(|x| x * x).sum();
        let behind = gains(&left[first..window.end], &contact.force(), poles, None);
        before + behind.map_or(f64::INFINITY, |(_, energy)| energy)
    };
    let steps = ((STARTS_S[1] - STARTS_S[0]) / STEP_S).round() as usize;
    // The best beginning of each contact time: these lie in valleys of their own.
    let mut starts: Vec<(f64, Contact)> = TIMES_S
        .iter()
        .filter_map(|time_s| {
            let tried = (0..=steps).map(|step| {
                let start = blow as f64 + (STARTS_S[0] + STEP_S * step as f64) * rate_hz;
                let contact = Contact { start, time: time_s * rate_hz };
                (leaves(contact), contact)
            });
            tried.min_by(|a, b| a.0.total_cmp(&b.0))
        })
        .collect();
    starts.sort_by(|a, b| a.0.total_cmp(&b.0));
    let descended = starts.into_iter().take(STARTS).map(|start| descended(start, rate_hz, leaves));
    let best = descended.min_by(|a, b| a.0.total_cmp(&b.0));
    best.map_or(Contact { start: blow as f64, time: TIMES_S[4] * rate_hz }, |(_, contact)| contact)
}

/// The contact to which halved steps lead, with what it leaves.
fn descended(from: (f64, Contact), rate_hz: f64, leaves: impl Fn(Contact) -> f64) -> (f64, Contact) {
    let (mut least, mut best) = from;
    let mut step = 0.5 * STEP_S * rate_hz;
    for _ in 0..HALVINGS {
        loop {
            // Beginning and end move together, alone, or against one another.
            let moves = [(1.0, 0.0), (0.0, 1.0), (1.0, -1.0), (0.5, -1.0)];
            let tried = moves.iter().flat_map(|&(start, time)| {
                [step, -step].map(|by| Contact { start: best.start + start * by, time: best.time + time * by })
            });
            let tried = tried.map(|contact| (leaves(contact), contact));
            let Some((left, contact)) = tried.min_by(|a, b| a.0.total_cmp(&b.0)) else { break };
            if left >= least * (1.0 - 1e-4) {
                break;
            }
            (best, least) = (contact, left);
        }
        step *= 0.5;
    }
    (least, best)
}
