//! Choice of the modes that stand for a chain.
//!
//! They are the modes of its poles. Poles that (nearly) coincide or decay too fast for the modal
//! bank get a fan of modes instead.

use std::f64::consts::{PI, TAU};

use dsp_core::SampleRate;
use fourier::Complex;

use super::fit::{Chain, Fit, fastest_decay_per_s, fit, on_grid};

/// Reciprocal of the SNR, 110 dB, that a mode of the bank is assumed to have.
pub(crate) const RHO: f64 = 3.162_277_660_168_379e-6;
/// Expected SNR in dB at which no more modes are tried.
const ENOUGH_DB: f64 = 92.0;
/// Number of modes that a fan has beyond one for each of its poles stays below this.
const MOST: usize = 12;
/// Smallest distance of a mode's angle from 0 and from half a turn, in widths of the mode.
const LEAST_TURN: f64 = 0.3;

/// Poles of a chain that are so close to one another that their partial fractions would cancel.
struct Cluster {
    poles: Vec<Complex<f64>>,
}

impl Cluster {
    fn mean(&self) -> Complex<f64> {
        self.poles.iter().sum::<Complex<f64>>() / self.poles.len() as f64
    }

    /// Fan of modes round the mean pole.
    ///
    /// Frequencies spread by `spread` widths either way. Decays are multiplied by `decay`, and at
    /// the edges by a further `1 + bend`.
    fn fan(&self, count: usize, [spread, decay, bend]: [f64; 3], fs: f64) -> Vec<Complex<f64>> {
        let mean = self.mean();
        let fastest = fastest_decay_per_s() / fs;
        let width = (-mean.re).min(fastest);
        let at = |index: usize| {
            let u = if count == 1 { 0.0 } else { 2.0 * index as f64 / (count - 1) as f64 - 1.0 };
            let re = (-width * decay * (1.0 + bend * u * u)).max(-fastest);
            // The bank is not exact for a mode that turns much less than it decays.
            let im = (mean.im + u * spread * width).abs().clamp(-LEAST_TURN * re, PI + LEAST_TURN * re);
            on_grid(Complex::new(re, im), fs)
        };
        (0..count).map(at).collect()
    }
}

/// True if the bank is exact for a mode with this pole.
fn is_turning(pole: Complex<f64>) -> bool {
    pole.im.min(PI - pole.im) >= -LEAST_TURN * pole.re
}

/// Groups poles that are closer to one another than `widths` widths of the narrower one.
fn clusters(chain: &Chain, widths: f64) -> Vec<Cluster> {
    let mut clusters: Vec<Cluster> = Vec::new();
    for &pole in chain.poles.iter().flatten() {
        let is_near = |other: &Complex<f64>| (pole - other).norm() < widths * (-pole.re).min(-other.re);
        let mut own = Cluster { poles: vec![pole] };
        clusters.retain_mut(|cluster| {
            let near = cluster.poles.iter().any(is_near);
            if near {
                own.poles.append(&mut cluster.poles);
            }
            !near
        });
        clusters.push(own);
    }
    clusters
}

/// Finds the fewest modes that are expected to reach 92 dB at 48 kHz. If none do, finds the best of
/// all that were tried.
pub(crate) fn modes_of(chain: &Chain) -> Fit {
    let fs = SampleRate::HZ_48000.hz();
    let grid = chain.grid();
    let plain: Vec<_> = chain.poles.iter().flatten().map(|&pole| on_grid(pole, fs)).collect();
    let mut best = Fit { missed: 1.0, ..Fit::default() };
    if plain.iter().all(|&pole| is_turning(pole)) {
        best = fit(chain, &grid, &plain, RHO);
    }
    for widths in [3.0, 30.0] {
        let clusters = clusters(chain, widths);
        let is_plain = |cluster: &Cluster| {
            cluster.poles.len() == 1
                && cluster
                    .poles
                    .iter()
                    .all(|&pole| (pole - on_grid(pole, fs)).norm() < 1e-3 * -pole.re && is_turning(pole))
        };
        for more in 0..MOST {
            if best.expected_db() >= ENOUGH_DB {
                return best;
            }
            let poles = |shape: [f64; 3]| -> Vec<Complex<f64>> {
                let fan = |cluster: &Cluster| match is_plain(cluster) {
                    true => cluster.poles.iter().map(|&pole| on_grid(pole, fs)).collect(),
                    false => cluster.fan(cluster.poles.len() + more, shape, fs),
                };
                clusters.iter().flat_map(fan).collect()
            };
            let try_one = |shape: [f64; 3]| fit(chain, &grid, &poles(shape), RHO);
            let found = search(try_one);
            if found.expected_db() > best.expected_db() {
                best = found;
            }
        }
    }
    best
}

/// Finds the best shape of the fans, on a coarse grid first, then in steps that halve.
fn search(try_one: impl Fn([f64; 3]) -> Fit) -> Fit {
    let mut shape = [0.3, 1.0, 0.0];
    let mut best = try_one(shape);
    for spread in [0.03, 0.1, 0.6, 1.2, 2.4, 5.0] {
        let found = try_one([spread, 1.0, 0.0]);
        if found.expected_db() > best.expected_db() {
            (best, shape) = (found, [spread, 1.0, 0.0]);
        }
    }
    let mut step = 0.4;
    while step > 0.03 {
        let before = best.expected_db();
        for axis in 0..3 {
            for sign in [-1.0, 1.0] {
                let mut next = shape;
                if axis == 2 {
                    next[2] += sign * step
                } else {
                    next[axis] *= (sign * step).exp()
                }
                if next[2] < -0.8 {
                    continue;
                }
                let found = try_one(next);
                if found.expected_db() > best.expected_db() {
                    (best, shape) = (found, next);
                }
            }
        }
        if best.expected_db() < before + 0.3 {
            step /= 2.0;
        }
    }
    best
}

/// Frequency in Hz, decay in 1/s, gs and gc of a fitted mode, for a force of 1 over 1 s.
pub(crate) fn parameters(pole: Complex<f64>, c: Complex<f64>, fs: f64) -> [f64; 4] {
    [pole.im * fs / TAU, -pole.re * fs, -2.0 * c.im * fs, 2.0 * c.re * fs]
}
