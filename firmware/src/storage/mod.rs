//! Kits and settings in the flash of the chip, which outlive a restart.
//!
//! ```text
//! state      what there is of it, and which kit plays
//! flash      erases sectors and programs words between two interrupts of the sound
//! settings   values that go before those of the kit, and the place of each slot
//! slots      kits: which sector belongs to which slot, uploads, erases
//! player     the kit that plays: at the start, and in place of another
//! board      all of it as the cable asks for it
//! ```
//!
//! The core runs from the flash that is written, so that each access waits until an operation is
//! over: a word for up to 0.1 ms, a sector for up to 2 s. The sound goes on while words are
//! programmed. Before a sector is erased it fades out ([`audio::hush`](crate::audio::hush)).

mod board;
mod flash;
mod player;
mod settings;
mod slots;
mod state;

pub use player::Started;
pub use state::Storage;
