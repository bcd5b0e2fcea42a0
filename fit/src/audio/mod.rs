//! Recordings as samples: decoding, choice of a channel, and sample rate.
//!
//! Modes are fitted at the recording's own rate. Only a recording above 48 kHz is decimated, by an
//! integer, so that its rate is at most 48 kHz; nothing is ever resampled by a fraction.

mod decimate;
mod decode;
mod offset;
mod recording;

pub use decode::{read, read_up_to};
pub use recording::{Note, Recording};
