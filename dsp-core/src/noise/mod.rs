//! Noise: a seed gives the same numbers on every machine.
//!
//! The generator is SFC32 (Chris Doty-Humphrey, PractRand). It has three words and a counter, takes
//! about eight cycles a draw, and has a period of at least 2^32 from every seed. The dynamic filter
//! draws white noise from a cheaper generator ([`White`]), which SFC32 starts.
//!
//! Each stage has a generator of its own, and draws only while it sounds, so that other stages
//! cannot change its noise.

mod sfc32;
mod white;

pub use sfc32::{DEVIATION, Sfc32};
pub use white::{MULTIPLIER, White};
