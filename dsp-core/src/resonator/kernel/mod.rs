//! The hot loops: all register groups of a bank over a run of frames.
//!
//! Each sample of each mode is: step, inject, mix. A kernel takes groups in their order with their modes behind one another, runs those that
//! ring, and writes the sum of their sound. [`portable`] is the definition of the bits; on a Cortex-M4F the same is done by
//! assembly (`cortex_m4.s`), chosen at compile time, which tests compare bit for bit on the virtual core
//! (`cargo test -p host-tests --test on_chip kernels`).
//!
//! **Buffers run backward in time**: frame i of a run lies at index 31 - i of mix and force. On the chip a moving stack pointer
//! addresses them, which may only move down.
//!
//! States never wrap: [`super::headroom`] bounds them before a kernel is called, and in builds with debug assertions each
//! addition is checked.

pub mod portable;

#[cfg(cortex_m4f)]
mod cortex_m4;

pub use portable::driven_twice;

#[cfg(cortex_m4f)]
pub use cortex_m4::{driven, driven_stereo, free, free_stereo};
#[cfg(not(cortex_m4f))]
pub use portable::{driven, driven_stereo, free, free_stereo};

use crate::time::TICK_FRAMES;

/// A tick of samples, backward in time: frame i at index 31 - i.
pub type Backward = [i32; TICK_FRAMES];

/// Where a frame of a run lies in a [`Backward`] buffer.
pub const fn slot(frame: usize) -> usize {
    TICK_FRAMES - 1 - frame % TICK_FRAMES
}

/// How much of a tick to run, and of which groups.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Run {
    /// Frames, 1 to 32.
    pub frames: usize,
    /// Whether groups at rest are left out.
    pub skip: bool,
    /// Whether the sound is added to what the mix holds, or replaces it.
    pub add: bool,
}

/// Where and how loud a bank's mix goes to the stereo bus: `side += mantissa · (mix · 2^doublings << shift)`, saturating.
#[derive(Debug)]
pub struct Stereo<'a> {
    /// At least as many frames as the run's.
    pub out: &'a mut [[i32; 2]],
    /// Q32 gain of the left side.
    pub left: i32,
    /// The same of the right side.
    pub right: i32,
    /// How many times the mix is doubled before, saturating.
    pub doublings: u32,
    /// By how many bits it is shifted left then; nothing is lost by it.
    pub shift: u32,
}
