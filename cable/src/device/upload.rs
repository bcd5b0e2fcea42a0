//! Uploads as the board sees them.

use dsp_core::table::TableError;
use dsp_core::table::checksum;
use dsp_core::table::layout::{FORMAT_VERSION, MAGIC};

use crate::answer::{Answer, Progress};
use crate::refusal::Refusal;
use crate::request::CHUNK_BYTES;
use crate::store::{Content, HEADER_BYTES, Store};

/// Upload that a computer has begun.
#[derive(Clone, Copy)]
pub(super) struct Upload {
    pub(super) session: u32,
    pub(super) slot: u8,
    pub(super) header: [u8; HEADER_BYTES],
    /// Number of the chunk that comes next.
    next: u16,
    /// CRC-32 of the last chunk that was written.
    last_crc: u32,
}

impl Upload {
    /// Begins an upload, if the slot can take a kit with this header.
    pub(super) fn begin(session: u32, slot: u8, header: [u8; HEADER_BYTES], capacity: usize) -> Result<Self, Refusal> {
        let upload = Self { session, slot, header, next: 0, last_crc: 0 };
        let [magic, version, _, _] = *header.as_chunks().0 else { return Err(Refusal::NotAKit) };
        let version = u32::from_le_bytes(version);
        match magic == MAGIC && upload.length() >= HEADER_BYTES {
            false => Err(Refusal::NotAKit),
            true if version != FORMAT_VERSION => Err(TableError::NewerVersion { found: version }.into()),
            true if upload.length() > capacity => {
                Err(Refusal::TooLong { length: upload.length() as u32, capacity: capacity as u32 })
            }
            true => Ok(upload),
        }
    }

    /// True if the request that began the upload had these words.
    pub(super) fn is(&self, session: u32, slot: u8, header: &[u8; HEADER_BYTES]) -> bool {
        self.session == session && self.slot == slot && self.header == *header
    }

    /// Progress of the upload, as the computer is told.
    pub(super) fn progress(&self) -> Progress {
        Progress { session: self.session, slot: self.slot, next: self.next, chunks: self.chunks() }
    }

    /// Writes the chunk that comes next, or tells the computer that the last one is written.
    ///
    /// [`Refusal::Flash`] ends the upload, because flash takes each byte once.
    pub(super) fn write<S: Store>(
        &mut self,
        number: u16,
        bytes: &[u8],
        store: &mut S,
    ) -> Result<Answer<'static>, Refusal> {
        let crc = checksum(bytes);
        let (found, expected) = (u32::from(number), u32::from(self.next));
        // The computer sends the last chunk again if it did not hear that it is written.
        if found + 1 == expected && crc == self.last_crc {
            return Ok(Answer::Written { number, crc });
        }
        if found < expected {
            return Err(Refusal::ChunkTwice { found, expected });
        }
        if found > expected || self.next == self.chunks() {
            return Err(Refusal::ChunkOutOfOrder { found, expected });
        }
        let offset = HEADER_BYTES + usize::from(number) * CHUNK_BYTES;
        if bytes.len() != CHUNK_BYTES.min(self.length().saturating_sub(offset)) {
            return Err(Refusal::BadMessage);
        }
        store.write(self.slot, offset, bytes)?;
        (self.next, self.last_crc) = (number + 1, crc);
        Ok(Answer::Written { number, crc })
    }

    /// Refuses to end an upload before its last chunk.
    pub(super) fn check_whole(&self) -> Result<(), Refusal> {
        match self.next == self.chunks() {
            true => Ok(()),
            false => Err(Refusal::ChunksMissing { expected: u32::from(self.next), chunks: u32::from(self.chunks()) }),
        }
    }

    /// Checks the kit in the flash, writes its header, checks all of it, and makes it the slot's.
    ///
    /// The magic is written last of all: before that, the flash holds no kit at any start.
    pub(super) fn finish<S: Store>(&self, store: &mut S) -> Result<(), Refusal> {
        let body = store.uploaded(self.slot).and_then(|bytes| bytes.get(HEADER_BYTES..self.length()));
        let (stored, computed) = (self.word(3), checksum(body.unwrap_or_default()));
        if stored != computed {
            return Err(Refusal::WrongCrc { stored, computed });
        }
        let (magic, rest) = self.header.split_at(MAGIC.len());
        store.write(self.slot, MAGIC.len(), rest)?;
        store.write(self.slot, 0, magic)?;
        match store.content(store.uploaded(self.slot).unwrap_or_default(), &mut |_| {}) {
            Content::Kit { .. } => store.commit(self.slot),
            Content::Refused(refusal) => Err(refusal),
            Content::Empty | Content::Unfinished => Err(Refusal::Flash { offset: 0 }),
        }
    }

    fn word(&self, index: usize) -> u32 {
        self.header.as_chunks().0.get(index).copied().map_or(0, u32::from_le_bytes)
    }

    fn length(&self) -> usize {
        self.word(2) as usize
    }

    fn chunks(&self) -> u16 {
        // The capacity of a slot is far below 65 535 chunks (15 MB).
        self.length().saturating_sub(HEADER_BYTES).div_ceil(CHUNK_BYTES) as u16
    }
}
