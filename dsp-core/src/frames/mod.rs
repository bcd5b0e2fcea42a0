//! Frames: banks of hundreds of modes, rendered a block ahead by one transform for all of them.
//!
//! ```text
//!  force of block j-2 --- transform --- gather --+        per pad, in the ticks of block j-1
//!                                                v
//!                     state of each mode: s = z^N s + G P
//!                                                |
//!                     pan <--- seven lines of a spectrum
//!                      |
//!                      +--- transform of all pads --- window --+--> sound of block j
//!  force of blocks j-1 and j ---- * first 2N samples of h -----+
//! ```
//!
//! Time is cut into blocks of N = [`BLOCK_FRAMES`] frames, counted from the engine's start. A mode
//! is `h[n] = Re(g z^n)` with `z = e^{(-d + 2πi f)/fs}`. Each block holds one complex amplitude of
//! each mode. Seven lines of a spectrum of 2N lines render the mode over the block ([`numbers`]).
//! This is a non-uniform Fourier transform of type 1 at the mode's complex frequency, so that the
//! decay within the block is right too. There is no overlap and no crossfade.
//!
//! The amplitudes of block j hold what struck before block j-1. The rest is the **head**: the
//! force of this block and the last one, convolved with the first 2N samples of the bank's
//! response. So a strike sounds at its very sample, and the sum is linear and does not depend on
//! the place of a strike within a block. Where it costs less, a transform makes what the last
//! block's force adds, from the third tick on at the earliest: the **tail**.
//!
//! A choke lays a hand on a bank: one factor on its whole sound, by which rates add. Its block
//! then has a transform of its own.
//!
//! Arithmetic is `f32` in the lines, 64-bit integers in the head. Products are rounded before they
//! are added, on every machine.

mod bank;
mod costs;
mod hand;
mod head;
pub mod kernel;
mod load;
mod mixer;
mod mode;
mod numbers;
mod pole;
mod samples;
mod spectrum;
mod step;
mod work;

pub use bank::{FrameBank, InFrames};
pub use head::Head;
pub use load::{FEWEST_MODES, FEWEST_MODES_OF_SEVERAL, FrameBankSize};
pub use mixer::FrameMixer;
pub use mode::{FrameMode, Line};
pub use numbers::numbers;

use crate::time::TICK_FRAMES;

/// Number of frames N of a block: 5.3 ms at 48 kHz.
///
/// A choke waits for the beginning of a block, N to 2N frames. With N = 128 it would wait half as
/// long, and a mode would take twice the cycles.
pub const BLOCK_FRAMES: usize = 256;

/// Number of points of a transform, 2N.
const POINTS: usize = 2 * BLOCK_FRAMES;

/// Number of lines that a mode lies next to: 0 to N.
pub const LINES: usize = BLOCK_FRAMES + 1;

/// Number of lines that a mode adds to.
pub const WIDTH: usize = 7;

/// Number of lines of a spectrum with those below 0 and above N that modes at its ends add to.
pub const PADDED_LINES: usize = LINES + WIDTH - 1;

/// Number of blocks in which each line is checked once for modes that no longer sound.
///
/// Checking all lines in every block costs 25 cycles a frame more with 256 modes: 475 instead of
/// 450 (`cargo test -p host-tests --test on_chip frames -- --nocapture` with 1 here).
const RETIREMENT_BLOCKS: usize = 8;

/// Number of ticks of a block.
const TICKS: usize = BLOCK_FRAMES / TICK_FRAMES;
