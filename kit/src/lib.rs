//! Tables and kits: their text form (TOML), the binary form that a board plays, and the shipped
//! kits.
//!
//! ```text
//! demo.toml ─┐ text::parse               binary::build         dsp_core::table::Kit,
//! bell.toml ─┴─────────────▶ Kit (owned) ─────────────▶ bytes ─▶ in place, on a board
//!             ◀─────────────             ◀─────────────          or a PC
//!               text::write               binary::read
//! ```
//!
//! [`Kit`] mirrors the keys of the text. Ranges are checked in one place,
//! [`dsp_core::table::Kit::parse`]: each kit that enters or leaves through this crate has been
//! built and read back by the code that the board runs. A refusal is a [`KitError`] with the item's
//! name and, for text, its file and line. `docs/kit-format.md` describes both forms.
//!
//! ```
//! let demo = kit::open("demo")?;
//! let on_board = dsp_core::table::Kit::parse(&demo.binary)?;
//! assert_eq!(on_board.pads().len(), demo.kit.pads.len());
//! assert_eq!(kit::binary::build(&demo.kit)?, demo.binary);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

pub mod binary;
pub mod counting;
pub mod file;
pub mod text;

mod content;
mod error;
mod filters;
mod load;
mod name;
mod nearest;
mod open;
mod shipped;
mod statistics;
mod surface;

pub use content::{
    Acceleration, Background, Gain, Kit, Mode, NoteOff, Object, Pad, Pulse, Residual, RoomBand, Striker,
};
pub use error::{Fault, KitError, Location};
pub use filters::{Biquad, Biquads, Breakpoint, DynamicFilter, Exciter, Loop, ModesGo, Order};
pub use load::{Loaded, load};
pub use name::item_name;
pub use open::open;
pub use shipped::{shipped, shipped_names};
pub use statistics::{BankStatistics, Statistics};
pub use surface::{GRID_POINTS_PER_WAVE, ObjectSurface, Roll, Scrape, Surface};
