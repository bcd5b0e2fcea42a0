//! Noise: the same numbers from the same seed on every machine.
//!
//! The generator is SFC32 (Chris Doty-Humphrey, PractRand): three words and a counter, about eight
//! cycles a draw, a period of at least 2^32 from every seed. Each stage has a generator of its own,
//! and draws only while it sounds, so that other stages cannot change its noise.

mod sfc32;
mod white;

pub use sfc32::{DEVIATION, Sfc32};
pub use white::{MULTIPLIER, White};
