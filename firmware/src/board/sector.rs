//! Sectors of the chip's flash.

/// Sector of the flash: the least that can be erased.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Sector {
    /// Number of the sector in FLASH_CR.
    pub number: u8,
    /// Address of its first byte, a multiple of 4.
    pub address: u32,
    /// Length in bytes, a multiple of 4.
    pub bytes: u32,
}

impl Sector {
    /// All bytes of the sector, as they are now.
    pub fn read(&self) -> &'static [u8] {
        // SAFETY: the boards' sectors lie in the flash of the chip, and the program has nothing in
        // them (memory.x). Whoever writes to a sector holds none of its bytes.
        unsafe {
            core::slice::from_raw_parts(core::ptr::with_exposed_provenance(self.address as usize), self.bytes as usize)
        }
    }
}
