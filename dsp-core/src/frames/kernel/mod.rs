//! The hot loops of frames: lines of a spectrum from modes, modes from lines, the head,
//! and the block that plays.

#[cfg(cortex_m4f)]
mod cortex_m4;
pub mod portable;

use super::POINTS;

#[cfg(cortex_m4f)]
pub use cortex_m4::{convolve, gather, play, play_lone, synthesize, unwindow};
#[cfg(not(cortex_m4f))]
pub use portable::{convolve, gather, play, play_lone, synthesize, unwindow};

/// Number of outputs that [`convolve`] computes at once.
const OUTPUTS: usize = 3;
/// Number of samples of force in a step of [`convolve`]: its ranges are whole steps.
pub const SAMPLES: usize = 4;

/// Number of zeros before the taps of a head and behind them, which [`convolve`] may reach.
pub const ZEROS: [usize; 2] = [OUTPUTS - 1, OUTPUTS + SAMPLES - 2];
/// Number of a head's taps, zeros included.
pub const TAPS: usize = ZEROS[0] + POINTS + ZEROS[1];

/// A head that [`convolve`] plays.
#[derive(Clone, Copy, Debug)]
pub struct Convolution<'a> {
    /// Taps times 2^exponent, the longest lag first, between zeros. Their magnitudes add up to less
    /// than 2^32.
    pub taps: &'a [i32; TAPS],
    /// Exponent of the taps, at most 50.
    pub exponent: i32,
    /// Force of two blocks.
    pub force: &'a [i32; POINTS],
    /// Ranges of the force that are played, in whole [`SAMPLES`].
    pub ranges: &'a [[u16; 2]],
}

impl Convolution<'_> {
    /// Half a bus step, so that the shift rounds to the nearest. Sums of taps that add up to 2^31
    /// bus steps and more are whole steps.
    fn half(&self) -> i64 {
        if self.exponent > 0 { 1 << (self.exponent - 1) } else { 0 }
    }
}
