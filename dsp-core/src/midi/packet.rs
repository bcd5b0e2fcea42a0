//! USB-MIDI event packets (USB Device Class Definition for MIDI Devices 1.0, section 4).

use super::message::{Message, data_bytes};
use super::parser::{Heard, Parser};

/// USB-MIDI event packet: cable and code index number, then up to three MIDI bytes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Packet(pub [u8; 4]);

impl Packet {
    /// Packet of a message on cable 0.
    pub const fn of(message: Message) -> Self {
        let [status, first, second] = message.bytes();
        let code = match status {
            ..0xF0 => status >> 4,
            0xF8.. => 0xF,
            // A system common message of one, two or three bytes.
            _ => match data_bytes(status) {
                0 => 5,
                1 => 2,
                _ => 3,
            },
        };
        Self([code, status, first, second])
    }

    /// Number of the cable, 0 to 15.
    pub const fn cable(self) -> u8 {
        self.0[0] >> 4
    }

    /// Bytes of MIDI in the packet, by its code index number; none for the two reserved codes.
    pub fn bytes(&self) -> &[u8] {
        let count = match self.0[0] & 0xF {
            0x0 | 0x1 => 0,
            0x5 | 0xF => 1,
            0x2 | 0x6 | 0xC | 0xD => 2,
            _ => 3,
        };
        self.0.get(1..1 + count).unwrap_or(&[])
    }
}

/// Parsers of the 16 cables of a USB-MIDI stream.
#[derive(Clone, Copy, Debug, Default)]
pub struct Cables([Parser; 16]);

impl Cables {
    /// Parsers before the first packet.
    pub const fn new() -> Self {
        Self([Parser::new(); 16])
    }

    /// Takes the next packet. A packet of a reserved code is a stray.
    pub fn take(&mut self, packet: Packet, mut tell: impl FnMut(Heard)) {
        let Some(parser) = self.0.get_mut(usize::from(packet.cable())) else { return };
        match packet.bytes() {
            [] => tell(Heard::Stray),
            // A channel message begins with its status byte in each packet.
            [first, ..] if *first < 0x80 && (0x8..=0xE).contains(&(packet.0[0] & 0xF)) => tell(Heard::Stray),
            bytes => bytes.iter().for_each(|&byte| parser.take(byte, &mut tell)),
        }
    }
}
