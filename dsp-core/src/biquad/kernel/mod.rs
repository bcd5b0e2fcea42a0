//! The hot loops: all sections of a bank over a run of frames.
//!
//! [`portable`] is the definition of the bits; on a Cortex-M4F the same is done by assembly (`cortex_m4.s`), compared bit for bit on
//! the virtual core (`cargo test -p host-tests --test virtual_biquads`).

pub mod portable;

#[cfg(cortex_m4f)]
mod cortex_m4;

#[cfg(cortex_m4f)]
pub use cortex_m4::run;
#[cfg(not(cortex_m4f))]
pub use portable::run;

use crate::resonator::TICK_FRAMES;

/// What goes through a bank's sections in a run.
#[derive(Clone, Debug)]
#[repr(C)]
pub struct Signals {
    /// The input.
    pub input: [i32; TICK_FRAMES],
    /// The input with the sign of every odd frame (counted from the bank's start) changed.
    pub alternating: [i32; TICK_FRAMES],
    /// What a chain's sections hand on.
    pub chain: [i32; TICK_FRAMES],
    /// The sum of all chains; a run adds to it.
    pub mix: [i32; TICK_FRAMES],
    /// The sum of those whose output has alternating sign.
    pub alternating_mix: [i32; TICK_FRAMES],
}

impl Signals {
    /// Nothing.
    pub const SILENT: Self = Self {
        input: [0; TICK_FRAMES],
        alternating: [0; TICK_FRAMES],
        chain: [0; TICK_FRAMES],
        mix: [0; TICK_FRAMES],
        alternating_mix: [0; TICK_FRAMES],
    };
}
