//! Kits in the flash: one in the image, and those of the slots.

use dsp_core::table::{Kit, TableError};

/// Bytes of the built-in kit, which the build script makes: those that `malleus kit build demo`
/// writes.
pub static BUILT_IN: &[u8] = &BYTES;

// Beside the vectors, where no code is.
#[unsafe(link_section = ".sector0.built_in_kit")]
static BYTES: [u8; include_bytes!(concat!(env!("OUT_DIR"), "/built-in-kit.bin")).len()] =
    *include_bytes!(concat!(env!("OUT_DIR"), "/built-in-kit.bin"));

/// Returns the kit in a sector, read in place, or `None` if the sector is erased.
///
/// # Errors
/// [`TableError`] that names the first thing that is wrong with the kit.
pub fn read(sector: &'static [u8]) -> Result<Option<Kit<'static>>, TableError> {
    match sector.iter().take(64).all(|&byte| byte == 0xFF) {
        true => Ok(None),
        false => Kit::parse(sector).map(Some),
    }
}
