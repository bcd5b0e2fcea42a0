//! Banded waveguides in `f64` (*Analysis-Synthesis of Impact Sounds by Real-Time Dynamic Filtering*, eq. 12, 13).

use crate::SampleRate;
use crate::biquad::Biquad;
use crate::dynamic_filter::{Breakpoint, coefficients};

/// A feedback loop: a delay in whole frames, and a band-pass that holds the rest of the delay.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Loop {
    /// Frames, 1 or more.
    pub delay: usize,
    /// γ B.
    pub band: Biquad,
}

/// Eq. 12 and 13 from rest, struck at sample 0: s for an excitation `input` e.
pub fn filter(path: &[Breakpoint], loops: &[Loop], input: &[f64], rate: SampleRate) -> Vec<f64> {
    let mut s: Vec<f64> = Vec::with_capacity(input.len());
    // y_s(n-1), y_s(n-2) of each loop.
    let mut before = vec![[0.0; 2]; loops.len()];
    let mut last_input = 0.0;
    for (n, &e) in input.iter().enumerate() {
        let mut sum = e;
        for (Loop { delay, band }, y) in loops.iter().zip(&mut before) {
            let delayed = |more: usize| n.checked_sub(delay + more).map_or(0.0, |at| s[at]);
            let [b0, b1, b2] = band.numerator;
            let [a1, a2] = band.denominator;
            let now = b0 * delayed(0) + b1 * delayed(1) + b2 * delayed(2) - a1 * y[0] - a2 * y[1];
            *y = [now, y[0]];
            sum += now;
        }
        let [b0, b1, a1] = coefficients(path, n as f64 / rate.hz());
        s.push(b0 * sum + b1 * last_input - a1 * s.last().copied().unwrap_or(0.0));
        last_input = sum;
    }
    s
}
