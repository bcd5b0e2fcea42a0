//! Errors in the structure of a scene.
//!
//! Values (a negative frequency, a contact time of zero) are trusted: the reader of a table checks
//! them. Indices and lengths are checked here, because rendering would otherwise index out of
//! bounds.

use std::fmt;

use crate::resonator::GainsError;

/// One of a pad's modal banks.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BankOwner {
    /// The struck object.
    Object,
    /// The striker with this index in the pad.
    Striker(usize),
}

impl fmt::Display for BankOwner {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Object => f.write_str("object"),
            Self::Striker(index) => write!(f, "striker {index}"),
        }
    }
}

/// Reason why a scene cannot be rendered. Every index counts from 0.
#[derive(Clone, Debug, PartialEq)]
pub enum Error {
    /// An event names a pad that the scene does not have.
    EventPad {
        /// Index of the event in the list given.
        event: usize,
        /// Index of the pad that the event names.
        pad: usize,
        /// Number of pads in the scene.
        pad_count: usize,
    },
    /// A strike names a striker that its pad does not have.
    EventStriker {
        /// Index of the event in the list given.
        event: usize,
        /// Index of the pad that the event plays.
        pad: usize,
        /// Index of the striker that the event names.
        striker: usize,
        /// Number of strikers of that pad.
        striker_count: usize,
    },
    /// An event is earlier than the one before it, or its time is not a number.
    EventOrder {
        /// Index of the event in the list given.
        event: usize,
        /// Time of the event in samples.
        time_samples: f64,
        /// Time of the event before it, in samples.
        previous_samples: f64,
    },
    /// The direct force, or the caller, names a pad that the scene does not have.
    NoSuchPad {
        /// Index of the pad named.
        pad: usize,
        /// Number of pads in the scene.
        pad_count: usize,
    },
    /// A modal bank of a pad has gains at the wrong number of positions.
    Bank {
        /// Index of the pad.
        pad: usize,
        /// The bank with the wrong gains.
        owner: BankOwner,
        /// Index of the mode, and the number of positions found and expected.
        gains: GainsError,
    },
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::EventPad { event, pad, pad_count } => write!(
                f,
                "event {event} plays pad {pad}, but the scene has {pad_count} pads counted from 0: \
                 correct the event or add the pad"
            ),
            Self::EventStriker { event, pad, striker, striker_count } => write!(
                f,
                "event {event} uses striker {striker} of pad {pad}, which has {striker_count} strikers \
                 counted from 0: correct the event or add the striker"
            ),
            Self::EventOrder { event, time_samples, previous_samples } => write!(
                f,
                "event {event} is at sample {time_samples}, but the event before it is at \
                 {previous_samples}: sort the events by time"
            ),
            Self::NoSuchPad { pad, pad_count } => {
                write!(f, "there is no pad {pad}: the scene has {pad_count} pads counted from 0; name one of them")
            }
            Self::Bank { pad, owner, gains } => write!(f, "the {owner} bank of pad {pad}: {gains}"),
        }
    }
}

impl std::error::Error for Error {}
