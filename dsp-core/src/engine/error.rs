//! Errors of kits, and of stages of kits, that cannot be played.

use core::fmt;

use super::stage::Stage;
use crate::SampleRate;
use crate::biquad::BiquadError;
use crate::dynamic_filter::DynamicFilterError;
use crate::memory::{OutOfMemory, WORD_BYTES};
use crate::resonator::{BankError, max_decay_per_s};
use crate::room::RoomError;
use crate::table::TableError;

/// Reason why an engine cannot play a kit, or a stage of it.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum LoadError {
    /// The kit has no pad.
    NoPads,
    /// The kit has more pads than events can name.
    TooManyPads {
        /// Number of pads of the kit.
        pads: usize,
        /// Number of pads that events can name.
        capacity: usize,
    },
    /// The lent memory is too small.
    Memory {
        /// Stage that does not fit.
        stage: Stage,
        /// Words of memory that the stage needs, and those that are left.
        error: OutOfMemory,
    },
    /// The program has no code for a stage of the kit.
    NotBuilt {
        /// Stage that is left out.
        stage: Stage,
    },
    /// A band of noise reaches beyond half the sample rate.
    BeyondNyquist {
        /// Residual or background that has the band.
        stage: Stage,
        /// Highest edge of its bands, in Hz.
        edge_hz: f32,
        /// Sample rate of the engine.
        rate: SampleRate,
    },
    /// The kit's room cannot be built.
    Room(RoomError),
    /// A stage takes more time than pads, room and background leave in a tick.
    TooDear {
        /// Stage that is left out.
        stage: Stage,
        /// Cycles of the stage's dearest tick, with the cycle model's worst case and the waits of
        /// flash.
        cycles: u32,
        /// Cycles a tick that are left for the stage.
        left: u32,
    },
    /// The kit's dynamic filter or biquad bank is invalid.
    FilterTable(TableError),
    /// The kit's surfaces, or what moves over them, are invalid.
    SurfaceTable(TableError),
    /// The dynamic filter of a pad's object cannot be built at this rate.
    DynamicFilter {
        /// Pad, counted from 0.
        pad: u8,
        /// Reason why the dynamic filter cannot be built.
        error: DynamicFilterError,
    },
    /// The biquad bank of a pad's object cannot be built at this rate.
    Biquads {
        /// Pad, counted from 0.
        pad: u8,
        /// Reason why the biquad bank cannot be built.
        error: BiquadError,
    },
    /// The bank of a pad's object, or of one of its strikers, cannot be built at this rate.
    Pad {
        /// Pad, counted from 0.
        pad: usize,
        /// Striker whose bank it is, counted from 0; `None` for the object's bank.
        striker: Option<usize>,
        /// Reason why the bank cannot be built.
        error: BankError,
        /// Sample rate of the engine.
        rate: SampleRate,
    },
}

impl fmt::Display for LoadError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::NoPads => write!(f, "the kit has no pads: it must have at least one"),
            Self::TooManyPads { pads, capacity } => {
                write!(f, "the kit has {pads} pads: it must have at most {capacity}")
            }
            Self::Memory { stage, error } => write!(
                f,
                "{stage}: {} bytes of memory are missing: take a stage or modes out of the kit",
                error.missing() * WORD_BYTES
            ),
            Self::NotBuilt { stage } => write!(
                f,
                "{stage}: this board's firmware has no code for it: take it out of the kit, or play the kit on another board"
            ),
            Self::BeyondNyquist { stage, edge_hz, rate } => write!(
                f,
                "{stage}: edges_hz = {edge_hz}: must be at most {} Hz at {rate}; leave out the bands above",
                rate.hz() / 2.0
            ),
            Self::Room(error) => error.fmt(f),
            Self::TooDear { stage: stage @ Stage::Positions(_), cycles, left } => write!(
                f,
                "{stage}: moving takes {cycles} cycles, but a strike leaves {left}: all fall on position 0; give the object fewer modes"
            ),
            Self::TooDear { stage, cycles, left } => write!(
                f,
                "{stage}: takes up to {cycles} cycles a tick, but pads, room and background leave {left}: take some of them out of the kit, or make it smaller"
            ),
            Self::FilterTable(error) | Self::SurfaceTable(error) => error.fmt(f),
            Self::DynamicFilter { pad, error } => write!(f, "{}: {error}", Stage::DynamicFilter(pad)),
            Self::Biquads { pad, error } => write!(f, "{}: {error}", Stage::Biquads(pad)),
            Self::Pad { pad, striker, error, rate } => {
                match striker {
                    Some(striker) => write!(f, "pad {pad}, striker {striker} of the pad: ")?,
                    None => write!(f, "pad {pad}, its object: ")?,
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
