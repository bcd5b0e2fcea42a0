//! Reasons to refuse loops.

use core::fmt;

/// Reason to refuse loops.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum LoopError {
    /// A number of a loop is out of range.
    ///
    /// The frequency must be between fs/10 000 and 0.499 fs. The bandwidth must be between fs/10^7
    /// and the frequency, and not above some fs/10. The gain must be finite, and the delay at least
    /// a frame.
    Band {
        /// Index of the loop, counted from 0.
        index: usize,
    },
    /// A loop's delay is longer than the line.
    Delay {
        /// Index of the loop, counted from 0.
        index: usize,
        /// Delay of the loop in frames.
        frames: f64,
        /// Length of the line in frames.
        room: usize,
    },
    /// More loops are given than fit.
    Count {
        /// Number of loops given.
        given: usize,
        /// Number of loops that fit.
        room: usize,
    },
    /// The gain round the loops reaches 1.
    Unstable {
        /// Frequency in Hz at which the gain reaches 1.
        frequency_hz: f64,
        /// Gain round the loops at that frequency.
        gain: f64,
    },
}

impl fmt::Display for LoopError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::Band { index } => write!(
                f,
                "loop {index}: give a frequency below 0.499 of the sample rate, a bandwidth below the frequency and a tenth of the sample rate, a finite gain, and a delay of a frame or more"
            ),
            Self::Delay { index, frames, room } => {
                write!(
                    f,
                    "loop {index}: a delay of {frames} frames where {room} fit: give fewer turns, or a higher frequency"
                )
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
