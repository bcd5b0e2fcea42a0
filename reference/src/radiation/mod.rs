//! Radiation: what is heard beside the modes.

mod acceleration;

pub use acceleration::{Acceleration, add_acceleration_sound};
