//! The engine: plays the pads of a kit by events, in blocks of any length.
//!
//! ```text
//! caller's block: |----------- 33 frames ------------|
//! ticks:          |     |     every 32 frames, counted from the engine's start
//! events:         |        |  at their frame
//! runs:           [----][--][------][----------------]   rendered by all stages at once
//! ```
//!
//! A block is cut into runs at ticks and at events. Chokes and releases cut nothing: they act at
//! the tick behind them. All bookkeeping happens at ticks, so that the block size cannot change a
//! bit. A [`TickReport`] tells what ran and what was skipped in each tick.

mod awake;
mod budget;
mod check;
mod cost;
mod error;
mod fader;
mod held;
mod load;
mod load_modes;
mod moving;
mod plan;
mod postpone;
mod prediction;
mod render;
mod report;
mod scrapes;
#[cfg_attr(not(feature = "scrapes"), allow(dead_code, unused_variables))] // no event leads there
mod scraping;
mod setup;
mod shedding;
mod silence;
mod stage;
mod stages;
mod state;
mod tick;

pub use cost::{COST_ITEMS, CYCLES, CostItem, Counts};
pub use error::LoadError;
pub use fader::{END_S, LEVEL_S};
pub use plan::Plan;
pub use report::TickReport;
pub use scrapes::STANDARD_SCRAPES;
pub use setup::{Setup, Skipping};
pub use stage::Stage;
pub use state::{Direct, Engine, STANDARD_CONTACTS};
