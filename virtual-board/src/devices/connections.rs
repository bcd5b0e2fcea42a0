//! Connections of the chip to the parts of the board: pins with their alternate functions.

use super::Devices;
use super::gpio::{Mode, Pin};

impl Devices {
    /// Returns true if a pin has an alternate function.
    pub(super) fn is_alternate(&self, pin: Pin, function: u8) -> bool {
        self.ports[usize::from(pin.port)].mode(pin.number) == Mode::Alternate(function)
    }

    /// Returns true if clock and data of the I2S reach the converter.
    pub(super) fn audio_is_connected(&self) -> bool {
        self.wiring.i2s_pins.iter().all(|&(name, pin, function)| name == "MCK" || self.is_alternate(pin, function))
    }

    /// Returns true if MCLK reaches the codec.
    pub(super) fn master_clock_runs(&self) -> bool {
        let pin = self.wiring.i2s_pins.iter().find(|pin| pin.0 == "MCK");
        let i2s = &self.i2s[usize::from(self.wiring.i2s) - 2];
        pin.is_some_and(|&(_, pin, function)| self.is_alternate(pin, function))
            && i2s.is_on()
            && i2s.makes_master_clock()
            && self.clocks.i2s.is_some()
    }
}
