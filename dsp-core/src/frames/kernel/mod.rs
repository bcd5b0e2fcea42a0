//! The hot loops of frames: lines of a spectrum from modes, modes from lines, the head,
//! and the block that plays.

#[cfg(cortex_m4f)]
mod cortex_m4;
pub mod portable;

#[cfg(cortex_m4f)]
pub use cortex_m4::{convolve, gather, play, play_lone, synthesize, unwindow};
#[cfg(not(cortex_m4f))]
pub use portable::{convolve, gather, play, play_lone, synthesize, unwindow};

/// Number of outputs that [`convolve`] computes at once.
pub const OUTPUTS: usize = 3;
