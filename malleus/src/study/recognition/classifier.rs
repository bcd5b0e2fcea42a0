//! Classifier that holds each value of each motion for normal and independent of the others.

use super::features::FEATURES;
use super::{GROUPS, MOTIONS};

/// Least standard deviation of a value, so that no value alone decides.
const LEAST_DEVIATION: f64 = 0.05;

/// Means and variances of each motion's values.
#[derive(Clone, Debug, PartialEq)]
pub struct Classifier {
    motions: [Vec<[f64; 2]>; MOTIONS],
}

impl Classifier {
    /// Learns from motions and what was heard of them.
    pub fn learn(heard: &[(usize, [f64; FEATURES])]) -> Self {
        let of = |motion: usize| {
            let own: Vec<&[f64; FEATURES]> =
                heard.iter().filter(|(other, _)| *other == motion).map(|(_, values)| values).collect();
            let count = own.len().max(2) as f64;
            (0..FEATURES)
                .map(|at| {
                    let mean = own.iter().map(|values| values[at]).sum::<f64>() / count;
                    let square = own.iter().map(|values| (values[at] - mean).powi(2)).sum::<f64>() / (count - 1.0);
                    [mean, square.max(LEAST_DEVIATION * LEAST_DEVIATION)]
                })
                .collect()
        };
        Self { motions: std::array::from_fn(of) }
    }

    /// Motion that most likely was heard.
    pub fn hear(&self, heard: &[f64; FEATURES]) -> usize {
        let likelihood = |motion: usize| {
            let values = self.motions[motion].iter().zip(heard);
            values.map(|([mean, variance], x)| -(x - mean).powi(2) / variance - variance.ln()).sum::<f64>()
        };
        (0..GROUPS.len()).max_by(|&a, &b| likelihood(a).total_cmp(&likelihood(b))).unwrap_or(0)
    }
}
