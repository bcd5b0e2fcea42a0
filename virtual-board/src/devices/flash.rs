//! FLASH: wait states and the switches of the accelerator (RM0090 section 3, RM0383 section 3).
//! Programming and erasing are not modelled.

use super::{Access, Problem, Unmodelled};

const PREFETCH: u32 = 1 << 8;
const INSTRUCTION_CACHE: u32 = 1 << 9;
const DATA_CACHE: u32 = 1 << 10;
const INSTRUCTION_RESET: u32 = 1 << 11;
const DATA_RESET: u32 = 1 << 12;
const LOCK: u32 = 1 << 31;
/// Option bytes of a new chip in FLASH_OPTCR, locked: no protection, and no brown-out reset.
const OPTIONS: u32 = 0x0fff_aaed;

#[derive(Debug, Default)]
pub(crate) struct Flash {
    control: u32,
}

impl Flash {
    pub(crate) fn read(&self, offset: u32) -> Access<u32> {
        match offset {
            0x00 => Ok(self.control),
            0x0c => Ok(0),
            0x14 => Ok(OPTIONS),
            0x10 => Ok(LOCK),
            _ => Err(Problem::register()),
        }
    }

    pub(crate) fn write(&mut self, offset: u32, value: u32) -> Access<()> {
        match offset {
            0x00 => {
                let resets = value & (INSTRUCTION_RESET | DATA_RESET);
                let on = self.control & (INSTRUCTION_CACHE | DATA_CACHE);
                if resets & on << 2 != 0 {
                    return Err(Problem::Misuse {
                        reason: "FLASH_ACR: a cache is reset while it is on; switch it off first".to_owned(),
                    });
                }
                self.control = value & (7 | PREFETCH | INSTRUCTION_CACHE | DATA_CACHE | INSTRUCTION_RESET | DATA_RESET);
                Ok(())
            }
            0x04 | 0x08 | 0x10 | 0x14 => Err(Unmodelled::new("programming the flash").into()),
            _ => Err(Problem::register()),
        }
    }

    /// Returns the number of wait states.
    pub(crate) fn latency(&self) -> u32 {
        self.control & 7
    }

    /// Returns two flags: true if the instruction cache is on, and true if the data cache is on.
    pub(crate) fn caches(&self) -> (bool, bool) {
        (self.control & INSTRUCTION_CACHE != 0, self.control & DATA_CACHE != 0)
    }
}
