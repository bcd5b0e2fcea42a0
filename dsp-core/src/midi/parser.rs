//! Parser of one MIDI stream: from bytes to messages.

use super::message::{Message, data_bytes};

/// Thing that a parser has heard.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Heard {
    /// A whole message other than SysEx.
    Message(Message),
    /// A SysEx begins.
    SysexBegins,
    /// The next byte of a SysEx, 0 to 127.
    SysexByte(u8),
    /// The SysEx ends, whole.
    SysexEnds,
    /// The SysEx ends without its last byte: another message has begun.
    SysexCut,
    /// A message ends without all of its data, or a byte belongs to no message.
    Stray,
}

/// Parser of one MIDI stream.
///
/// It follows the MIDI 1.0 specification: running status, real-time bytes inside other messages and
/// inside SysEx, system messages that end running status. State: four bytes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Parser {
    /// Status byte that data bytes belong to; 0 if there is none.
    status: u8,
    /// First data byte, once it has come.
    first: u8,
    /// Number of data bytes that have come.
    count: u8,
    is_in_sysex: bool,
}

impl Parser {
    /// A parser before the first byte.
    pub const fn new() -> Self {
        Self { status: 0, first: 0, count: 0, is_in_sysex: false }
    }

    /// Takes the next byte. `tell` gets up to two things: the end of what was cut, and what the
    /// byte makes.
    pub fn take(&mut self, byte: u8, mut tell: impl FnMut(Heard)) {
        match byte {
            // Real-time bytes come between the bytes of other messages and change nothing.
            0xF9 | 0xFD => tell(Heard::Stray),
            0xF8.. => tell(Heard::Message(Message::System { status: byte, data: [0; 2] })),
            0x80.. => self.begin(byte, tell),
            _ if self.is_in_sysex => tell(Heard::SysexByte(byte)),
            _ if self.status == 0 => tell(Heard::Stray),
            _ => self.take_data(byte, tell),
        }
    }

    /// Begins the message of a status byte.
    fn begin(&mut self, status: u8, mut tell: impl FnMut(Heard)) {
        let was_in_sysex = core::mem::take(&mut self.is_in_sysex);
        match (was_in_sysex, status, self.count) {
            (true, 0xF7, _) => tell(Heard::SysexEnds),
            (true, _, _) => tell(Heard::SysexCut),
            (_, _, 1..) => tell(Heard::Stray),
            _ => {}
        }
        (self.status, self.count) = (0, 0);
        match status {
            0xF0 => {
                self.is_in_sysex = true;
                tell(Heard::SysexBegins);
            }
            0xF6 => tell(Heard::Message(Message::System { status, data: [0; 2] })),
            0xF7 if was_in_sysex => {}
            0xF4 | 0xF5 | 0xF7 => tell(Heard::Stray),
            _ => self.status = status,
        }
    }

    fn take_data(&mut self, byte: u8, mut tell: impl FnMut(Heard)) {
        let data = match (data_bytes(self.status), self.count) {
            (1, _) => [byte, 0],
            (_, 0) => {
                (self.first, self.count) = (byte, 1);
                return;
            }
            _ => [self.first, byte],
        };
        tell(Heard::Message(Message::new(self.status, data)));
        self.count = 0;
        // Only channel messages may go on with running status.
        if self.status >= 0xF0 {
            self.status = 0;
        }
    }
}
