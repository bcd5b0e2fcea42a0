//! Requests and their answers, one at a time.

use super::{HostError, Next, Task};
use crate::answer::Answer;
use crate::refusal::Refusal;
use crate::wire::{Heard, Message, Receiver};

/// Next deed of the caller.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Turn {
    /// Goes on listening; [`Exchange::wait_ms`] stays as it was.
    Listen,
    /// Goes on listening, for [`Exchange::wait_ms`] from now.
    Wait,
    /// Calls [`Exchange::ask`] and sends the message.
    Ask,
    /// Stops: the task is done.
    Done,
}

/// Exchange of messages with a board for one task after another.
pub struct Exchange {
    receiver: Receiver,
    tag: u8,
    /// Number of times that the request was sent without an answer that serves.
    tries: u8,
    wait_ms: u32,
}

impl Exchange {
    /// Time that the board has for an answer, in milliseconds. The slowest one, of a slot's
    /// content, takes some 200 ms.
    const ANSWER_MS: u32 = 1000;
    /// Time after which a board that still works is asked again, in milliseconds.
    const STILL_WORKING_MS: u32 = 3000;
    /// Number of times that a request is sent before the task fails.
    const TRIES: u8 = 8;

    /// Makes an exchange that begins with a tag.
    ///
    /// Programs that talk to one board begin with tags of their own, such as of the time, so that
    /// none takes an answer to the other for its own.
    pub const fn new(tag: u8) -> Self {
        Self { receiver: Receiver::new(), tag: tag & 0x7F, tries: 0, wait_ms: Self::ANSWER_MS }
    }

    /// Time from now until [`timed_out`](Self::timed_out) is due, in milliseconds.
    pub fn wait_ms(&self) -> u32 {
        self.wait_ms
    }

    /// Writes the task's request as the message to send next.
    pub fn ask(&mut self, task: &impl Task, message: &mut Message) {
        self.wait_ms = Self::ANSWER_MS;
        task.request().write(self.tag, message);
    }

    /// Takes one byte from the board.
    ///
    /// # Errors
    /// [`HostError`] if the task cannot go on.
    pub fn receive(&mut self, byte: u8, task: &mut impl Task) -> Result<Turn, HostError> {
        let frame = match self.receiver.receive(byte) {
            Heard::Message(frame) if frame.tag == self.tag => frame,
            // A damaged answer is asked for anew when its time is over.
            Heard::Nothing | Heard::Broken { .. } | Heard::Message(_) => return Ok(Turn::Listen),
        };
        if !Answer::is_to(frame.command, task.request().command()) {
            return Ok(Turn::Listen);
        }
        let next = match Answer::read(frame.command, frame.payload).ok_or(HostError::BadAnswer)? {
            Answer::Working { ms } => {
                self.wait_ms = u32::from(ms) + Self::ANSWER_MS;
                return Ok(Turn::Wait);
            }
            Answer::Refused(Refusal::Working) => {
                self.wait_ms = Self::STILL_WORKING_MS;
                return Ok(Turn::Wait);
            }
            // The board tells of a cut message when the next one begins: the second try, perhaps.
            Answer::Refused(Refusal::CutMessage) => return Ok(Turn::Listen),
            Answer::Refused(refusal @ (Refusal::DamagedMessage | Refusal::LongMessage)) => {
                return self.again(HostError::Refused(refusal));
            }
            Answer::Refused(refusal) => task.refused(refusal)?,
            answer => task.answer(answer)?,
        };
        self.tag = (self.tag + 1) & 0x7F;
        self.tries = 0;
        Ok(match next {
            Next::Ask => Turn::Ask,
            Next::Done => Turn::Done,
        })
    }

    /// Takes note that no answer came in time; the request is to be sent again.
    ///
    /// # Errors
    /// [`HostError::NoAnswer`] after the last try.
    pub fn timed_out(&mut self) -> Result<Turn, HostError> {
        self.again(HostError::NoAnswer)
    }

    fn again(&mut self, error: HostError) -> Result<Turn, HostError> {
        self.tries = self.tries.saturating_add(1);
        match self.tries < Self::TRIES {
            true => Ok(Turn::Ask),
            false => Err(error),
        }
    }
}
