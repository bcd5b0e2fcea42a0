//! Kits of the board: one in a flash sector of its own, which plays if it is good, and one in the
//! image, which plays otherwise.

use dsp_core::table::{Kit, TableError};

/// Bytes of the built-in kit, which the build script makes: those that `malleus kit build demo`
/// writes.
pub const BUILT_IN: &[u8] = include_bytes!(concat!(env!("OUT_DIR"), "/built-in-kit.bin"));

/// Returns the bytes of the kit sector, erased or not.
pub fn sector() -> &'static [u8] {
    unsafe extern "C" {
        static _kit_sector_start: u8;
        static _kit_sector_end: u8;
    }
    let (start, end) = (&raw const _kit_sector_start, &raw const _kit_sector_end);
    // SAFETY: the linker script puts both symbols round a sector that the program does not write.
    unsafe { core::slice::from_raw_parts(start, end as usize - start as usize) }
}

/// Returns the kit in the kit sector, read in place, or `None` if the sector is erased.
///
/// # Errors
/// [`TableError`] that names the first thing that is wrong with the kit.
pub fn in_sector() -> Result<Option<Kit<'static>>, TableError> {
    let bytes = sector();
    match bytes.iter().take(64).all(|&byte| byte == 0xFF) {
        true => Ok(None),
        false => Kit::parse(bytes).map(Some),
    }
}
