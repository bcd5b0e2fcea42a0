//! Ticks: the unit of time of all bookkeeping.

/// Number of frames of a tick: 0.67 ms at 48 kHz.
///
/// Ticks are counted from the engine's start, so that the caller's block size changes no bit.
pub const TICK_FRAMES: usize = 32;
