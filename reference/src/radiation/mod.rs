//! Radiation: what is heard beside the modes.

mod acceleration;

pub use acceleration::add_acceleration_sound;
