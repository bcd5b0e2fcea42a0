//! What the program `malleus` is made of: files in, sound and pictures out.
//!
//! The sound itself comes from `dsp-core` (the instrument) or `reference` (the law); here are only the ways to and from it.

pub mod events;

pub mod render;
pub mod wave;
