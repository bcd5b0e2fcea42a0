//! Why a kit, or a stage of it, cannot be played.

use core::fmt;

use super::stage::Stage;
use crate::SampleRate;
use crate::biquad::BiquadError;
use crate::dynamic_filter::DynamicFilterError;
use crate::memory::{OutOfMemory, WORD_BYTES};
use crate::resonator::{BankError, max_decay_per_s};
use crate::room::RoomError;
use crate::table::TableError;

/// Why a kit, or a stage of it, cannot be played by this engine.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum LoadError {
    /// The kit has no pad.
    NoPads,
    /// The kit has more pads than events can name.
    TooManyPads {
        /// Pads of the kit.
        pads: usize,
        /// Pads that events can name.
        capacity: usize,
    },
    /// The lent memory is too small.
    Memory {
        /// The stage that does not fit.
        stage: Stage,
        /// Words that are needed and left.
        error: OutOfMemory,
    },
    /// A band of noise reaches beyond half the sample rate.
    BeyondNyquist {
        /// The residual or the background.
        stage: Stage,
        /// The highest edge, in Hz.
        edge_hz: f32,
        /// The rate at which it was loaded.
        rate: SampleRate,
    },
    /// The kit's room cannot be built.
    Room(RoomError),
    /// There is no time for a stage in a tick beside the pads, the room and the background.
    TooDear {
        /// The stage that is left out.
        stage: Stage,
        /// Cycles of its dearest tick, with the cycle model's worst case and the waits of flash.
        cycles: u32,
        /// Cycles that are left.
        left: u32,
    },
    /// The kit's dynamic filter or biquad bank is invalid.
    FilterTable(TableError),
    /// The dynamic filter of a pad's object cannot be built at this rate.
    DynamicFilter {
        /// The pad, counted from 0.
        pad: u8,
        /// Why not.
        error: DynamicFilterError,
    },
    /// The biquad bank of a pad's object cannot be built at this rate.
    Biquads {
        /// The pad, counted from 0.
        pad: u8,
        /// Why not.
        error: BiquadError,
    },
    /// A bank of a pad cannot be built at this rate.
    Pad {
        /// The pad, counted from 0.
        pad: usize,
        /// The striker whose bank it is, or `None` for the object's.
        striker: Option<usize>,
        /// Why not.
        error: BankError,
        /// The rate at which it was loaded.
        rate: SampleRate,
    },
}

impl fmt::Display for LoadError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::NoPads => write!(f, "the kit has no pads: there is nothing to play"),
            Self::TooManyPads { pads, capacity } => write!(f, "pads: {pads}, a kit has at most {capacity}"),
            Self::Memory { stage, error } => write!(
                f,
                "{stage}: {} bytes of memory are missing: take a stage or modes out of the kit",
                error.missing() * WORD_BYTES
            ),
            Self::BeyondNyquist { stage, edge_hz, rate } => write!(
                f,
                "{stage}: edges_hz = {edge_hz}: must be at most {} Hz at {rate}; leave out the bands above",
                rate.hz() / 2.0
            ),
            Self::Room(error) => error.fmt(f),
            Self::TooDear { stage, cycles, left } => write!(
                f,
                "{stage}: takes up to {cycles} cycles a tick, and {left} are left beside pads, room and background: fewer of those, or a smaller one"
            ),
            Self::FilterTable(error) => error.fmt(f),
            Self::DynamicFilter { pad, error } => write!(f, "pad {pad}, dynamic filter of its object: {error}"),
            Self::Biquads { pad, error } => write!(f, "pad {pad}, biquads of its object: {error}"),
            Self::Pad { pad, striker, error, rate } => {
                write!(f, "pad {pad}, ")?;
                match striker {
                    Some(striker) => write!(f, "striker {striker} of the pad: ")?,
                    None => write!(f, "its object: ")?,
                }
                match error {
                    BankError::DecayTooFast { mode, decay_per_s } => write!(
                        f,
                        "mode {mode}: decay_per_s = {decay_per_s}: must be at most {:.1} at {rate}",
                        max_decay_per_s(rate)
                    ),
                    BankError::GainTooLarge => write!(
                        f,
                        "gain_sine or gain_cosine times reference_force (and striker_weight): must be below 2^14 times the rate"
                    ),
                }
            }
        }
    }
}

impl core::error::Error for LoadError {}
