//! The engine: pads, events and time.
//!
//! ```text
//! caller's block: |----------- 33 frames ------------|
//! ticks:          |     |     every 32 frames, counted from the engine's start
//! events:         |        |  at their frame
//! runs:           [----][--][------][----------------]   what the stages render at once
//! ```
//!
//! A block is cut at ticks and at events, but for those of hands, which act on ticks; all bookkeeping happens on ticks, so that
//! the block size cannot change a bit. What ran and what was skipped in each tick is told by a [`TickReport`].

mod budget;
mod check;
mod cost;
mod error;
mod load;
mod render;
mod report;
mod setup;
mod stage;
mod stages;
mod state;
mod tick;

pub use cost::{CYCLES, Counts, PARTS, Part};
pub use error::LoadError;
pub use load::Plan;
pub use report::TickReport;
pub use setup::{Setup, Skipping};
pub use stage::Stage;
pub use state::{Direct, Engine, STANDARD_CONTACTS};
