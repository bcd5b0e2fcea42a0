//! The errors of a trigger's settings and rates.

use core::fmt;

use super::limits::{MAX_RATE_HZ, MIN_RATE_HZ};
use crate::SampleRate;
use crate::table::range::Range;

/// Error in a trigger's settings or rates.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum TriggerError {
    /// The ADC's rate is not between [`MIN_RATE_HZ`] and [`MAX_RATE_HZ`].
    Rate {
        /// Rate of the ADC.
        rate: SampleRate,
    },
    /// The reduced ratio of the two rates does not fit two numbers of 31 bits.
    Ratio {
        /// Rate of the ADC.
        adc: SampleRate,
        /// Rate of the output.
        output: SampleRate,
    },
    /// A resampler's delay is shorter than its filter, or longer than its buffer.
    Delay {
        /// Delay in frames.
        frames: u32,
        /// Shortest delay in frames.
        min: u32,
        /// Longest delay in frames.
        max: u32,
    },
    /// Two sensors are on one ADC channel.
    SharedChannel {
        /// Second pad that names the channel.
        pad: u8,
        /// Number of the channel, counted from 0.
        channel: u8,
    },
    /// One button strikes two pads.
    SharedButton {
        /// Second pad that names the button.
        pad: u8,
        /// Number of the button, counted from 0.
        button: u8,
    },
    /// A number is outside its range.
    OutOfRange {
        /// Number of the pad, counted from 0.
        pad: u8,
        /// Key of the number in the text form.
        key: &'static str,
        /// Value of the number.
        value: f32,
        /// Range that is allowed.
        allowed: Range,
    },
}

impl fmt::Display for TriggerError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::Rate { rate } => {
                write!(
                    f,
                    "ADC rate {rate}: must be from {MIN_RATE_HZ} to {MAX_RATE_HZ} Hz; set its timer to the audio rate"
                )
            }
            Self::Ratio { adc, output } => {
                write!(
                    f,
                    "ADC rate {adc} to output rate {output}: give both as ratios whose quotient reduces to 31 bits"
                )
            }
            Self::Delay { frames, min, max } => {
                write!(f, "resampler delay of {frames} frames: must be from {min} to {max}")
            }
            Self::SharedChannel { pad, channel } => {
                write!(f, "pad {pad}: channel {channel} is another sensor's already; give each its own")
            }
            Self::SharedButton { pad, button } => {
                write!(f, "pad {pad}: button {button} strikes another pad already; give each its own")
            }
            Self::OutOfRange { pad, key, value, allowed } => {
                write!(f, "pad {pad}: {key} = {value}: must be from {} to {}", allowed.min, allowed.max)
            }
        }
    }
}

impl core::error::Error for TriggerError {}
