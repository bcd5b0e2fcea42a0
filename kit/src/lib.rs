//! Tables and kits: as text (TOML) and as the binary that a board plays, checking, and the kits that ship with Malleus.
//!
//! ```text
//! demo.toml ─┐ text::parse                 binary::build
//! bell.toml ─┴────────────▶ Kit (owned) ─────────────────▶ bytes ─▶ dsp_core::table::Kit, in place, on a board or a PC
//!            ◀────────────             ◀─────────────────
//!              text::write                  binary::read
//! ```
//!
//! [`Kit`] mirrors the text's keys. What a number may be is judged in one place, [`dsp_core::table::Kit::parse`]: whatever
//! enters or leaves through this crate has been built and read back by the code that the board runs, and what it
//! refuses comes back as a [`KitError`] with the item's name and, for text, its file and line. `docs/kit-format.md` describes
//! both forms.
//!
//! ```
//! let demo = kit::open("demo")?;
//! let on_board = dsp_core::table::Kit::parse(&demo.binary)?;
//! assert_eq!(on_board.pads().len(), demo.kit.pads.len());
//! assert_eq!(kit::binary::build(&demo.kit)?, demo.binary);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

pub mod binary;
pub mod file;
pub mod text;

mod content;
mod error;
mod filters;
mod load;
mod nearest;
mod shipped;
mod statistics;

pub use content::{Acceleration, Background, Gain, Kit, Mode, Object, Pad, Pulse, Residual, RoomBand, Striker};
pub use error::{Fault, KitError, Location};
pub use filters::{Biquad, Biquads, Breakpoint, DynamicFilter, Exciter, Loop, ModesGo, Order};
pub use load::{Loaded, load, open};
pub use shipped::{shipped, shipped_names};
pub use statistics::{BankStatistics, Statistics};
