//! Times at which filters are estimated.

use super::misfit::db_per_s;
use crate::bark::DampingLaw;

/// Number of times at which coefficients are estimated before they are thinned.
const TIMES: usize = 97;
/// Fall in dB to which the slowest band is followed.
const FOLLOWED_DB: f64 = 60.0;
/// Fall in dB of the fastest band in the first step.
const FIRST_STEP_DB: f64 = 1.0;

/// Times in seconds from the strike until the slowest band has died away, closer together at first.
pub(crate) fn times_s(law: &DampingLaw) -> Vec<f64> {
    let rates = || law.bands.iter().map(|band| db_per_s(band.decay_per_s));
    let end_s = FOLLOWED_DB / rates().fold(f64::INFINITY, f64::min);
    let first_s = (FIRST_STEP_DB / rates().fold(0.0, f64::max)).min(end_s / TIMES as f64);
    // Steps grow by a constant factor, found by bisection, so that the last one ends at end_s.
    let last = (TIMES - 1) as f64;
    let length = |growth: f64| first_s * (growth * last).exp_m1() / growth.exp_m1();
    let (mut low, mut high) = (1e-9, 1.0);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if length(middle) < end_s { low = middle } else { high = middle }
    }
    (0..TIMES).map(|index| first_s * (low * index as f64).exp_m1() / low.exp_m1()).collect()
}
