//! Recordings as samples: decoding, the choice of a channel, and the rate.
//!
//! Modes are fitted at the recording's own rate. Only above 48 kHz a recording is decimated by a whole number, so that the rate is at most
//! 48 kHz again; nothing is ever resampled by a fraction.

mod decimate;
mod decode;

pub use decode::read;

use std::fmt;

/// A recording, ready to be fitted.
#[derive(Clone, Debug)]
pub struct Recording {
    /// The microphone, full scale 1.
    pub samples: Vec<f64>,
    /// The measured force, full scale 1, where a force channel was named.
    pub force: Option<Vec<f64>>,
    /// Sample rate in Hz.
    pub rate_hz: f64,
    /// What was done to get here.
    pub notes: Vec<Note>,
}

/// What was decided about a recording without asking.
#[derive(Clone, Debug, PartialEq)]
pub enum Note {
    /// One of several channels was taken.
    Channel {
        /// Which, from 0.
        taken: usize,
        /// Of how many.
        channels: usize,
    },
    /// The rate was too high.
    Decimated {
        /// The file's rate in Hz.
        from_hz: f64,
        /// The rate at which it is fitted.
        to_hz: f64,
    },
    /// The file was too long.
    Truncated {
        /// Seconds that were read.
        seconds: f64,
    },
    /// The file ends in the middle of its data.
    Cut {
        /// What the decoder says.
        cause: String,
    },
    /// Strikes follow too closely: those after the first are taken as its bounces.
    Bounces {
        /// Times of the bounces in seconds.
        at_s: Vec<f64>,
    },
    /// The recording begins in the middle of a strike.
    StartsRinging,
}

impl fmt::Display for Note {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Channel { taken, channels } => {
                write!(f, "channel {taken} of {channels} taken, the loudest: a mix of microphones has notches")
            }
            Self::Decimated { from_hz, to_hz } => write!(f, "decimated from {from_hz} Hz to {to_hz} Hz"),
            Self::Truncated { seconds } => write!(f, "only the first {seconds} s were read"),
            Self::Cut { cause } => write!(f, "the file is cut or damaged ({cause}): what could be read is used"),
            Self::Bounces { at_s } => {
                write!(f, "strikes too close to the one before them are taken as its bounces: ")?;
                for (index, at_s) in at_s.iter().enumerate() {
                    write!(f, "{}{at_s:.3}", if index == 0 { "" } else { ", " })?;
                }
                write!(f, " s")
            }
            Self::StartsRinging => write!(f, "the recording begins with the strike: its attack may be missing"),
        }
    }
}
