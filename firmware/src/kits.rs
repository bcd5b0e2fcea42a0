//! The kit that plays: the one in its own flash sector where it is good, else the built-in one.

use dsp_core::table::{Kit, TableError};

/// Built from the shipped text by the build script: `malleus kit build demo` gives the same bytes.
pub const BUILT_IN: &[u8] = include_bytes!(concat!(env!("OUT_DIR"), "/built-in-kit.bin"));

/// The bytes of the kit sector, erased or not.
pub fn sector() -> &'static [u8] {
    unsafe extern "C" {
        static _kit_sector_start: u8;
        static _kit_sector_end: u8;
    }
    let (start, end) = (&raw const _kit_sector_start, &raw const _kit_sector_end);
    // SAFETY: the linker script puts both round a sector that the program does not write.
    unsafe { core::slice::from_raw_parts(start, end as usize - start as usize) }
}

/// The kit in the sector, read in place: `None` where the sector is erased.
///
/// # Errors
/// The first thing that is wrong with it.
pub fn in_sector() -> Result<Option<Kit<'static>>, TableError> {
    let bytes = sector();
    match bytes.iter().take(64).all(|&byte| byte == 0xFF) {
        true => Ok(None),
        false => Kit::parse(bytes).map(Some),
    }
}
