//! Radiation: sound that comes from the force itself, not from the modes.

mod acceleration;

pub use acceleration::{Acceleration, add_acceleration_sound};
