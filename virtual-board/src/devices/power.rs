//! PWR, with the scale of the regulator (RM0090 section 5, RM0383 section 5), and DBGMCU.

use super::{Access, Problem};
use crate::chip::Chip;

#[derive(Debug)]
pub(crate) struct Power {
    chip: Chip,
    control: u32,
}

impl Power {
    pub(crate) fn new(chip: Chip) -> Power {
        Power { chip, control: if chip == Chip::Stm32F407 { 0x4000 } else { 0x8000 } }
    }

    pub(crate) fn read(&self, offset: u32) -> Access<u32> {
        match offset {
            0x00 => Ok(self.control),
            // The bit VOSRDY is always set.
            0x04 => Ok(1 << 14),
            _ => Err(Problem::register()),
        }
    }

    pub(crate) fn write(&mut self, offset: u32, value: u32) -> Access<()> {
        match offset {
            0x00 => self.control = value,
            0x04 => {}
            _ => return Err(Problem::register()),
        }
        Ok(())
    }

    /// Returns the field VOS, which has one bit on the F407 and two on the F411.
    pub(crate) fn scale(&self) -> u32 {
        let mask = if self.chip == Chip::Stm32F407 { 1 } else { 3 };
        self.control >> 14 & mask
    }
}

/// Reads the chip's unique identity, 96 bits (RM0090 section 39, RM0383 section 24).
pub(crate) fn signature(offset: u32) -> Access<u32> {
    match offset {
        0x10 => Ok(0x0027_0041),
        0x14 => Ok(0x3436_510f),
        0x18 => Ok(0x3231_3834),
        _ => Err(Problem::register()),
    }
}

/// DBGMCU: the identity, and registers for a core that a debugger halts. Of these the bit of the
/// watchdog has an effect.
#[derive(Debug)]
pub(crate) struct Debug {
    chip: Chip,
    registers: [u32; 3],
}

impl Debug {
    pub(crate) fn new(chip: Chip) -> Debug {
        Debug { chip, registers: [0; 3] }
    }

    /// Returns true if the watchdog halts with the core (DBGMCU_APB1_FZ.DBG_IWDG_STOP).
    pub(crate) fn halts_watchdog(&self) -> bool {
        self.registers[1] & 1 << 12 != 0
    }

    pub(crate) fn read(&self, offset: u32) -> Access<u32> {
        match offset {
            0x00 => Ok(self.chip.identity()),
            0x04 | 0x08 | 0x0c => Ok(self.registers[(offset / 4 - 1) as usize]),
            _ => Err(Problem::register()),
        }
    }

    pub(crate) fn write(&mut self, offset: u32, value: u32) -> Access<()> {
        match offset {
            0x04 | 0x08 | 0x0c => {
                self.registers[(offset / 4 - 1) as usize] = value;
                Ok(())
            }
            _ => Err(Problem::register()),
        }
    }
}
