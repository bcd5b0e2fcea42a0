#![no_std]
//! Modes and biquads in single precision, as the field ships them, for comparison with the fixed
//! point of `dsp-core`.
//!
//! Nothing that malleus plays uses them. `host-tests` measures their accuracy, its images their
//! cycles on the virtual core.

#[cfg(test)]
extern crate std;

pub mod biquads;
pub mod modal;
