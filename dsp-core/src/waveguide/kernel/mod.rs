//! The hot loops: all band-passes over a run of frames.
//!
//! [`portable`] is the definition of the bits; on a Cortex-M4F the same is done by assembly
//! (`cortex_m4.s`), compared bit for bit on the virtual core (`cargo test -p host-tests --test
//! on_chip filters`).

pub(super) mod portable;

#[cfg(cortex_m4f)]
mod cortex_m4;

#[cfg(cortex_m4f)]
pub(super) use cortex_m4::{run, run_on_noise};
#[cfg(not(cortex_m4f))]
pub(super) use portable::{run, run_on_noise};
