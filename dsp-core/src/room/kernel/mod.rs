//! The room's hot loops: splits, networks of 16-bit lines, doubled rates. [`portable`] is the
//! definition of the bits. On a Cortex-M4F assembly replaces it (`cortex_m4/*.s`), which tests
//! compare with it bit for bit on the virtual core
//! (`cargo test -p host-tests --test on_chip room`).

pub(super) mod portable;

#[cfg(cortex_m4f)]
mod cortex_m4;

#[cfg(cortex_m4f)]
pub(super) use cortex_m4::{double, exchange, network, scale, split};
#[cfg(not(cortex_m4f))]
pub(super) use portable::{double, exchange, network, scale, split};
