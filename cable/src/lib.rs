#![no_std]
//! Kits and settings over the cable: the protocol by SysEx between a board and a computer, both
//! ends, without I/O. `docs/midi-sysex.md` describes each message.

#[cfg(test)]
extern crate std;

mod left_out;
mod refusal;
mod setting;
mod store;
mod text;

pub use left_out::{Lack, LeftOut};
pub use refusal::Refusal;
pub use setting::{Key, SETTINGS_VERSION, Value, ValueRange};
pub use store::{Content, HEADER_BYTES, Identity, Job, Store};
pub use text::Text;
