//! The binary form of a kit: a board has it in flash, and [`dsp_core::table`] reads it in place.

mod build;
mod builder;
mod filters;
mod map;
mod noise;
mod read;
mod slopes;
mod surface;
mod waves;

pub use build::build;
pub use read::read;
