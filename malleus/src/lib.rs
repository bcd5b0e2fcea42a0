//! The parts of the program `malleus`: files are read, sound and pictures are written.
//!
//! The sound itself comes from `dsp-core`, the instrument that a board runs, or from `reference`,
//! the same model in `f64`. This crate only reads, renders through one of the two, and writes.

pub mod csv_text;
pub mod demo;
pub mod events;
pub mod loudness;
pub mod motion;
pub mod plot;
pub mod render;
pub mod report;
pub mod study;
pub mod wave;
