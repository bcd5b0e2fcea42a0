//! Why a table of a room cannot be played.

use core::fmt;

use crate::SampleRate;
use crate::table::range;

/// Why a room cannot be built.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum RoomError {
    /// More bands than a room may have.
    TooManyBands {
        /// Bands of the table.
        bands: usize,
        /// Bands that a room has places for.
        capacity: usize,
    },
    /// The delays of so many bands do not fit the memory, be they as short as they may.
    TooFewSamples {
        /// Samples that are needed.
        needed: usize,
        /// Samples of this room.
        capacity: usize,
    },
    /// A band does not begin above the one before it, or the first not at 0.
    EdgesOutOfOrder {
        /// Which band.
        band: usize,
        /// Where it begins.
        from_hz: f32,
    },
    /// A band begins above 0.49 of the sample rate.
    EdgeAboveNyquist {
        /// Which band.
        band: usize,
        /// Where it begins.
        from_hz: f32,
        /// The rate.
        rate: SampleRate,
    },
    /// A decay that is no decay, or outside [`range::ROOM_DECAY_PER_S`].
    Decay {
        /// Which band.
        band: usize,
        /// What it says.
        decay_per_s: f32,
    },
    /// A gain outside [`range::ROOM_GAIN`].
    Gain {
        /// Which band.
        band: usize,
        /// What it says.
        gain: f32,
    },
}

impl fmt::Display for RoomError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::TooManyBands { bands, capacity } => {
                write!(f, "the room's bands: {bands}, a room has at most {capacity}")
            }
            Self::TooFewSamples { needed, capacity } => write!(
                f,
                "the room's delays: {needed} samples needed, this room has {capacity}: use fewer bands or a larger room"
            ),
            Self::EdgesOutOfOrder { band: 0, from_hz } => {
                write!(f, "the room's band 0: from_hz = {from_hz}: the first band must begin at 0")
            }
            Self::EdgesOutOfOrder { band, from_hz } => {
                write!(f, "the room's band {band}: from_hz = {from_hz}: must be above that of the band before it")
            }
            Self::EdgeAboveNyquist { band, from_hz, rate } => write!(
                f,
                "the room's band {band}: from_hz = {from_hz}: must be below {:.1}, 0.49 of the rate of {rate}",
                rate.hz() * 0.49
            ),
            Self::Decay { band, decay_per_s } => {
                let range::Range { min, max } = range::ROOM_DECAY_PER_S;
                write!(f, "the room's band {band}: decay_per_s = {decay_per_s}: must be from {min} to {max}")
            }
            Self::Gain { band, gain } => {
                let range::Range { min, max } = range::ROOM_GAIN;
                write!(f, "the room's band {band}: gain = {gain}: must be from {min} to {max}")
            }
        }
    }
}

impl core::error::Error for RoomError {}
