//! Contents of a chip's flash, which outlive a run.

use std::fmt;

use virtual_core::FLASH_ADDRESS;

use super::history::FlashChange;
use super::random::Random;
use crate::chip::{Chip, Sector};
use crate::error::BoardError;

/// Option bytes of a new chip, as OPTCR shows them with its lock (RM0090 and RM0383, section
/// 3.8.6): brown-out reset off, no sector protected.
const NEW_OPTIONS: u32 = 0x0fff_aaed;

/// Contents of a chip's flash, with the option bytes and the wear of each sector.
///
/// A run takes them ([`crate::Setup::flash`]) and gives them back
/// ([`crate::VirtualBoard::flash`]), so that another run can go on with them.
///
/// ```
/// use virtual_board::{Chip, FlashMemory};
///
/// # fn main() -> Result<(), virtual_board::BoardError> {
/// let mut flash = FlashMemory::erased(Chip::Stm32F411);
/// flash.write(0x0800_4000, b"settings")?;
/// assert_eq!(flash.read(0x0800_4006, 4), Some(b"gs\xff\xff".as_slice()));
/// # Ok(())
/// # }
/// ```
#[derive(Clone, PartialEq, Eq)]
pub struct FlashMemory {
    chip: Chip,
    bytes: Vec<u8>,
    options: u32,
    erases: Vec<u32>,
}

impl fmt::Debug for FlashMemory {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let written = self.bytes.iter().filter(|&&byte| byte != 0xff).count();
        write!(f, "FlashMemory({}, {written} bytes written, erases {:?})", self.chip.name(), self.erases)
    }
}

impl FlashMemory {
    /// Makes the flash of a new chip: erased, with the option bytes of the factory.
    pub fn erased(chip: Chip) -> FlashMemory {
        let bytes = vec![0xff; chip.flash_bytes() as usize];
        FlashMemory { chip, bytes, options: NEW_OPTIONS, erases: vec![0; chip.sectors().len()] }
    }

    /// Returns the chip to which the flash belongs.
    pub fn chip(&self) -> Chip {
        self.chip
    }

    /// Returns bytes from an address on, or `None` if the chip has no flash there.
    pub fn read(&self, address: u32, bytes: usize) -> Option<&[u8]> {
        let first = address.checked_sub(FLASH_ADDRESS)? as usize;
        self.bytes.get(first..first.checked_add(bytes)?)
    }

    /// Replaces bytes from an address on, as a programmer does. Nothing wears.
    ///
    /// # Errors
    /// [`BoardError::NoFlash`] if the chip has no flash there.
    pub fn write(&mut self, address: u32, bytes: &[u8]) -> Result<(), BoardError> {
        let no_flash = || BoardError::NoFlash { address, bytes: bytes.len(), chip: self.chip.name() };
        self.read(address, bytes.len()).ok_or_else(no_flash)?;
        self.bytes_at(address, bytes.len()).copy_from_slice(bytes);
        Ok(())
    }

    /// Returns the option bytes in the form of the register FLASH_OPTCR.
    pub fn options(&self) -> u32 {
        self.options
    }

    /// Sets the option bytes, in the form of the register FLASH_OPTCR. Bits 2 and 3 are the
    /// brown-out level, and bits 16 and up, while 0, protect sectors.
    pub fn set_options(&mut self, options: u32) {
        self.options = options | 1;
    }

    /// Returns the number of erases of each sector, in all runs, torn ones included.
    pub fn erases(&self) -> &[u32] {
        &self.erases
    }

    fn bytes_at(&mut self, address: u32, bytes: usize) -> &mut [u8] {
        let first = address.wrapping_sub(FLASH_ADDRESS) as usize;
        self.bytes.get_mut(first..first + bytes).unwrap_or_default()
    }

    fn erase_counted(&mut self, number: u8) -> Option<Sector> {
        *self.erases.get_mut(usize::from(number))? += 1;
        self.chip.sectors().get(usize::from(number)).copied()
    }

    /// Applies a change that was carried out whole.
    pub(crate) fn apply(&mut self, change: &FlashChange) {
        match *change {
            FlashChange::Program { address, bytes, new, .. } => {
                let width = usize::from(bytes);
                self.bytes_at(address, width).copy_from_slice(&new.to_le_bytes()[..width]);
            }
            FlashChange::Erase { sector } => {
                if let Some(sector) = self.erase_counted(sector) {
                    self.bytes_at(sector.address, sector.bytes as usize).fill(0xff);
                }
            }
            FlashChange::Options { new, .. } => self.set_options(new),
        }
    }

    /// Applies a change that was broken off: each bit that was to change may have done so or not.
    ///
    /// A sector may also hold zeros and anything else, because an erase may begin with programming
    /// all bits to 0. From one seed to the next, few or many of its bytes have changed. Option
    /// bytes stay as they were.
    pub(crate) fn tear(&mut self, change: &FlashChange, seed: u64) {
        let mut random = Random::new(seed);
        match *change {
            FlashChange::Program { address, bytes, old, new } => {
                let mixed = new | old & random.next() as u32;
                self.apply(&FlashChange::Program { address, bytes, old, new: mixed });
            }
            FlashChange::Erase { sector } => {
                let Some(sector) = self.erase_counted(sector) else { return };
                // One byte of 1, 2, 4 ... 32 768 has changed.
                let spared = (1_u64 << (random.next() % 16)) - 1;
                for byte in self.bytes_at(sector.address, sector.bytes as usize) {
                    let draw = random.next();
                    if draw & spared == 0 {
                        *byte = match draw >> 60 & 3 {
                            0 => 0xff,
                            1 => 0x00,
                            2 => *byte | (draw >> 32) as u8,
                            _ => (draw >> 32) as u8,
                        };
                    }
                }
            }
            FlashChange::Options { .. } => {}
        }
    }
}
