//! Errors of tables of a room.

use core::fmt;

use crate::SampleRate;
use crate::table::range;

/// Reason for which a room cannot be built. Bands are counted from 0, the lowest one.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum RoomError {
    /// The table has more bands than a room may have.
    TooManyBands {
        /// Number of bands of the table.
        bands: usize,
        /// Maximum number of bands.
        capacity: usize,
    },
    /// The delays of the bands do not fit the memory, even at their shortest.
    TooFewSamples {
        /// Number of samples that the delays need.
        needed: usize,
        /// Number of samples of this room's lines.
        capacity: usize,
    },
    /// A band does not begin above the one before it, or the first not at 0.
    EdgesOutOfOrder {
        /// Index of the band.
        band: usize,
        /// Its lower edge in Hz.
        from_hz: f32,
    },
    /// A band begins above 0.49 of the sample rate.
    EdgeAboveNyquist {
        /// Index of the band.
        band: usize,
        /// Its lower edge in Hz.
        from_hz: f32,
        /// Sample rate.
        rate: SampleRate,
    },
    /// A decay is outside [`range::ROOM_DECAY_PER_S`].
    Decay {
        /// Index of the band.
        band: usize,
        /// Its decay in nepers a second.
        decay_per_s: f32,
    },
    /// A gain is outside [`range::ROOM_GAIN`].
    Gain {
        /// Index of the band.
        band: usize,
        /// Its gain.
        gain: f32,
    },
}

impl fmt::Display for RoomError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::TooManyBands { bands, capacity } => {
                write!(f, "the room has {bands} bands; at most {capacity} are allowed")
            }
            Self::TooFewSamples { needed, capacity } => write!(
                f,
                "the room's delays need {needed} samples, but this room has {capacity}; use fewer bands or a larger room"
            ),
            Self::EdgesOutOfOrder { band: 0, from_hz } => {
                write!(f, "the room's band 0 begins at from_hz = {from_hz}; the first band must begin at 0")
            }
            Self::EdgesOutOfOrder { band, from_hz } => {
                write!(
                    f,
                    "the room's band {band} begins at from_hz = {from_hz}; it must begin above the band before it"
                )
            }
            Self::EdgeAboveNyquist { band, from_hz, rate } => write!(
                f,
                "the room's band {band} begins at from_hz = {from_hz}; it must begin below {:.1}, 0.49 of the rate of {rate}",
                rate.hz() * 0.49
            ),
            Self::Decay { band, decay_per_s } => {
                let range::Range { min, max } = range::ROOM_DECAY_PER_S;
                write!(f, "the room's band {band} has decay_per_s = {decay_per_s}; it must be from {min} to {max}")
            }
            Self::Gain { band, gain } => {
                let range::Range { min, max } = range::ROOM_GAIN;
                write!(f, "the room's band {band} has gain = {gain}; it must be from {min} to {max}")
            }
        }
    }
}

impl core::error::Error for RoomError {}
