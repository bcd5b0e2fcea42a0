//! What the program `malleus` is made of: files in, sound and pictures out.
//!
//! The sound itself comes from `dsp-core` (the instrument) or `reference` (the law); here are only the ways to and from it.

pub mod demo;
pub mod events;
pub mod loudness;
pub mod plot;
pub mod render;
pub mod report;
pub mod wave;
