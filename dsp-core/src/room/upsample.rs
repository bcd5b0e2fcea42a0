//! Doubling the sample rate: an elliptic half-band filter as two first-order all-pass branches at the lower rate.
//!
//! `y[2n] = A(a0) x[n]`, `y[2n+1] = A(a1) x[n]`, `A(a) = (a + z^-1)/(1 + a z^-1)`: images are 36 dB down from 0.3 of the higher rate on, where bands end at 0.2 of it.

use super::elliptic::Elliptic;
use super::kernel;

/// Where the pass band ends over where the stop band begins, as `tan(π f)`: at 0.2 and 0.3 of the higher rate.
const SELECTIVITY: f64 = 0.527_864_045_000_420_6;

/// The coefficients, the smaller as Q32, the other as Q31; the same at every rate.
#[derive(Clone, Copy, Debug)]
pub(super) struct Upsampler {
    a: [i32; 2],
}

/// What it remembers of each side: the last input and both branches' last outputs.
#[derive(Clone, Copy, Debug)]
pub(super) struct UpsamplerState {
    sides: [[i32; 3]; 2],
}

impl UpsamplerState {
    pub(super) const SILENT: Self = Self { sides: [[0; 3]; 2] };
}

impl Upsampler {
    pub(super) const NONE: Self = Self { a: [0; 2] };

    pub(super) fn new() -> Self {
        // At a half band's edge, with both sides alike, b0 is 1, and z^-1 has no part in a section.
        let [a0, a1, ..] = Elliptic::even(2, SELECTIVITY).pairs.map(|[b1, _]| (2.0 - b1) / (2.0 + b1));
        Self { a: [libm::rint(a0 * 4_294_967_296.0) as i32, libm::rint(a1 * 2_147_483_648.0) as i32] }
    }

    /// Adds `slow` at twice its rate to `fast`, which is twice as long, or puts it there. `slow` is clipped to ±4.0 in Q4.27, so that no difference wraps: the
    /// impulse response of an all-pass of first order sums up to 1 + 2a < 2.5, so that all stays below 2^30.4, differences below 2^30.9.
    pub(super) fn render(&self, state: &mut UpsamplerState, slow: &[[i32; 2]], fast: &mut [[i32; 2]], add: bool) {
        kernel::double(&self.a, &mut state.sides, slow, fast, add);
    }
}
