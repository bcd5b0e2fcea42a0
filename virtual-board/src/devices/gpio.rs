//! GPIO: modes, alternate functions, levels (RM0090 section 8, RM0383 section 8).

use super::{Access, Problem};

/// Pin of the chip.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Pin {
    /// Port of the pin; 0 is port A.
    pub port: u8,
    /// Number of the pin in its port, 0 to 15.
    pub number: u8,
}

impl Pin {
    /// Returns the pin with a port letter and a number.
    pub const fn new(port: char, number: u8) -> Pin {
        Pin { port: port as u8 - b'A', number }
    }
}

impl std::fmt::Display for Pin {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "P{}{}", char::from(b'A' + self.port), self.number)
    }
}

/// Mode of a pin by the register MODER.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Mode {
    Input,
    Output,
    /// Alternate function of this number, 0 to 15.
    Alternate(u8),
    Analog,
}

/// Pull resistor of a pin by the register PUPDR.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Pull {
    None,
    Up,
    Down,
}

impl std::fmt::Display for Mode {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Mode::Input => f.write_str("an input"),
            Mode::Output => f.write_str("an output"),
            Mode::Alternate(function) => write!(f, "alternate function {function}"),
            Mode::Analog => f.write_str("analog"),
        }
    }
}

/// Port of 16 pins.
#[derive(Debug, Clone)]
pub(crate) struct Port {
    mode: u32,
    output_type: u32,
    speed: u32,
    pull: u32,
    output: u32,
    lock: u32,
    function: [u32; 2],
    /// Levels from outside, as bits.
    external: u32,
    /// Pins that are driven from outside, as bits.
    driven: u32,
}

impl Port {
    pub(crate) fn new(port: u8) -> Port {
        // A reset leaves the pins of the debug port in their alternate function.
        let (mode, speed, pull) = match port {
            0 => (0xa800_0000, 0x0c00_0000, 0x6400_0000),
            1 => (0x0000_0280, 0x0000_00c0, 0x0000_0100),
            _ => (0, 0, 0),
        };
        let (output_type, output, lock, function) = (0, 0, 0, [0; 2]);
        Port { mode, output_type, speed, pull, output, lock, function, external: 0, driven: 0 }
    }

    /// Resets the registers. The levels from outside stay.
    pub(crate) fn reset(&mut self, port: u8) {
        *self = Port { external: self.external, driven: self.driven, ..Port::new(port) };
    }

    /// Returns the levels of all pins, as bits.
    pub(crate) fn levels(&self) -> u32 {
        (0..16).map(|number| u32::from(self.level(number)) << number).sum()
    }

    fn level(&self, number: u8) -> bool {
        let bit = 1 << number;
        match self.mode(number) {
            Mode::Analog => false,
            Mode::Output if self.output_type & bit == 0 || self.output & bit == 0 => self.output & bit != 0,
            _ if self.driven & bit != 0 => self.external & bit != 0,
            _ => self.pull >> (2 * number) & 3 == 1,
        }
    }

    pub(crate) fn mode(&self, number: u8) -> Mode {
        match self.mode >> (2 * number) & 3 {
            0 => Mode::Input,
            1 => Mode::Output,
            2 => Mode::Alternate((self.function[usize::from(number / 8)] >> (4 * (number % 8)) & 0xf) as u8),
            _ => Mode::Analog,
        }
    }

    /// Returns the pull resistor of a pin that is switched on.
    pub(crate) fn pull(&self, number: u8) -> Pull {
        match self.pull >> (2 * number) & 3 {
            1 => Pull::Up,
            2 => Pull::Down,
            _ => Pull::None,
        }
    }

    /// Returns true if a pin is an output and high.
    pub(crate) fn is_driven_high(&self, number: u8) -> bool {
        self.mode(number) == Mode::Output && self.output >> number & 1 != 0
    }

    /// Drives a pin from outside; `None` lets it float.
    pub(crate) fn drive(&mut self, number: u8, level: Option<bool>) {
        let bit = 1 << number;
        self.driven = if level.is_some() { self.driven | bit } else { self.driven & !bit };
        self.external = if level == Some(true) { self.external | bit } else { self.external & !bit };
    }

    pub(crate) fn read(&self, offset: u32) -> Access<u32> {
        Ok(match offset {
            0x00 => self.mode,
            0x04 => self.output_type,
            0x08 => self.speed,
            0x0c => self.pull,
            0x10 => self.levels(),
            0x14 => self.output,
            0x18 => 0,
            0x1c => self.lock,
            0x20 | 0x24 => self.function[(offset - 0x20) as usize / 4],
            _ => return Err(Problem::register()),
        })
    }

    pub(crate) fn write(&mut self, offset: u32, value: u32) -> Access<()> {
        match offset {
            0x00 => self.mode = value,
            0x04 => self.output_type = value & 0xffff,
            0x08 => self.speed = value,
            0x0c => self.pull = value,
            0x10 => {}
            0x14 => self.output = value & 0xffff,
            // Setting wins over resetting.
            0x18 => self.output = self.output & !(value >> 16) | value & 0xffff,
            0x1c => self.lock = value,
            0x20 | 0x24 => self.function[(offset - 0x20) as usize / 4] = value,
            _ => return Err(Problem::register()),
        }
        Ok(())
    }
}
