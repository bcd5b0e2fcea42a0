//! FIFOs of the USB core: one for all received packets, one for each IN endpoint.

use std::collections::VecDeque;

use super::super::{Access, Problem};

/// Status of an entry of the receive FIFO (GRXSTSP.PKTSTS).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Status {
    OutData = 2,
    OutDone = 3,
    SetupDone = 4,
    Setup = 6,
}

/// Entry of the receive FIFO: a status word, and the words of the packet.
#[derive(Debug, Clone)]
pub(super) struct Entry {
    pub(super) endpoint: usize,
    pub(super) status: Status,
    pub(super) odd: bool,
    pub(super) data: Vec<u8>,
}

impl Entry {
    /// Returns the status word, as in GRXSTSP.
    pub(super) fn word(&self) -> u32 {
        let pid = if self.odd { 2 << 15 } else { 0 };
        self.endpoint as u32 | (self.data.len() as u32) << 4 | pid | (self.status as u32) << 17
    }

    fn words(&self) -> u32 {
        1 + self.data.len().div_ceil(4) as u32
    }
}

/// FIFO of received packets.
#[derive(Debug)]
pub(super) struct Received {
    /// Size in words (GRXFSIZ).
    pub(super) depth: u32,
    entries: VecDeque<Entry>,
    /// Words of the entry whose status has been read.
    words: VecDeque<u32>,
}

impl Default for Received {
    fn default() -> Received {
        Received { depth: 0x200, entries: VecDeque::new(), words: VecDeque::new() }
    }
}

impl Received {
    pub(super) fn is_empty(&self) -> bool {
        self.entries.is_empty()
    }

    /// Returns true if a packet of `bytes` bytes and the status words that follow it have room.
    pub(super) fn has_room(&self, bytes: usize) -> bool {
        let used = self.entries.iter().map(Entry::words).sum::<u32>() + self.words.len() as u32;
        used + 3 + bytes.div_ceil(4) as u32 <= self.depth
    }

    pub(super) fn push(&mut self, endpoint: usize, status: Status, odd: bool, data: &[u8]) {
        self.entries.push_back(Entry { endpoint, status, odd, data: data.to_vec() });
    }

    /// Returns the oldest entry without removing it.
    pub(super) fn peek(&self) -> Option<&Entry> {
        self.entries.front()
    }

    /// Removes and returns the oldest entry, whose data the program reads next.
    pub(super) fn pop(&mut self) -> Access<Entry> {
        if !self.words.is_empty() {
            let reason =
                format!("GRXSTSP is read while the last packet has unread words, {} of them", self.words.len());
            return Err(Problem::Misuse { reason });
        }
        let Some(entry) = self.entries.pop_front() else {
            let reason = "GRXSTSP is read while the receive FIFO is empty; wait for GINTSTS.RXFLVL".to_owned();
            return Err(Problem::Misuse { reason });
        };
        self.words.extend(entry.data.chunks(4).map(word));
        Ok(entry)
    }

    /// Removes and returns a word of the packet whose status was read last.
    pub(super) fn read(&mut self) -> Access<u32> {
        self.words.pop_front().ok_or_else(|| Problem::Misuse {
            reason: "the receive FIFO is read beyond the end of the packet that GRXSTSP told".to_owned(),
        })
    }

    pub(super) fn flush(&mut self) {
        self.entries.clear();
        self.words.clear();
    }
}

/// Returns up to four bytes as a word.
fn word(bytes: &[u8]) -> u32 {
    bytes.iter().rev().fold(0, |word, &byte| word << 8 | u32::from(byte))
}

/// FIFO of an IN endpoint.
#[derive(Debug)]
pub(super) struct Transmit {
    /// First word in the shared memory, and size in words.
    pub(super) start: u32,
    pub(super) depth: u32,
    words: VecDeque<u32>,
}

impl Transmit {
    pub(super) fn new(index: usize) -> Transmit {
        let start = 0x200 + 0x200 * index as u32;
        Transmit { start, depth: 0x200, words: VecDeque::new() }
    }

    pub(super) fn free_words(&self) -> u32 {
        self.depth.saturating_sub(self.words.len() as u32)
    }

    pub(super) fn write(&mut self, word: u32) -> Access<()> {
        if self.free_words() == 0 {
            let reason = format!("a transmit FIFO of {} words is written while it is full", self.depth);
            return Err(Problem::Misuse { reason });
        }
        self.words.push_back(word);
        Ok(())
    }

    /// Returns the first `bytes` bytes, or `None` if the program has not written them yet.
    pub(super) fn peek(&self, bytes: usize) -> Option<Vec<u8>> {
        let mut data: Vec<u8> = self.words.iter().take(bytes.div_ceil(4)).flat_map(|word| word.to_le_bytes()).collect();
        data.truncate(bytes);
        (data.len() == bytes).then_some(data)
    }

    /// Removes the words of `bytes` bytes.
    pub(super) fn remove(&mut self, bytes: usize) {
        self.words.drain(..bytes.div_ceil(4).min(self.words.len()));
    }

    pub(super) fn flush(&mut self) {
        self.words.clear();
    }
}
