//! Messages while they are written.

use super::{END, GROUP_BYTES, HEAD_BYTES, MESSAGE_BYTES, PREFIX, PROTOCOL_VERSION, checksum};

/// Message as it is sent: one SysEx from `F0` to `F7`, or nothing.
#[derive(Clone)]
pub struct Message {
    bytes: [u8; MESSAGE_BYTES],
    length: usize,
}

impl Message {
    /// Makes an empty message, of no bytes.
    pub const fn new() -> Self {
        Self { bytes: [0; MESSAGE_BYTES], length: 0 }
    }

    /// Bytes to send; none if the message is empty.
    pub fn bytes(&self) -> &[u8] {
        self.bytes.get(..self.length).unwrap_or_default()
    }

    /// Makes the message empty.
    pub(crate) fn clear(&mut self) {
        self.length = 0;
    }

    /// Begins a message without payload.
    pub(crate) fn begin(&mut self, command: u8, tag: u8) {
        self.length = 0;
        for byte in PREFIX.into_iter().chain([PROTOCOL_VERSION, command & 0x7F, tag & 0x7F]) {
            self.push(byte);
        }
    }

    /// Adds bytes to the payload.
    pub(crate) fn put(&mut self, bytes: &[u8]) {
        for &byte in bytes {
            if (self.length - HEAD_BYTES).is_multiple_of(GROUP_BYTES) {
                self.push(0);
            }
            let place = (self.length - HEAD_BYTES) % GROUP_BYTES;
            if let Some(top_bits) = self.bytes.get_mut(self.length - place) {
                *top_bits |= (byte >> 7) << (place - 1);
            }
            self.push(byte & 0x7F);
        }
    }

    /// Adds the checksum and the message's end.
    pub(crate) fn end(&mut self) {
        for byte in checksum(self.bytes()) {
            self.push(byte);
        }
        self.push(END);
    }

    // No request and no answer is too long (tests/messages.rs).
    fn push(&mut self, byte: u8) {
        if let Some(place) = self.bytes.get_mut(self.length) {
            *place = byte;
            self.length += 1;
        }
    }
}

impl Default for Message {
    fn default() -> Self {
        Self::new()
    }
}
