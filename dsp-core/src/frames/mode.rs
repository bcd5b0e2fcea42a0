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
    /// imaginary part's. Without it a mode of T60 20 s would end 90 dB off.
    pub step_rest: u32,
    /// Gain of the gathered force: `g z^2N`.
    pub gain: Complex,
}

impl FrameMode {
    /// A silent mode without gains, which fills memory before a kit is loaded.
    pub const SILENT: Self =
        Self { state: [0.0; 2], numbers: [[0.0; 2]; WIDTH], step: [0.0; 2], step_rest: 0, gain: [0.0; 2] };

    /// Sets the step to a number and its rest.
    pub(super) fn set_step(&mut self, step: [f64; 2]) {
        self.step = step.map(|x| x as f32);
        let rest = |index: usize| {
            let (exact, rounded) = (step.get(index).copied(), self.step.get(index).copied());
            let rest = exact.unwrap_or(0.0) - f64::from(rounded.unwrap_or(0.0));
            // To the nearest: half a step of the last bit that stays.
            ((rest as f32).to_bits().wrapping_add(1 << 15)) & 0xffff_0000
        };
        self.step_rest = rest(0) | rest(1) >> 16;
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
