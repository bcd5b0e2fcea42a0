//! Run time against error: kernels and rivals on the virtual core and on the PC.

pub mod chip;
pub mod rivals;
pub mod rows;
mod words;
