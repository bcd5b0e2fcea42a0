//! Tables: what a fit produces and a board plays, read in place.
//!
//! A kit is one block of bytes, in flash or in a file:
//!
//! ```text
//! header    magic "MALL", format version, length, CRC-32 of all that follows
//! directory section count, then an entry a section: tag, version, offset, length
//! sections  META one · OBJT one an object · STRK one a striker · PADS one · trig none or one ·
//!           resi none or one an object · bgnd none or one · room none or one ·
//!           dynf none or one an object · biqd none or one an object · rest none or one · bala none or one
//! ```
//!
//! All numbers are little-endian, floats are IEEE single precision, sections are 4-byte aligned and tile the file without
//! gaps; what follows `length` must be erased flash (0xFF). The records are in [`layout`], the valid ranges in [`range`].
//! [`Kit::parse`] checks every length, index, name and float once and then hands out views without copying; each refusal is a
//! [`TableError`] that says which field, where, and what was expected. Two sections serve stages that few engines have, `dynf` and `biqd`: an
//! engine without them skips these, and whoever reads them checks them ([`Kit::dynamic_filters`], [`Kit::biquads`]).
//!
//! A new stage is a new section. As in PNG, a section whose tag begins with a lower-case letter may be skipped by a reader that
//! does not know it; any other unknown tag, or a newer version of a known one, is refused by name.

mod balance;
mod biquads;
mod check;
mod dynamic_filter;
mod error;
mod frame;
pub mod layout;
mod place;
pub mod range;
mod read;
mod residual;
mod room;
mod trigger;

pub use biquads::Biquads;
pub use dynamic_filter::{DynamicFilter, ExciterBand};
pub use error::TableError;
pub use place::{Field, Place};
pub use read::{ContactTable, Kit, Object, Pad, Striker};
pub use residual::{Background, Residual};
pub use trigger::Trigger;

use crc::{CRC_32_ISO_HDLC, Crc};

/// A board checks a kit once, at its start, and has no kilobyte to spare for that; a PC checks many.
#[cfg(target_os = "none")]
type Lookup = crc::NoTable;
#[cfg(not(target_os = "none"))]
type Lookup = crc::Table<16>;

/// CRC-32/ISO-HDLC (the one of zip and Ethernet) over a kit's bytes after its header.
pub fn checksum(bytes: &[u8]) -> u32 {
    const CRC: Crc<u32, Lookup> = Crc::<u32, Lookup>::new(&CRC_32_ISO_HDLC);
    CRC.checksum(bytes)
}

#[cfg(test)]
mod tests {
    #[test]
    fn the_checksum_is_the_published_one() {
        assert_eq!(super::checksum(b"123456789"), 0xCBF4_3926);
    }
}
