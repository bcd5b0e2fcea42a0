//! The contact between striker and object: its pulse, and its duration from sound alone.

mod from_sound;
mod pulse;

pub use from_sound::{contact_interval_s, contact_time_s};
pub use pulse::{PULSE_FWHM, force, pulse_power};
