//! Why a trigger cannot be set up.

use core::fmt;

use super::{MAX_RATE_HZ, MIN_RATE_HZ};
use crate::SampleRate;
use crate::table::range::Range;

/// Why settings or rates are refused.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum TriggerError {
    /// The ADC's rate is not between [`MIN_RATE_HZ`] and [`MAX_RATE_HZ`].
    Rate {
        /// The rate.
        rate: SampleRate,
    },
    /// The two rates have no ratio of two 31-bit numbers.
    Ratio {
        /// The ADC's rate.
        adc: SampleRate,
        /// The output's rate.
        output: SampleRate,
    },
    /// A resampler's delay is shorter than its filter, or longer than its buffer.
    Delay {
        /// The delay in frames.
        frames: u32,
        /// The shortest.
        min: u32,
        /// The longest.
        max: u32,
    },
    /// Two sensors on one ADC channel.
    SharedChannel {
        /// The second pad that names it.
        pad: u8,
        /// The channel.
        channel: u8,
    },
    /// Two pads struck by one button.
    SharedButton {
        /// The second pad that names it.
        pad: u8,
        /// The button.
        button: u8,
    },
    /// A number outside its range.
    OutOfRange {
        /// Which pad.
        pad: u8,
        /// The key in the text form.
        key: &'static str,
        /// Its value.
        value: f32,
        /// What is allowed.
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
