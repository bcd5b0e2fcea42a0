//! A recording as samples, and notes on how it was read.

use std::fmt;
use std::ops::Range;

/// A recording, ready to be fitted.
#[derive(Clone, Debug)]
pub struct Recording {
    /// Samples of the microphone, full scale 1.
    pub samples: Vec<f64>,
    /// Constant offset that was taken off the microphone's samples, full scale 1; 0 if there was
    /// none that is noticeable.
    pub offset: f64,
    /// Samples of the measured force, full scale 1; `None` without a force channel.
    pub force: Option<Vec<f64>>,
    /// Samples at which the file's own samples stand still at its highest or lowest value.
    pub flat_tops: Vec<Range<usize>>,
    /// Sample rate in Hz.
    pub rate_hz: f64,
    /// Notes on how the recording was read.
    pub notes: Vec<Note>,
}

/// A decision about a recording that was made without asking.
#[derive(Clone, Debug, PartialEq)]
pub enum Note {
    /// One of several channels was taken.
    Channel {
        /// Index of the channel taken, from 0.
        taken: usize,
        /// Number of channels.
        channels: usize,
    },
    /// A constant offset was taken off a channel.
    Offset {
        /// Index of the channel, from 0.
        channel: usize,
        /// The offset, full scale 1.
        offset: f64,
    },
    /// The recording was decimated because its rate was too high.
    Decimated {
        /// Sample rate of the file in Hz.
        from_hz: f64,
        /// Sample rate after decimation in Hz.
        to_hz: f64,
    },
    /// Only the beginning was read because the file was too long.
    Truncated {
        /// Seconds that were read.
        seconds: f64,
    },
    /// The file can be read only up to a cut or a damaged part.
    Cut {
        /// Kind of the damage.
        cause: &'static str,
    },
    /// Strikes follow one another too closely: those after the first are taken for its bounces.
    Bounces {
        /// Times of the bounces in seconds.
        at_s: Vec<f64>,
    },
    /// The recording begins in the middle of a strike.
    StartsRinging,
    /// A steady noise lies under the strike, before it as long after it.
    Background {
        /// Level in dB of full scale.
        level_dbfs: f64,
    },
    /// Steady tones, such as the hum of mains, were taken off.
    Tones {
        /// Frequency in Hz and level in dB of full scale of each tone.
        tones: Vec<[f64; 2]>,
    },
    /// The recording ends soon after a strike, while it still rings.
    EndsRinging {
        /// Time from the strike to the end in seconds.
        after_s: f64,
    },
    /// The recording rises slowly: its beginning is taken for the onset.
    NoOnset {
        /// Time in seconds that is taken for the onset.
        at_s: f64,
    },
}

impl fmt::Display for Note {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Channel { taken, channels } => {
                write!(f, "channel {taken} of {channels} is used, the loudest: a mix of microphones would have notches")
            }
            Self::Offset { channel, offset } => {
                write!(f, "channel {channel} has a constant offset of {offset:.2e} of full scale, which is taken off")
            }
            Self::Decimated { from_hz, to_hz } => write!(f, "decimated from {from_hz} Hz to {to_hz} Hz"),
            Self::Truncated { seconds } => write!(f, "only the first {seconds} s were read"),
            Self::Cut { cause } => write!(f, "the file is cut or damaged ({cause}): the part before that is used"),
            Self::Bounces { at_s } => {
                write!(f, "strikes too close to the one before them are taken for its bounces: ")?;
                for (index, at_s) in at_s.iter().enumerate() {
                    write!(f, "{}{at_s:.3}", if index == 0 { "" } else { ", " })?;
                }
                write!(f, " s")
            }
            Self::NoOnset { at_s } => {
                write!(
                    f,
                    "no rise of 12 dB is heard: the strike is taken to begin where the sound does, at {at_s:.3} s"
                )
            }
            Self::EndsRinging { after_s } => write!(
                f,
                "the recording ends {after_s:.3} s after the strike, which still rings: slow decays are guesses"
            ),
            Self::Background { level_dbfs } => {
                write!(f, "a steady noise of {level_dbfs:.0} dBFS lies under the strike, and is left out of the fit")
            }
            Self::Tones { tones } => {
                write!(f, "steady tones that sound before the strike, too, such as the hum of mains, are taken off: ")?;
                for (index, [hz, dbfs]) in tones.iter().enumerate() {
                    write!(f, "{}{hz:.1} Hz at {dbfs:.0} dBFS", if index == 0 { "" } else { ", " })?;
                }
                Ok(())
            }
            Self::StartsRinging => write!(f, "the recording begins with the strike: its attack may be missing"),
        }
    }
}
