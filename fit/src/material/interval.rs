//! Estimates with a range.

use serde::Serialize;

/// An estimate with its range.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Interval {
    /// Most likely value.
    pub estimate: f64,
    /// Value below which it lies with a probability of 5 %.
    pub low: f64,
    /// Value above which it lies with a probability of 5 %.
    pub high: f64,
}
