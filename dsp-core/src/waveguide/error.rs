//! Why loops are refused.

use core::fmt;

/// Why loops are refused.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum LoopError {
    /// A frequency not between fs/10 000 and 0.499 fs, a bandwidth not between fs/10^7 and the
    /// frequency (or above some fs/10), a gain that is no number, or a delay below a frame.
    Band {
        /// The loop, counted from 0.
        index: usize,
    },
    /// A delay longer than the line.
    Delay {
        /// The loop, counted from 0.
        index: usize,
        /// Its delay in frames.
        frames: f64,
        /// Frames of the line.
        room: usize,
    },
    /// More loops than fit.
    Count {
        /// Loops given.
        given: usize,
        /// Loops that fit.
        room: usize,
    },
    /// The gain round the loops reaches 1.
    Unstable {
        /// Frequency in Hz.
        frequency_hz: f64,
        /// The gain.
        gain: f64,
    },
}

impl fmt::Display for LoopError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::Band { index } => write!(
                f,
                "loop {index}: give 0 < bandwidth < frequency < Nyquist, a finite gain, and a delay of a frame or more"
            ),
            Self::Delay { index, frames, room } => {
                write!(f, "loop {index}: a delay of {frames} frames where {room} fit: give fewer turns (p in eq. 22)")
            }
            Self::Count { given, room } => write!(f, "{given} loops where {room} fit: give fewer"),
            Self::Unstable { frequency_hz, gain } => write!(
                f,
                "the gain round the loops is {gain} at {frequency_hz} Hz: lower the loops' gains until it is below 1"
            ),
        }
    }
}

impl core::error::Error for LoopError {}
