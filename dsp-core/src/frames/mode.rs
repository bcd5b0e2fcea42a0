//! A mode in frames: its amplitude, its numbers and its steps.

use super::WIDTH;
use crate::fourier::Complex;

/// A mode: 84 bytes, in the order in which the kernels load them.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[repr(C)]
pub struct FrameMode {
    /// Complex amplitude at the middle of a block, in bus steps.
    pub state: Complex,
    /// Numbers of the seven lines ([`super::numbers`]).
    pub numbers: [Complex; WIDTH],
    /// Step of the state from block to block: z^N, rounded.
    pub step: Complex,
    /// Rest of the step to 8 bits each: the upper half of the real part's bits, then that of the
    /// imaginary part's. With 0 here the worst mode of T60 20 s has an SNR of 103.0 dB, not 105.8
    /// (`cargo test -p host-tests --test stages frames -- --nocapture`).
    pub step_rest: u32,
    /// Gain of the gathered force: `g z^2N`.
    pub gain: Complex,
}

impl FrameMode {
    /// Sets the step to a number and its rest.
    pub(super) fn set_step(&mut self, [re, im]: [f64; 2]) {
        self.step = [re as f32, im as f32];
        // To the nearest: half a step of the last bit that stays.
        let upper = |rest: f64| (rest as f32).to_bits().wrapping_add(1 << 15) & 0xffff_0000;
        let [x, y] = self.step.map(f64::from);
        self.step_rest = upper(re - x) | upper(im - y) >> 16;
    }
}

/// Modes nearest to one line of a spectrum. Those of lines 0, 1 ... follow one another, on each
/// line the slowest decay first.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[repr(C)]
pub struct Line {
    /// Number of modes.
    pub count: u16,
    /// Number of modes that ring: the first ones.
    pub ringing: u16,
}
