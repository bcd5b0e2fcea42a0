//! Tables: a kit's bytes, which a fit or a text produces and a board plays, read in place.
//!
//! A kit is one block of bytes, in flash or in a file:
//!
//! ```text
//! header    magic "MALL", format version, length, CRC-32 of all that follows
//! directory number of sections, then an entry for each: tag, version, offset, length
//! sections  one of each:               META PADS
//!           one for each:              OBJT (objects), STRK (strikers)
//!           at most one for an object: resi dynf biqd
//!           one for each:              surf (surfaces)
//!           at most one of each:       trig bgnd room rest bala head osur scrp roll
//! ```
//!
//! All numbers are little-endian, floats are IEEE single precision. Sections are 4-byte aligned and
//! tile the kit without gaps. Bytes behind `length` must be erased flash (0xFF). The records stand
//! in [`layout`], the valid ranges in [`range`].
//!
//! [`Kit::parse`] checks every length, index, name and float once and then hands out views without
//! copying. Each refusal is a [`TableError`] that tells the field, its place, and what is allowed.
//! The sections `dynf` and `biqd` serve stages that few engines have, and `parse` skips them:
//! [`Kit::dynamic_filters`] and [`Kit::biquads`] check them for an engine that plays them. So does
//! [`Kit::check_surfaces`] for `surf`, `osur`, `scrp` and `roll`.
//!
//! A new stage is a new section. As in PNG, a reader may skip a section that it does not know if
//! its tag begins with a lower-case letter. It refuses any other unknown tag, and a newer version
//! of a known section, by name.

mod balance;
mod biquads;
mod check;
mod checksum;
mod dynamic_filter;
mod error;
mod frame;
mod headphone;
mod kit;
pub mod layout;
mod map;
mod object;
mod pad;
mod place;
pub mod range;
mod residual;
mod room;
mod striker;
mod surface;
mod trigger;

pub use biquads::Biquads;
pub use checksum::checksum;
pub use dynamic_filter::{DynamicFilter, ExciterBand};
pub use error::TableError;
pub use kit::Kit;
pub use map::Map;
pub use object::Object;
pub use pad::Pad;
pub use place::{Field, Place};
pub use residual::{Background, Residual, ResidualBand};
pub use striker::{ContactTable, Striker};
pub use surface::Surface;
pub use trigger::Trigger;
