//! Splitting the input at a band edge: a seventh-order elliptic low-pass and high-pass from one pair of all-pass branches.
//!
//! ```text
//!          ┌─ A0 = S(a0) · S(a2) ──┬─(+)─► low  = (A0 + A1)/2
//!   x ──┬──┤                       │ │
//!          └─ A1 = F · S(a1) ──────┴─(-)─► high = (A0 - A1)/2
//! ```
//!
//! `|low|² + |high|² = 1` whatever the coefficients' rounding: no energy is lost or counted twice at an edge. 40 dB down from a quarter of an octave beyond
//! the edge. The half-band prototype (three coefficients a) is designed by the nome series of Valenzuela and Constantinides (1983) and moved to the
//! edge by `z^-1 -> (z^-1 - α)/(1 - α z^-1)`.

/// Second-order sections of a split, one of them behind the first-order one.
const SECTIONS: usize = 3;
/// Width of the half-band prototype's transition, of half the sample rate.
const TRANSITION: f64 = 0.05;

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

/// A split's coefficients, Q30.
#[derive(Clone, Copy, Debug)]
pub(super) struct Split {
    /// α of the first-order section `(z^-1 - α)/(1 - α z^-1)`.
    first: i32,
    /// c1, c2 of `(c2 + c1 z^-1 + z^-2)/(1 + c1 z^-1 + c2 z^-2)`.
    second: [[i32; 2]; SECTIONS],
}

/// What a split remembers: inputs, outputs and cut-off bits of its sections.
#[derive(Clone, Copy, Debug)]
pub(super) struct SplitState {
    first: [i32; 3],
    second: [[i32; 5]; SECTIONS],
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
        let q30 = |value: f64| libm::rint(value * 1_073_741_824.0) as i32;
        let second = half_band::<SECTIONS>(TRANSITION).map(|a| {
            let scale = 1.0 / (1.0 + a * alpha * alpha);
            [q30(-2.0 * alpha * (1.0 + a) * scale), q30((a + alpha * alpha) * scale)]
        });
        Self { first: q30(alpha), second }
    }

    /// Splits `low` (at most ±2.0 in Q4.27) in place; `high` is as long.
    ///
    /// Nothing wraps: the branches run at half scale, at most ±2^27, and no branch's impulse response sums up to more than 5.65
    /// (measured over all edges from 0.001 to 0.49 of the rate, see this file's tests): every value stays below 2^29.5, every difference of two
    /// below 2^30.5.
    pub(super) fn render(&self, state: &mut SplitState, low: &mut [i32], high: &mut [i32]) {
        for (low, high) in low.iter_mut().zip(high.iter_mut()) {
            let half = *low >> 1;
            (*low, *high) = (half, half);
        }
        let ([c0, c1, c2], [s0, s1, s2]) = (&self.second, &mut state.second);
        section(c0, s0, low);
        section(c2, s2, low);
        first_order(self.first, &mut state.first, high);
        section(c1, s1, high);
        for (low, high) in low.iter_mut().zip(high.iter_mut()) {
            let (a, b) = (*low, *high);
            (*low, *high) = (clip(a + b), a - b);
        }
    }
}

/// To ±2.0, for the next split.
#[inline(always)]
pub(super) fn clip(value: i32) -> i32 {
    const CLIP: i32 = 1 << 28;
    let value = if value < -CLIP { -CLIP } else { value };
    if value > CLIP - 1 { CLIP - 1 } else { value }
}

/// Bits of fraction of a coefficient.
const FRACTION: u32 = 30;

/// `y = x2 + c2 (x - y2) + c1 (x1 - y1)`. What rounding cuts off is added to the next sum: a pole pair near 0 Hz would raise plain rounding noise by the square of what it
/// raises this.
fn section(&[c1, c2]: &[i32; 2], state: &mut [i32; 5], block: &mut [i32]) {
    let [mut x1, mut x2, mut y1, mut y2, mut rest] = *state;
    let mut step = |x: &mut i32| {
        // Two products of at most 2^30.5 by 2^30 and by 2^31: below 2^62.1.
        let sum = i64::from(*x - y2) * i64::from(c2) + i64::from(x1 - y1) * i64::from(c1) + i64::from(rest);
        rest = (sum & ((1 << FRACTION) - 1)) as i32;
        let y = x2 + (sum >> FRACTION) as i32;
        (x2, x1, y2, y1) = (x1, *x, y1, y);
        *x = y;
    };
    // Two at a time: the registers of the past then need not be moved.
    let (pairs, last) = block.as_chunks_mut::<2>();
    for [a, b] in pairs {
        step(a);
        step(b);
    }
    last.iter_mut().for_each(step);
    *state = [x1, x2, y1, y2, rest];
}

/// `y = x1 - α (x - y1)`, with its rounding carried on in the same way.
fn first_order(alpha: i32, state: &mut [i32; 3], block: &mut [i32]) {
    let [mut x1, mut y1, mut rest] = *state;
    for x in block {
        let sum = i64::from(*x - y1) * i64::from(alpha) + i64::from(rest);
        rest = (sum & ((1 << FRACTION) - 1)) as i32;
        let y = x1 - (sum >> FRACTION) as i32;
        (x1, y1) = (*x, y);
        *x = y;
    }
    *state = [x1, y1, rest];
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::vec;
    use std::vec::Vec;

    /// Sum of the sizes of a branch's impulse response (of 2^24).
    fn gain(sections: &[[i32; 2]], first: Option<i32>) -> f64 {
        let mut response: Vec<i32> = vec![0; 40_000];
        response[0] = 1 << 24;
        for section_of in sections {
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
            let Split { first, second: [c0, c1, c2] } = Split::new(0.001 * 490f64.powf(f64::from(step) / 60.0));
            for gain in [gain(&[c0], None), gain(&[c0, c2], None), gain(&[], Some(first)), gain(&[c1], Some(first))] {
                assert!(gain <= 5.65, "{gain} at step {step}");
            }
        }
    }
}
