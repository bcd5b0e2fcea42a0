//! MIDI: from bytes or USB packets to events, and from strikes to packets.
//!
//! ```text
//! bytes ──► Parser ──┐
//!                    ├─► Message ──► Keyboard ──► Event ──► engine
//! Packet ─► Cables ──┘                  │
//!                                       └─ notes that the host holds
//! Event of a piezo or a button ──► MidiOut ──► Packet
//! ```
//!
//! `malleus play FILE.mid` and the boards map messages by the same [`Keyboard`], so a song sounds
//! alike on both. docs/midi.md says which message does what.
//!
//! No state depends on the length of a message: SysEx passes through byte by byte. After any
//! damage the stream is in step again with the next status byte, at most one message later.

mod keyboard;
mod message;
mod out;
mod packet;
mod parser;

#[cfg(test)]
mod tests;

pub use keyboard::{Keyboard, Outcome};
pub use message::Message;
pub use out::MidiOut;
pub use packet::{Cables, Packet};
pub use parser::{Heard, Parser};
