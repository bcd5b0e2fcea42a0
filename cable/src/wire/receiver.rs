//! Messages out of a stream of MIDI bytes.

use super::{CHECKSUM_BYTES, END, GROUP_BYTES, HEAD_BYTES, MESSAGE_BYTES, PREFIX, PROTOCOL_VERSION, checksum};
use crate::refusal::Refusal;

/// Message that arrived whole.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Frame<'a> {
    /// Number of the command.
    pub command: u8,
    /// Tag of the request, which its answer repeats.
    pub tag: u8,
    /// Payload, as 8-bit bytes.
    pub payload: &'a [u8],
}

/// Result of one more byte.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Heard<'a> {
    /// No message ends here.
    Nothing,
    /// A message arrived whole.
    Message(Frame<'a>),
    /// A message of this protocol cannot be read.
    Broken {
        /// Number of the command, as far as the message can be trusted.
        command: u8,
        /// Tag, as far as the message can be trusted.
        tag: u8,
        /// Reason for which the message cannot be read.
        refusal: Refusal,
    },
}

/// Receiver of messages out of a stream of MIDI bytes.
///
/// Real-time bytes are left out wherever they stand, and so are all messages that are not of this
/// protocol. A cut or oversized message is [`Heard::Broken`], and the next one arrives.
#[derive(Clone)]
pub struct Receiver {
    bytes: [u8; MESSAGE_BYTES],
    length: usize,
    is_inside: bool,
    is_too_long: bool,
}

impl Receiver {
    /// Makes a receiver that waits for a message's first byte.
    pub const fn new() -> Self {
        Self { bytes: [0; MESSAGE_BYTES], length: 0, is_inside: false, is_too_long: false }
    }

    /// Takes one byte of the stream.
    pub fn receive(&mut self, byte: u8) -> Heard<'_> {
        match byte {
            0xF8.. => Heard::Nothing,
            END => self.end(),
            0x80.. => {
                let cut = self.is_inside;
                let (command, tag) = self.command_and_tag();
                let is_ours = cut && self.length >= HEAD_BYTES;
                self.begin(byte);
                match is_ours {
                    true => Heard::Broken { command, tag, refusal: Refusal::CutMessage },
                    false => Heard::Nothing,
                }
            }
            _ => {
                if self.is_inside {
                    self.push(byte);
                    self.is_inside = self.length > PREFIX.len() || PREFIX.starts_with(self.held());
                }
                Heard::Nothing
            }
        }
    }

    /// Drops the message under way, such as after the cable was unplugged.
    pub fn reset(&mut self) {
        self.is_inside = false;
    }

    fn begin(&mut self, byte: u8) {
        (self.length, self.is_too_long) = (0, false);
        self.is_inside = byte == PREFIX[0];
        self.push(byte);
    }

    fn push(&mut self, byte: u8) {
        match self.bytes.get_mut(self.length) {
            Some(place) => {
                *place = byte;
                self.length += 1;
            }
            None => self.is_too_long = true,
        }
    }

    fn held(&self) -> &[u8] {
        self.bytes.get(..self.length).unwrap_or_default()
    }

    fn command_and_tag(&self) -> (u8, u8) {
        let [.., command, tag] = *self.bytes.first_chunk::<HEAD_BYTES>().unwrap_or(&[0; HEAD_BYTES]);
        (command, tag)
    }

    fn end(&mut self) -> Heard<'_> {
        if !core::mem::take(&mut self.is_inside) || self.length < HEAD_BYTES {
            return Heard::Nothing;
        }
        // The end counts as well.
        self.push(END);
        let (command, tag) = self.command_and_tag();
        match self.unpack() {
            Ok(payload) => Heard::Message(Frame { command, tag, payload }),
            Err(refusal) => Heard::Broken { command, tag, refusal },
        }
    }

    /// Checks the message and turns its payload into 8-bit bytes, in place.
    fn unpack(&mut self) -> Result<&[u8], Refusal> {
        if self.is_too_long {
            return Err(Refusal::LongMessage);
        }
        let end = self.length.checked_sub(CHECKSUM_BYTES + 1).filter(|&end| end >= HEAD_BYTES);
        let end = end.ok_or(Refusal::DamagedMessage)?;
        let (checked, rest) = self.bytes.split_at_mut_checked(end).ok_or(Refusal::DamagedMessage)?;
        if !rest.starts_with(&checksum(checked)) {
            return Err(Refusal::DamagedMessage);
        }
        // Behind the checksum, because a damaged version is no other version.
        let version = checked.get(PREFIX.len()).copied().unwrap_or_default();
        if version != PROTOCOL_VERSION {
            return Err(Refusal::OtherProtocol { found: version });
        }
        let packed = checked.get_mut(HEAD_BYTES..).unwrap_or_default();
        if packed.len() % GROUP_BYTES == 1 {
            return Err(Refusal::BadMessage);
        }
        let mut top_bits = 0;
        let mut length = 0;
        for index in 0..packed.len() {
            let byte = packed.get(index).copied().unwrap_or_default();
            match index % GROUP_BYTES {
                0 => top_bits = byte,
                place => {
                    if let Some(to) = packed.get_mut(length) {
                        *to = byte | (top_bits >> (place - 1)) << 7;
                    }
                    length += 1;
                }
            }
        }
        Ok(packed.get(..length).unwrap_or_default())
    }
}

impl Default for Receiver {
    fn default() -> Self {
        Self::new()
    }
}
