//! The computer's end of the cable.
//!
//! A [`Task`] says what to ask and reads the answers. An [`Exchange`] turns its requests into
//! messages, finds the answers among other MIDI, and asks again when one is lost. It neither sends
//! nor waits, so that a program with threads and a page without can use it. [`converse`] is the
//! loop of a program that waits for a [`Link`].

mod converse;
mod download;
mod exchange;
mod query;
mod upload;

use core::fmt;

use crate::answer::Answer;
use crate::refusal::Refusal;
use crate::request::Request;

pub use converse::{Link, converse};
pub use download::Download;
pub use exchange::{Exchange, Turn};
pub use query::Query;
pub use upload::Upload;

/// Reason for which a task of the computer ends early.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum HostError {
    /// The board refuses a request.
    Refused(Refusal),
    /// The board does not answer.
    NoAnswer,
    /// The board answers with something that has no meaning here.
    BadAnswer,
}

impl fmt::Display for HostError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Refused(refusal) => refusal.fmt(f),
            Self::NoAnswer => {
                write!(f, "the board does not answer: check the cable, and that no other program uses the board")
            }
            Self::BadAnswer => {
                write!(f, "the board's answer has no meaning here: use a malleus and a firmware of the same release")
            }
        }
    }
}

impl core::error::Error for HostError {}

/// Next step of a task.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Next {
    /// Sends the task's next request.
    Ask,
    /// Ends the task.
    Done,
}

/// Sequence of requests, each of which depends on the answers before it.
pub trait Task {
    /// Request to send next.
    fn request(&self) -> Request<'_>;

    /// Takes the answer to the request; never [`Answer::Working`] or [`Answer::Refused`].
    ///
    /// # Errors
    /// [`HostError::BadAnswer`] if the answer does not fit.
    fn answer(&mut self, answer: Answer<'_>) -> Result<Next, HostError>;

    /// Takes a refusal of the request.
    ///
    /// # Errors
    /// The refusal, unless the task can go on.
    fn refused(&mut self, refusal: Refusal) -> Result<Next, HostError> {
        Err(HostError::Refused(refusal))
    }
}
