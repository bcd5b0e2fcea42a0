#![no_std]
//! Kits and settings over the cable: the protocol by SysEx between a board and a computer, both
//! ends, without I/O. `docs/midi-sysex.md` describes each message.
//!
//! ```text
//! computer                                                        board
//! Upload, Download, Query ── Exchange ── SysEx ── Device ── Store
//! (what to ask next)         (tags, tries)        (upload)  (flash, settings, engine)
//! ```

#[cfg(test)]
extern crate std;

mod answer;
mod device;
mod host;
mod left_out;
mod refusal;
mod request;
mod setting;
mod store;
mod text;
mod wire;

pub use answer::{Answer, LeftOuts, Progress};
pub use device::{Device, Outcome};
pub use host::{Download, Exchange, HostError, Link, Next, Query, Task, Turn, Upload, converse};
pub use left_out::{Lack, LeftOut};
pub use refusal::Refusal;
pub use request::{CHUNK_BYTES, Request};
pub use setting::{Key, SETTINGS_VERSION, Value, ValueRange};
pub use store::{Content, HEADER_BYTES, Identity, Job, Store};
pub use text::Text;
pub use wire::{Frame, Heard, MESSAGE_BYTES, Message, PROTOCOL_VERSION, Receiver};
