//! The loops of the transform over butterflies of radix 4.

#[cfg(cortex_m4f)]
mod cortex_m4;
#[cfg(not(cortex_m4f))]
mod portable;

#[cfg(cortex_m4f)]
pub(super) use cortex_m4::{last_pass, pass};
#[cfg(not(cortex_m4f))]
pub(super) use portable::{last_pass, pass};
