//! Downloads: a slot's kit, read chunk by chunk.

use super::{HostError, Next, Task};
use crate::answer::Answer;
use crate::refusal::Refusal;
use crate::request::Request;
use crate::store::Content;

/// Task that reads the bytes of a kit.
///
/// After a break a new task goes on behind the bytes that the old one has read.
pub struct Download<'b> {
    slot: u8,
    kit: &'b mut [u8],
    read: usize,
}

impl<'b> Download<'b> {
    /// Makes a task that reads a slot's first bytes into `kit`, of which the first `read` are there
    /// already.
    pub fn new(slot: u8, kit: &'b mut [u8], read: usize) -> Self {
        Self { slot, kit, read }
    }

    /// Number of bytes that are read.
    pub fn read(&self) -> usize {
        self.read
    }

    /// Length of the kit in a slot, as the board tells the slot's content.
    ///
    /// # Errors
    /// [`HostError::Refused`] if the slot holds no kit.
    pub fn length(slot: u8, content: Content) -> Result<usize, HostError> {
        match content {
            Content::Kit { length, .. } => Ok(length as usize),
            Content::Refused(refusal) => Err(HostError::Refused(refusal)),
            Content::Empty | Content::Unfinished => Err(HostError::Refused(Refusal::EmptySlot { slot })),
        }
    }
}

impl Task for Download<'_> {
    fn request(&self) -> Request<'_> {
        Request::Read { slot: self.slot, offset: self.read as u32 }
    }

    fn answer(&mut self, answer: Answer<'_>) -> Result<Next, HostError> {
        let Answer::Bytes { slot, offset, bytes } = answer else { return Err(HostError::BadAnswer) };
        let is_next = slot == self.slot && offset as usize == self.read;
        let left = self.kit.get_mut(self.read..).unwrap_or_default();
        if !is_next || (bytes.is_empty() && !left.is_empty()) {
            return Err(HostError::BadAnswer);
        }
        let count = bytes.len().min(left.len());
        for (to, &from) in left.iter_mut().zip(bytes) {
            *to = from;
        }
        self.read += count;
        Ok(if self.read < self.kit.len() { Next::Ask } else { Next::Done })
    }
}
