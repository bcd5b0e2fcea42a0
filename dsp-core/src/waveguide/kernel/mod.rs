//! The hot loops: all band-passes over a run of frames.
//!
//! [`portable`] defines the bits. A Cortex-M4F runs assembly instead (`cortex_m4.s`). A test on the
//! virtual core compares the two bit for bit (`cargo test -p host-tests --test on_chip filters`).

pub(super) mod portable;

#[cfg(cortex_m4f)]
mod cortex_m4;

#[cfg(cortex_m4f)]
pub(super) use cortex_m4::{run, run_on_noise};
#[cfg(not(cortex_m4f))]
pub(super) use portable::{run, run_on_noise};
