//! Splitting the input at a band edge: a fifth-order elliptic low-pass and high-pass from one pair of all-pass branches.
//!
//! ```text
//!            ┌─ A0 = S(a0) ──────┬─(+)─► low  = (A0 + A1)/2
//!   x/2 ──┬──┤                   │ │
//!            └─ A1 = S(a1) · F ──┴─(-)─► high = (A0 - A1)/2
//! ```
//!
//! `|low|² + |high|² = 1` whatever the coefficients' rounding: no energy is lost or counted twice at an edge. 36 dB down from a sixth of an octave beyond
//! the edge. The half-band prototype (two coefficients a) is designed by the nome series of Valenzuela and Constantinides (1983) and moved to the
//! edge by `z^-1 -> (z^-1 - α)/(1 - α z^-1)`.

use super::kernel;

/// Second-order sections of a split, one of them behind the first-order one.
const SECTIONS: usize = 2;
/// Width of the half-band prototype's transition, of half the sample rate.
const TRANSITION: f64 = 0.1;

/// The coefficients a of all-pass sections `(a + z^-2)/(1 + a z^-2)`, rising, that make an elliptic half-band filter by turns in two branches.
///
/// `transition` is the width between pass band and stop band, as a part of half the sample rate.
pub(super) fn half_band<const N: usize>(transition: f64) -> [f64; N] {
    let pi = core::f64::consts::PI;
    let tangent = libm::tan((1.0 - 2.0 * transition) * pi / 4.0);
    let k = tangent * tangent;
    let root = libm::sqrt(libm::sqrt(1.0 - k * k));
    let e = 0.5 * (1.0 - root) / (1.0 + root);
    let e4 = e * e * e * e;
    let q = e * (1.0 + e4 * (2.0 + e4 * (15.0 + 150.0 * e4)));
    let order = (2 * N + 1) as f64;
    core::array::from_fn(|index| {
        let angle = (index + 1) as f64 * pi / order;
        let (mut numerator, mut denominator, mut sign) = (0.0, 0.5, 1.0);
        for i in 0..8 {
            let i = f64::from(i);
            numerator += sign * libm::pow(q, i * (i + 1.0)) * libm::sin((2.0 * i + 1.0) * angle);
            if i > 0.0 {
                denominator += sign * libm::pow(q, i * i) * libm::cos(2.0 * i * angle);
            }
            sign = -sign;
        }
        let w = libm::sqrt(libm::sqrt(q)) * numerator / denominator;
        let x = libm::sqrt((1.0 - w * w * k) * (1.0 - w * w / k)) / (1.0 + w * w);
        (1.0 - x) / (1.0 + x)
    })
}

/// A split's coefficients, Q31.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub(super) struct Split {
    /// α of the first-order section `(z^-1 - α)/(1 - α z^-1)`.
    pub(super) first: i32,
    /// c1/2 and c2/2 of `(c2 + c1 z^-1 + z^-2)/(1 + c1 z^-1 + c2 z^-2)`.
    pub(super) second: [[i32; 2]; SECTIONS],
}

/// What a split remembers: inputs and outputs of its sections, the latest first, and the bits that they cut off.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub(super) struct SplitState {
    pub(super) first: [i32; 3],
    pub(super) second: [[i32; 5]; SECTIONS],
}

impl SplitState {
    pub(super) const SILENT: Self = Self { first: [0; 3], second: [[0; 5]; SECTIONS] };
}

impl Split {
    pub(super) const NONE: Self = Self { first: 0, second: [[0; 2]; SECTIONS] };

    /// Splits at `edge` (of the sample rate, above 0 and below 1/2).
    pub(super) fn new(edge: f64) -> Self {
        let pi = core::f64::consts::PI;
        let (edge, middle) = (edge * pi, pi / 4.0);
        let alpha = libm::sin(middle - edge) / libm::sin(middle + edge);
        let q31 = |value: f64| libm::rint(value * 2_147_483_648.0) as i32;
        let second = half_band::<SECTIONS>(TRANSITION).map(|a| {
            let scale = 1.0 / (1.0 + a * alpha * alpha);
            [q31(-alpha * (1.0 + a) * scale), q31(0.5 * (a + alpha * alpha) * scale)]
        });
        Self { first: q31(alpha), second }
    }

    /// Splits `low`, which holds half the signal (at most ±1.0 in Q4.27), in place into half the low part, at most ±1.0, of which every second sample is kept
    /// where it is to be `thin`; `high` is as long, and whole. Gives the bits of the largest size in `high`.
    ///
    /// Nothing wraps: no branch's impulse response sums up to more than 5.65 (measured over all edges from 0.001 to 0.49 of the rate, see this file's
    /// tests): every value stays below 2^29.5, every difference of two below 2^30.5.
    pub(super) fn render(&self, state: &mut SplitState, low: &mut [i32], high: &mut [i32], thin: bool) -> i32 {
        32 - kernel::split(self, state, low, high, thin).leading_zeros() as i32
    }
}

#[cfg(test)]
mod tests {
    use super::super::kernel::portable::{first_order, section};
    use super::*;
    use std::vec;
    use std::vec::Vec;

    /// Sum of the sizes of a branch's impulse response (of 2^24).
    fn gain(section_of: Option<&[i32; 2]>, first: Option<i32>) -> f64 {
        let mut response: Vec<i32> = vec![0; 40_000];
        response[0] = 1 << 24;
        if let Some(section_of) = section_of {
            section(section_of, &mut [0; 5], &mut response);
        }
        if let Some(alpha) = first {
            first_order(alpha, &mut [0; 3], &mut response);
        }
        response.iter().map(|x| f64::from(x.abs())).sum::<f64>() / f64::from(1 << 24)
    }

    #[test]
    fn no_branch_raises_a_signal_by_more_than_its_headroom() {
        for step in 0..=60 {
            let Split { first, second: [c0, c1] } = Split::new(0.001 * 490f64.powf(f64::from(step) / 60.0));
            for gain in [gain(Some(&c0), None), gain(None, Some(first)), gain(Some(&c1), Some(first))] {
                assert!(gain <= 5.65, "{gain} at step {step}");
            }
        }
    }
}
