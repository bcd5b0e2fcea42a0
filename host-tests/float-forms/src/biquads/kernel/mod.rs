//! The hot loop: quads over a run of frames.
//!
//! [`portable`] is the definition of the bits; on a Cortex-M4F assembly computes them
//! (`cortex_m4.s`), compared bit for bit on the virtual core
//! (`cargo test -p host-tests --test on_chip biquads`).

pub mod portable;

#[cfg(cortex_m4f)]
mod cortex_m4;

#[cfg(cortex_m4f)]
pub use cortex_m4::run;
#[cfg(not(cortex_m4f))]
pub use portable::run;
