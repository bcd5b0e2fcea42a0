//! The hot loops: all register groups of a bank over a run of frames.
//!
//! Each sample of each mode is: step, inject, mix. A kernel takes groups in their order with their
//! modes behind one another, runs those that ring, and writes the sum of their sound. [`portable`]
//! is the definition of the bits. On a Cortex-M4F assembly replaces it (`cortex_m4.s`), chosen at
//! compile time, which tests compare with it bit for bit on the virtual core
//! (`cargo test -p host-tests --test on_chip kernels`).
//!
//! **Buffers run backward in time**: frame i of a run lies at index 31 - i of mix and force. On the
//! chip a moving stack pointer addresses them, which may only move down.
//!
//! States never wrap: [`super::headroom`] bounds them before a kernel is called, and in builds with
//! debug assertions each addition is checked.

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

/// Place of a frame of a run in a [`Backward`] buffer.
pub const fn slot(frame: usize) -> usize {
    TICK_FRAMES - 1 - frame % TICK_FRAMES
}

/// Part of a tick to run, and its groups.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Run {
    /// Number of frames, 1 to 32.
    pub frames: usize,
    /// True if groups at rest are left out.
    pub skip: bool,
    /// True if the sound is added to the mix; if false it replaces the mix.
    pub add: bool,
}

/// Destination and loudness of a bank's mix on the stereo bus:
/// `side += mantissa · (mix · 2^doublings << shift)`, saturating.
#[derive(Debug)]
pub struct Stereo<'a> {
    /// Frames of the stereo bus, at least as many as the run's.
    pub out: &'a mut [[i32; 2]],
    /// Q32 gain of the left side.
    pub left: i32,
    /// Q32 gain of the right side.
    pub right: i32,
    /// Number of times that the mix is doubled first, saturating.
    pub doublings: u32,
    /// Number of bits of the shift left that follows, which loses no bit.
    pub shift: u32,
}
