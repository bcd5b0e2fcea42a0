//! The hot loops: all pairs of a bank over a run of frames.
//!
//! In each frame a pair is mixed, stepped and driven. [`portable`] defines the bits. On a
//! Cortex-M4F assembly (`cortex_m4.s`) does the work, compared with it bit for bit on the virtual
//! core (`cargo test -p host-tests --test on_chip biquads`).

pub mod parameters;
pub mod portable;

#[cfg(cortex_m4f)]
mod cortex_m4;

pub use parameters::{ALLOWANCE, Outcome, Run};

#[cfg(cortex_m4f)]
pub use cortex_m4::run;
#[cfg(not(cortex_m4f))]
pub use portable::run;
