//! Steep filters from all-pass branches: the band split, and the doubling of the rate.

use std::f64::consts::PI;

/// Elliptic low-pass of odd order whose pass band ends at √k rad/s and stop band begins at 1/√k.
///
/// It has a real pole at -σ and pole pairs `s² + b1 s + b0`, stored as [b1, b0] from the real pole
/// outwards (Antoniou: series in the nome q).
#[derive(Clone, Debug)]
pub(super) struct Elliptic {
    sigma: f64,
    pairs: Vec<[f64; 2]>,
}

impl Elliptic {
    /// Low-pass with `pairs` pole pairs whose complementary high-pass attenuates by `high_db`.
    pub(super) fn with_high_pass(pairs: usize, k: f64, high_db: f64) -> Self {
        let q = nome(k);
        let lambda = 10f64.powf(high_db / 20.0).acosh() / (2 * pairs + 1) as f64;
        let odd: f64 = (0..8).map(|i| sign(i) * q.powi(i * (i + 1)) * (f64::from(2 * i + 1) * lambda).sinh()).sum();
        let even: f64 = (1..8).map(|i| sign(i) * q.powi(i * i) * (f64::from(2 * i) * lambda).cosh()).sum();
        Self::new(pairs, k, (q.powf(0.25) * odd / (0.5 + even)).abs())
    }

    fn new(pairs: usize, k: f64, sigma: f64) -> Self {
        let q = nome(k);
        let pair = |index: usize| {
            let angle = (index + 1) as f64 * PI / (2 * pairs + 1) as f64;
            let odd: f64 = (0..8).map(|i| sign(i) * q.powi(i * (i + 1)) * (f64::from(2 * i + 1) * angle).sin()).sum();
            let even: f64 = (1..8).map(|i| sign(i) * q.powi(i * i) * (f64::from(2 * i) * angle).cos()).sum();
            let w = q.powf(0.25) * odd / (0.5 + even);
            let v = ((1.0 - w * w * k) * (1.0 - w * w / k)).sqrt();
            let outer = (1.0 + k * sigma * sigma) * (1.0 + sigma * sigma / k);
            let scale = 1.0 + sigma * sigma * w * w;
            [2.0 * sigma * v / scale, ((sigma * v).powi(2) + w * w * outer) / (scale * scale)]
        };
        Self { sigma, pairs: (0..pairs).map(pair).collect() }
    }

    /// Power response of the low-pass at `w` rad/s, from the phase difference of its branches.
    pub(super) fn low_power(&self, w: f64) -> f64 {
        let mut phases = [0.0, 2.0 * (w / self.sigma).atan()];
        for (index, [b1, b0]) in self.pairs.iter().enumerate() {
            phases[index % 2] += 2.0 * (b1 * w).atan2(b0 - w * w);
        }
        ((phases[0] - phases[1]) / 2.0).cos().powi(2)
    }
}

/// Sum of the stop-band attenuations of low-pass and complementary high-pass, in dB.
pub(super) fn shared_db(pairs: usize, k: f64) -> f64 {
    -20.0 * (4.0 * nome(k).powf(pairs as f64 + 0.5)).log10()
}

fn nome(k: f64) -> f64 {
    let root = (1.0 - k * k).powf(0.25);
    let e = 0.5 * (1.0 - root) / (1.0 + root);
    e + 2.0 * e.powi(5) + 15.0 * e.powi(9) + 150.0 * e.powi(13)
}

fn sign(i: i32) -> f64 {
    if i % 2 == 0 { 1.0 } else { -1.0 }
}

/// Filters a signal by `numerator(z)/denominator(z)`, in powers of z^-1; `denominator[0]` is 1.
fn filter(numerator: &[f64], denominator: &[f64], signal: &[f64]) -> Vec<f64> {
    let mut out = Vec::with_capacity(signal.len());
    for n in 0..signal.len() {
        let past = |values: &[f64], power: usize| if power <= n { values[n - power] } else { 0.0 };
        let fed: f64 = numerator.iter().enumerate().map(|(power, b)| b * past(signal, power)).sum();
        let back: f64 = denominator.iter().enumerate().skip(1).map(|(power, a)| a * past(&out, power)).sum();
        out.push(fed - back);
    }
    out
}

/// Splits a signal into the parts below and above an edge.
///
/// `tangent` is `tan(π f)` of the frequency that 1 rad/s of the low-pass maps to (bilinear
/// transform).
pub(super) fn split(signal: &[f64], low_pass: &Elliptic, tangent: f64) -> (Vec<f64>, Vec<f64>) {
    let real = low_pass.sigma * tangent;
    let alpha = (1.0 - real) / (1.0 + real);
    let mut branches = [signal.to_vec(), filter(&[-alpha, 1.0], &[1.0, -alpha], signal)];
    for (index, [b1, b0]) in low_pass.pairs.iter().enumerate() {
        let (b1, b0) = (b1 * tangent, b0 * tangent * tangent);
        let (c1, c2) = (2.0 * (b0 - 1.0) / (1.0 + b1 + b0), (1.0 - b1 + b0) / (1.0 + b1 + b0));
        branches[index % 2] = filter(&[c2, c1, 1.0], &[1.0, c1, c2], &branches[index % 2]);
    }
    let [a, b] = branches;
    let both = || a.iter().zip(&b);
    (both().map(|(a, b)| (a + b) / 2.0).collect(), both().map(|(a, b)| (a - b) / 2.0).collect())
}

/// Signal at twice its rate, by a half-band low-pass of fifth order.
///
/// The pass band of the low-pass ends at `to` of the lower rate.
pub(super) fn double(signal: &[f64], to: f64) -> Vec<f64> {
    let half_band = Elliptic::new(2, (PI / 2.0 * to.max(0.25)).tan().powi(2), 1.0);
    let branch = |[b1, _]: [f64; 2]| {
        let a = (2.0 - b1) / (2.0 + b1);
        filter(&[a, 1.0], &[1.0, a], signal)
    };
    let branches: Vec<Vec<f64>> = half_band.pairs.into_iter().map(branch).collect();
    branches[0].iter().zip(&branches[1]).flat_map(|(&even, &odd)| [even, odd]).collect()
}
