//! Flash of a board: its contents at power-on and after a run, and the sectors that a program must
//! not read through its data cache.

use std::sync::Arc;

use virtual_core::{Core, FLASH_ADDRESS, FLASH_BYTES, Image, Machine};

use super::bus::StaleSector;
use super::{Setup, VirtualBoard};
use crate::chip::Chip;
use crate::devices::{Devices, Unmodelled};
use crate::error::BoardError;
use crate::flash::{FlashHistory, FlashMemory};

/// Returns the ranges of flash in which an image has bytes, as address and length.
pub(super) fn ranges(image: &Image, chip: Chip) -> Vec<(u32, u32)> {
    let in_flash = |&(address, bytes): &(u32, u32)| bytes != 0 && chip.sector_at(address).is_some();
    image.ranges().filter(in_flash).collect()
}

/// Fills the machine's flash with the contents of the setup, its kit, and the image that the
/// machine has already. Sectors of the image hold nothing else.
///
/// # Errors
/// [`BoardError`] if the contents are those of another chip, or if the kit is too long.
pub(super) fn fill(machine: &mut Machine, image: &Image, chip: Chip, setup: &Setup) -> Result<FlashMemory, BoardError> {
    let mut memory = setup.flash.clone().unwrap_or_else(|| FlashMemory::erased(chip));
    if memory.chip() != chip {
        return Err(BoardError::OtherFlash { found: memory.chip().name(), chip: chip.name() });
    }
    let (sector, sector_bytes) = chip.kit_sector();
    if setup.kit.len() > sector_bytes as usize {
        return Err(BoardError::KitTooLong { bytes: setup.kit.len(), sector_bytes });
    }
    if !setup.kit.is_empty() {
        memory.write(sector, &vec![0xff; sector_bytes as usize])?;
        memory.write(sector, &setup.kit)?;
    }
    let ranges = ranges(image, chip);
    for sector in chip.sectors() {
        let overlaps =
            |&(first, bytes): &(u32, u32)| first < sector.address + sector.bytes && sector.address < first + bytes;
        if ranges.iter().any(overlaps) {
            memory.write(sector.address, &vec![0xff; sector.bytes as usize])?;
        }
    }
    for (address, length) in ranges {
        let mut bytes = vec![0; length as usize];
        machine.read(address, &mut bytes)?;
        memory.write(address, &bytes)?;
    }
    machine.write(FLASH_ADDRESS, memory.read(FLASH_ADDRESS, chip.flash_bytes() as usize).unwrap_or_default())?;
    Ok(memory)
}

impl VirtualBoard {
    /// Returns the contents of flash as they are now, with which another run can begin
    /// ([`Setup::flash`]).
    pub fn flash(&self) -> FlashMemory {
        self.devices.lock().flash_contents().0.clone()
    }

    /// Returns the contents of flash at power-on, and all operations on it since.
    pub fn flash_history(&self) -> FlashHistory {
        self.devices.lock().flash_contents().1.clone()
    }

    /// Returns the time at which power was lost, in seconds from power-on; `None` as long as the
    /// board has power.
    pub fn power_lost_s(&self) -> Option<f64> {
        self.power_lost_s
    }

    /// Follows the flash: its wait states, its caches, and an operation for which the core waits.
    pub(super) fn look_after_flash(&mut self, devices: &Devices, now: u64) -> Result<(), BoardError> {
        self.machine.accelerator().switch(devices.flash_switches());
        let stale = devices.stale_sectors();
        if stale != self.stale {
            self.trap_stale_sectors(stale)?;
        }
        self.waits_for_flash = devices.is_flash_busy();
        if self.waits_for_flash && self.machine.core().pc().wrapping_sub(FLASH_ADDRESS) >= FLASH_BYTES {
            let problem = Unmodelled::new("an operation on flash while the program runs from RAM").into();
            return Err(BoardError::Device { device: "FLASH", problem, time_s: devices.seconds(now) });
        }
        Ok(())
    }

    /// Lets the sectors in `stale`, as bits, and no others, refuse reads.
    fn trap_stale_sectors(&mut self, stale: u16) -> Result<(), BoardError> {
        for trap in self.stale_traps.drain(..) {
            self.machine.untrap_reads(trap);
        }
        for (number, sector) in self.board.wiring().chip.sectors().iter().enumerate() {
            if stale & 1 << number != 0 {
                let device = StaleSector { address: sector.address, devices: Arc::clone(&self.devices) };
                self.stale_traps.push(self.machine.trap_reads(sector.address, sector.bytes, Arc::new(device))?);
            }
        }
        self.stale = stale;
        Ok(())
    }
}
