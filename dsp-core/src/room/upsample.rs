//! Doubling the sample rate: an elliptic half-band filter as two first-order all-pass branches at
//! the lower rate.
//!
//! `y[2n] = A(a0) x[n]`, `y[2n+1] = A(a1) x[n]`, `A(a) = (a + z^-1)/(1 + a z^-1)`. If the highest
//! band at the lower rate ends at 1/3 of it, images are 47 dB down; at 0.42 of it 32 dB.

use core::f64::consts::PI;

use super::elliptic::Elliptic;
use super::kernel;
use crate::sine;

/// Least end of the bands, of the lower rate: images are then 60 dB down.
const LEAST_END: f64 = 0.25;

/// Coefficients, the smaller as Q32, the other as Q31.
#[derive(Clone, Copy, Debug)]
pub(super) struct Upsampler {
    a: [i32; 2],
}

/// Memory of each side: the last input and the last outputs of both branches.
#[derive(Clone, Copy, Debug)]
pub(super) struct UpsamplerState {
    sides: [[i32; 3]; 2],
}

impl UpsamplerState {
    pub(super) const SILENT: Self = Self { sides: [[0; 3]; 2] };
}

impl Upsampler {
    pub(super) const NONE: Self = Self { a: [0; 2] };

    /// A doubling for bands that end at most at `to`, of the lower rate.
    pub(super) fn new(to: f64) -> Self {
        let tangent = sine::tan(0.5 * PI * to.max(LEAST_END));
        // At a half band's edge, with both sides alike, b0 is 1, and z^-1 has no part in a section.
        let [a0, a1, ..] = Elliptic::even(2, tangent * tangent).pairs.map(|[b1, _]| (2.0 - b1) / (2.0 + b1));
        Self { a: [libm::rint(a0 * 4_294_967_296.0) as i32, libm::rint(a1 * 2_147_483_648.0) as i32] }
    }

    /// Adds `slow` at twice its rate to `fast`, which is twice as long, or puts it there. `slow` is
    /// clipped to ±4.0 in Q4.27, so that no difference wraps: the impulse response of an all-pass
    /// of first order sums up to 1 + 2a < 2.5, so that all stays below 2^30.4, differences below
    /// 2^30.9.
    pub(super) fn render(&self, state: &mut UpsamplerState, slow: &[[i32; 2]], fast: &mut [[i32; 2]], add: bool) {
        kernel::double(&self.a, &mut state.sides, slow, fast, add);
    }
}
