//! The binary form: what lies in a board's flash and what [`dsp_core::table`] reads in place.

mod build;
mod filters;
mod read;

pub use build::build;
pub use read::read;
