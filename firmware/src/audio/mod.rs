//! Sound: while one half of the DMA buffer plays, the interrupt of the DMA renders the other.
//!
//! ```text
//! DMA reads    |------- half 0 -------|------- half 1 -------|
//! interrupt                           ^ inputs up to now are taken, a tick is rendered ...
//! tick         |--- ... ---|---- rendered before ----|---- ... to be heard from here
//!                                     |LEAD_FRAMES-->|
//! ```
//!
//! A tick of the engine lies across the halves. It is heard `LEAD_FRAMES` after the interrupt
//! that renders it, which is the deadline. A lead of less than a half shortens the time from a
//! strike to its sound; the engine's budget leaves the rest of the time to other tasks anyway.

mod fade;
mod hush;
pub mod i2s;
pub mod instrument;
mod interrupt;
pub mod midi;
mod programs;
mod waiting;

pub use hush::{Hushed, hush, wait_for_gap};
pub use interrupt::{BUDGET_CYCLES, CYCLES_PER_HALF, Line, Log, start};
pub use programs::take_program;
