//! Splitting the input at a band edge: an elliptic low-pass and high-pass of fifth to ninth order
//! from one pair of all-pass branches.
//!
//! ```text
//!            ┌─ A0 = S(c0) (· S(c2)) ──────┬─(+)─► low  = (A0 + A1)/2
//!   x/2 ──┬──┤                             │ │
//!            └─ A1 = F · S(c1) (· S(c3)) ──┴─(-)─► high = (A0 - A1)/2
//! ```
//!
//! `|low|² + |high|² = 1` whatever the coefficients' rounding: no energy is lost or counted twice
//! at an edge. The attenuations of both sides are chosen edge by edge, see [`lean`](super::lean).

use super::elliptic::Elliptic;
use super::kernel;
use super::split::{Split, SplitState};

/// Bits of the largest size at which a chain of splits may come to rest, -132 dBFS: a block no
/// larger is silence.
const RESTING_BITS: i32 = 5;

impl Split {
    /// Splits by a low-pass whose 1 rad/s lies where `tangent = tan(π f)`, f of the sample rate
    /// (bilinear transform).
    pub(super) fn new(filter: &Elliptic, tangent: f64) -> Self {
        let q31 = |value: f64| libm::rint(value * 2_147_483_648.0) as i32;
        let real = filter.sigma * tangent;
        let second = filter.pairs.map(|[b1, b0]| {
            let (b1, b0) = (b1 * tangent, b0 * tangent * tangent);
            let scale = 1.0 / (1.0 + b1 + b0);
            [q31((b0 - 1.0) * scale), q31(0.5 * (1.0 - b1 + b0) * scale)]
        });
        Self { first: q31((1.0 - real) / (1.0 + real)), sections: filter.count as u32, second }
    }

    /// Splits `low`, which holds half the signal (at most ±1.0 in Q4.27), in place into half the
    /// low part, at most ±1.0, of which only every second sample is kept if it is to be `thin`.
    /// `high` is as long, and whole. Gives the bits of the largest size in `high`.
    ///
    /// Nothing wraps: no branch's impulse response sums up to more than 7.5 (measured over edges,
    /// orders and leanings, see this file's tests). So every value stays below 2^29.91, every
    /// difference of two below 2^30.91.
    pub(super) fn render(&self, state: &mut SplitState, low: &mut [i32], high: &mut [i32], thin: bool) -> i32 {
        let sizes = kernel::split(self, state, low, high, thin);
        bits(sizes, high)
    }
}

/// Bits of the largest size in a band's input, from the or of all sizes. If the splits are at rest,
/// the input becomes silence.
pub(super) fn bits(sizes: u32, band: &mut [i32]) -> i32 {
    let bits = 32 - sizes.leading_zeros() as i32;
    if (1..=RESTING_BITS).contains(&bits) {
        band.fill(0);
        return 0;
    }
    bits
}

#[cfg(test)]
mod tests {
    use super::super::kernel::portable::{first_order, section};
    use super::super::lean::{LEAST_DB, SELECTIVITIES};
    use super::super::split::LEAST_SECTIONS;
    use super::*;
    use crate::room::elliptic::shared_db;
    use std::vec;
    use std::vec::Vec;

    /// Sum of the sizes of a response to 2^24.
    fn gain(response: &[i32]) -> f64 {
        response.iter().map(|x| f64::from(x.abs())).sum::<f64>() / f64::from(1 << 24)
    }

    #[test]
    fn no_branch_raises_a_signal_by_more_than_its_headroom() {
        let mut most = 0.0f64;
        for (index, k) in SELECTIVITIES.into_iter().enumerate() {
            let count = LEAST_SECTIONS + index;
            let all_db = shared_db(count, k);
            for high_db in [LEAST_DB, 0.25 * all_db, 0.5 * all_db, 0.75 * all_db, all_db - LEAST_DB] {
                let filter = Elliptic::leaning(count, k, high_db);
                for step in 0..=12 {
                    let edge = 0.001 * 490f64.powf(f64::from(step) / 12.0);
                    let split = Split::new(&filter, (std::f64::consts::PI * edge).tan());
                    let mut impulse: Vec<i32> = vec![0; (40.0 / edge) as usize + 200];
                    impulse[0] = 1 << 24;
                    let mut branches = [impulse.clone(), impulse];
                    first_order(split.first, &mut [0; 3], &mut branches[1]);
                    most = most.max(gain(&branches[1]));
                    for (index, coefficients) in split.second.iter().take(count).enumerate() {
                        section(coefficients, &mut [0; 5], &mut branches[index % 2]);
                        most = most.max(gain(&branches[index % 2]));
                    }
                }
            }
        }
        std::println!("{most:.2}");
        assert!(most <= 7.5, "{most}");
    }
}
