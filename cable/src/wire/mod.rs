//! Messages as bytes: their frame, their 7-bit payload, and their checksum.
//!
//! ```text
//! F0 7D 4D version command tag | payload, 7-bit | CRC-32, five 7-bit bytes | F7
//! ```

mod message;
mod payload;
mod receiver;

pub use message::Message;
pub(crate) use payload::Payload;
pub use receiver::{Frame, Heard, Receiver};

/// Most bytes of a message, `F0` and `F7` included. Browsers drop longer ones.
pub const MESSAGE_BYTES: usize = 300;
/// Version of the protocol.
pub const PROTOCOL_VERSION: u8 = 1;

/// First bytes of each message: SysEx, the manufacturer of non-commercial use, and `M`.
const PREFIX: [u8; 3] = [0xF0, 0x7D, 0x4D];
/// Last byte of each message.
const END: u8 = 0xF7;
/// Bytes before the payload.
const HEAD_BYTES: usize = PREFIX.len() + 3;
/// Bytes of the checksum: 32 bits, 7 in each byte.
const CHECKSUM_BYTES: usize = 5;
/// Length of a group of payload bytes: one of top bits, and seven of the lower bits.
const GROUP_BYTES: usize = 8;

/// Checksum of a message's bytes behind `F0`, as the message carries it, the lowest bits first.
fn checksum(bytes: &[u8]) -> [u8; CHECKSUM_BYTES] {
    let crc = dsp_core::table::checksum(bytes.get(1..).unwrap_or_default());
    [0, 7, 14, 21, 28].map(|shift| (crc >> shift) as u8 & 0x7F)
}
