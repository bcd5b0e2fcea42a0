//! The binary form of a kit: a board has it in flash, and [`dsp_core::table`] reads it in place.

mod build;
mod builder;
mod filters;
mod noise;
mod read;

pub use build::build;
pub use read::read;
