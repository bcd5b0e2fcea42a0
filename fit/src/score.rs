//! Errors of estimated modes against true ones.

use crate::modes::DampedSine;

/// A true mode beside its estimate.
#[derive(Clone, Copy, Debug)]
pub struct Match {
    /// The true mode.
    pub truth: DampedSine,
    /// The estimated mode.
    pub estimate: DampedSine,
}

impl Match {
    /// Error of the frequency in cents, without sign.
    pub fn cents(&self) -> f64 {
        1200.0 * (self.estimate.frequency_hz / self.truth.frequency_hz).log2().abs()
    }

    /// Relative error of T60 in percent, without sign.
    pub fn t60_percent(&self) -> f64 {
        100.0 * (self.estimate.t60_s() / self.truth.t60_s() - 1.0).abs()
    }

    /// Error of the amplitude at the first sample in dB, without sign.
    pub fn amplitude_db(&self) -> f64 {
        20.0 * (self.estimate.amplitude / self.truth.amplitude).log10().abs()
    }
}

/// Pairs true modes with estimates, nearest first.
///
/// Each is used at most once, and no pair is further apart than `within_cents`.
pub fn matches(truth: &[DampedSine], estimates: &[DampedSine], within_cents: f64) -> Vec<Match> {
    let mut pairs: Vec<(f64, usize, usize)> = Vec::new();
    for (t, &truth) in truth.iter().enumerate() {
        for (e, &estimate) in estimates.iter().enumerate() {
            pairs.push((Match { truth, estimate }.cents(), t, e));
        }
    }
    pairs.retain(|pair| pair.0 <= within_cents);
    pairs.sort_by(|a, b| a.0.total_cmp(&b.0));
    let (mut used_truth, mut used_estimate) = (vec![false; truth.len()], vec![false; estimates.len()]);
    let mut found = Vec::new();
    for (_, t, e) in pairs {
        if !used_truth[t] && !used_estimate[e] {
            (used_truth[t], used_estimate[e]) = (true, true);
            found.push(Match { truth: truth[t], estimate: estimates[e] });
        }
    }
    found
}

/// Quantile of values: the value below which a `share` of them lies; NaN without values.
pub fn quantile(values: &[f64], share: f64) -> f64 {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    let at = share.clamp(0.0, 1.0) * sorted.len().saturating_sub(1) as f64;
    let (low, high) = (at.floor() as usize, at.ceil() as usize);
    match (sorted.get(low), sorted.get(high)) {
        (Some(low_value), Some(high_value)) => low_value + (high_value - low_value) * (at - low as f64),
        _ => f64::NAN,
    }
}
