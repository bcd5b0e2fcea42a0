//! Memory of a board's chip.

use virtual_core::Image;

use crate::chip::Chip;
use crate::error::BoardError;

/// Checks that an image lies in the memory of a chip.
pub(super) fn check(image: &Image, chip: Chip) -> Result<(), BoardError> {
    let memories = [
        (virtual_core::FLASH_ADDRESS, chip.flash_bytes()),
        (virtual_core::RAM_ADDRESS, chip.ram_bytes()),
        (virtual_core::CCM_ADDRESS, chip.ccm_bytes()),
    ];
    let fits = |address: u32, bytes: u32| {
        memories.iter().any(|&(start, length)| {
            let offset = address.wrapping_sub(start);
            offset < length && bytes <= length - offset
        })
    };
    match image.ranges().find(|&(address, bytes)| bytes != 0 && !fits(address, bytes)) {
        Some((address, _)) => Err(BoardError::WrongChip { address, chip: chip.name() }),
        None => Ok(()),
    }
}
