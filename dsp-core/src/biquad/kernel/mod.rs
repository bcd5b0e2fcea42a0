//! The hot loops: all pairs of a bank over a run of frames.
//!
//! A frame of a pair: mix, step, inject. [`portable`] is the definition of the bits; on a Cortex-M4F the same is done by assembly
//! (`cortex_m4.s`), compared bit for bit on the virtual core (`cargo test -p host-tests --test on_chip biquads`).

pub mod portable;

#[cfg(cortex_m4f)]
mod cortex_m4;

#[cfg(cortex_m4f)]
pub use cortex_m4::run;
#[cfg(not(cortex_m4f))]
pub use portable::run;

/// What the sizes of a tick's inputs, as words, may add up to.
pub const ALLOWANCE: u32 = 1 << 30;

/// How a run's input becomes words, and its mix the bus.
#[derive(Clone, Copy, Debug)]
pub struct Run {
    /// No input may reach 2^bits, 0 to 31: a run that has one is not begun.
    pub bits: u32,
    /// What may be left of [`ALLOWANCE`]: a run whose inputs exceed it is not begun.
    pub allowance: u32,
    /// By how many bits inputs are shifted left.
    pub left: u32,
    /// Then right, rounding down.
    pub right: u32,
    /// Q32 of the shifted input into the mix.
    pub direct: i32,
    /// By how many bits the mix is shifted left, saturating.
    pub room: u32,
    /// Whether the first frame is an odd one.
    pub odd: bool,
}

/// What a run has come to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Outcome {
    /// The sizes of all inputs, as words, added up; what is below 0 counts 1 less.
    pub used: u32,
    /// Whether a pair asks to be settled.
    pub asks: bool,
    /// Whether an input was too large, so that nothing has been done.
    pub refused: bool,
}
