//! All-pass branches that make steep filters: the split at a band's edge, and the doubling of the rate.

use std::f64::consts::PI;

/// The coefficients a of the sections `(a + z^-2)/(1 + a z^-2)` of an elliptic half-band filter, rising, whose transition is `transition` of half the rate wide
/// (Valenzuela and Constantinides, 1983: elliptic functions by the nome's series).
pub(super) fn half_band(count: usize, transition: f64) -> Vec<f64> {
    let k = ((1.0 - 2.0 * transition) * PI / 4.0).tan().powi(2);
    let root = (1.0 - k * k).powf(0.25);
    let e = 0.5 * (1.0 - root) / (1.0 + root);
    let q = e + 2.0 * e.powi(5) + 15.0 * e.powi(9) + 150.0 * e.powi(13);
    let section = |index: usize| {
        let angle = (index + 1) as f64 * PI / (2 * count + 1) as f64;
        let sign = |i: i32| if i % 2 == 0 { 1.0 } else { -1.0 };
        let odd = (0..8).map(|i| sign(i) * q.powi(i * (i + 1)) * (f64::from(2 * i + 1) * angle).sin());
        let even = (1..8).map(|i| sign(i) * q.powi(i * i) * (f64::from(2 * i) * angle).cos());
        let w = q.powf(0.25) * odd.sum::<f64>() / (0.5 + even.sum::<f64>());
        let x = ((1.0 - w * w * k) * (1.0 - w * w / k)).sqrt() / (1.0 + w * w);
        (1.0 - x) / (1.0 + x)
    };
    (0..count).map(section).collect()
}

/// Filters a signal by `numerator(z)/denominator(z)`, powers of z^-1, the denominator's first being 1.
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

/// Splits a signal at `edge` (of its rate): what lies below, and what lies above.
pub(super) fn split(signal: &[f64], edge: f64) -> (Vec<f64>, Vec<f64>) {
    let (cut, middle) = (PI * edge, PI / 4.0);
    let alpha = (middle - cut).sin() / (middle + cut).sin();
    let mut branches = [signal.to_vec(), filter(&[-alpha, 1.0], &[1.0, -alpha], signal)];
    for (index, a) in half_band(2, 0.1).into_iter().enumerate() {
        // The half-band section with z^-1 replaced by (z^-1 - α)/(1 - α z^-1).
        let scale = 1.0 + a * alpha * alpha;
        let (c1, c2) = (-2.0 * alpha * (1.0 + a) / scale, (a + alpha * alpha) / scale);
        branches[index % 2] = filter(&[c2, c1, 1.0], &[1.0, c1, c2], &branches[index % 2]);
    }
    let [a, b] = branches;
    let both = || a.iter().zip(&b);
    (both().map(|(a, b)| (a + b) / 2.0).collect(), both().map(|(a, b)| (a - b) / 2.0).collect())
}

/// A signal at twice its rate.
pub(super) fn double(signal: &[f64]) -> Vec<f64> {
    let branches: Vec<Vec<f64>> = half_band(2, 0.1).into_iter().map(|a| filter(&[a, 1.0], &[1.0, a], signal)).collect();
    branches[0].iter().zip(&branches[1]).flat_map(|(&even, &odd)| [even, odd]).collect()
}
