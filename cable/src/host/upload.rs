//! Uploads: a kit, written chunk by chunk.

use dsp_core::table::checksum;

use super::{HostError, Next, Task};
use crate::answer::{Answer, Progress};
use crate::refusal::Refusal;
use crate::request::{CHUNK_BYTES, Request};
use crate::store::HEADER_BYTES;

/// Task that writes a kit to a slot.
///
/// After a break a new task with the same kit, slot and session goes on where the board stands.
pub struct Upload<'k> {
    kit: &'k [u8],
    header: [u8; HEADER_BYTES],
    slot: u8,
    session: u32,
    step: Step,
    /// Number of answers that sent the upload back.
    setbacks: u8,
}

#[derive(Clone, Copy, PartialEq)]
enum Step {
    Begin,
    Chunk(u16),
    End,
}

impl<'k> Upload<'k> {
    /// Most answers that may send the upload back, such as after a reset of the board.
    const SETBACKS: u8 = 16;

    /// Makes a task that writes a kit.
    ///
    /// The session is the kit's own CRC-32, so that a program that is started anew goes on with the
    /// upload that it left.
    ///
    /// # Errors
    /// [`Refusal::NotAKit`] if there are fewer bytes than a header.
    pub fn new(kit: &'k [u8], slot: u8) -> Result<Self, HostError> {
        let header = *kit.first_chunk().ok_or(HostError::Refused(Refusal::NotAKit))?;
        let session = checksum(kit);
        Ok(Self { kit, header, slot, session, step: Step::Begin, setbacks: 0 })
    }

    /// Number of the kit's bytes that the board has written.
    pub fn written(&self) -> usize {
        match self.step {
            Step::Begin => 0,
            Step::Chunk(number) => HEADER_BYTES + usize::from(number) * CHUNK_BYTES,
            Step::End => self.kit.len(),
        }
    }

    fn chunk(&self, number: u16) -> Option<&'k [u8]> {
        self.kit.get(HEADER_BYTES..)?.chunks(CHUNK_BYTES).nth(usize::from(number))
    }

    /// Goes on with a chunk, or with the end behind the last one.
    fn go_on_with(&mut self, number: u16) -> Next {
        self.step = match self.chunk(number) {
            Some(_) => Step::Chunk(number),
            None => Step::End,
        };
        Next::Ask
    }
}

impl Task for Upload<'_> {
    fn request(&self) -> Request<'_> {
        let session = self.session;
        match self.step {
            Step::Begin => Request::Begin { session, slot: self.slot, header: self.header },
            Step::Chunk(number) => Request::Chunk { session, number, bytes: self.chunk(number).unwrap_or_default() },
            Step::End => Request::End { session },
        }
    }

    fn answer(&mut self, answer: Answer<'_>) -> Result<Next, HostError> {
        match (self.step, answer) {
            (Step::Begin, Answer::Upload(Some(Progress { session, next, .. }))) if session == self.session => {
                Ok(self.go_on_with(next))
            }
            (Step::Chunk(sent), Answer::Written { number, crc })
                if number == sent && Some(crc) == self.chunk(sent).map(checksum) =>
            {
                Ok(self.go_on_with(sent + 1))
            }
            (Step::End, Answer::Done) => Ok(Next::Done),
            _ => Err(HostError::BadAnswer),
        }
    }

    fn refused(&mut self, refusal: Refusal) -> Result<Next, HostError> {
        self.setbacks = self.setbacks.saturating_add(1);
        if self.setbacks > Self::SETBACKS {
            return Err(HostError::Refused(refusal));
        }
        match refusal {
            Refusal::ChunkOutOfOrder { expected, .. }
            | Refusal::ChunkTwice { expected, .. }
            | Refusal::ChunksMissing { expected, .. } => {
                Ok(self.go_on_with(u16::try_from(expected).map_err(|_| HostError::BadAnswer)?))
            }
            // The board was reset, or another program abandoned the upload.
            Refusal::NoUpload if self.step != Step::Begin => {
                self.step = Step::Begin;
                Ok(Next::Ask)
            }
            _ => Err(HostError::Refused(refusal)),
        }
    }
}
