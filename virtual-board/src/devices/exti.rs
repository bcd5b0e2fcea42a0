//! EXTI and SYSCFG: edges on pins become interrupts (RM0090 sections 9 and 12, RM0383 sections 7
//! and 10).

use super::{Access, Problem};

/// Interrupt lines of EXTI. Lines 0 to 15 watch the pins of their number; the others have no source
/// on a virtual board.
#[derive(Debug, Default)]
pub(crate) struct Exti {
    interrupt_mask: u32,
    event_mask: u32,
    rising: u32,
    falling: u32,
    pending: u32,
}

const LINES: u32 = 0x007f_ffff;

impl Exti {
    pub(crate) fn read(&self, offset: u32) -> Access<u32> {
        Ok(match offset {
            0x00 => self.interrupt_mask,
            0x04 => self.event_mask,
            0x08 => self.rising,
            0x0c => self.falling,
            0x10 => 0,
            0x14 => self.pending,
            _ => return Err(Problem::register()),
        })
    }

    pub(crate) fn write(&mut self, offset: u32, value: u32) -> Access<()> {
        let value = value & LINES;
        match offset {
            0x00 => self.interrupt_mask = value,
            0x04 => self.event_mask = value,
            0x08 => self.rising = value,
            0x0c => self.falling = value,
            0x10 => self.pending |= value & self.interrupt_mask,
            0x14 => self.pending &= !value,
            _ => return Err(Problem::register()),
        }
        Ok(())
    }

    /// Takes a change of the levels of the pins that the lines watch.
    pub(crate) fn edges(&mut self, before: u32, after: u32) {
        let risen = after & !before & self.rising;
        let fallen = before & !after & self.falling;
        self.pending |= (risen | fallen) & self.interrupt_mask;
    }

    /// Returns the lines whose interrupt is asserted, as bits.
    pub(crate) fn asserted(&self) -> u32 {
        self.pending & self.interrupt_mask
    }
}

/// Registers of SYSCFG, which choose the port that each line of EXTI watches.
#[derive(Debug, Default)]
pub(crate) struct Syscfg {
    registers: [u32; 9],
}

impl Syscfg {
    fn index(offset: u32) -> Access<usize> {
        if offset <= 0x20 { Ok((offset / 4) as usize) } else { Err(Problem::register()) }
    }

    pub(crate) fn read(&self, offset: u32) -> Access<u32> {
        Ok(self.registers[Syscfg::index(offset)?])
    }

    pub(crate) fn write(&mut self, offset: u32, value: u32) -> Access<()> {
        self.registers[Syscfg::index(offset)?] = value;
        Ok(())
    }

    /// Returns the port that a line of EXTI watches, 0 to 15.
    pub(crate) fn port(&self, line: u8) -> u8 {
        (self.registers[2 + usize::from(line / 4)] >> (4 * (line % 4)) & 0xf) as u8
    }
}
