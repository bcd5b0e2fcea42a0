//! Resets of the whole chip, and of single peripherals by the RCC.

use super::dma::Dma;
use super::exti::{Exti, Syscfg};
use super::i2c::I2c;
use super::i2s::I2s;
use super::power::Power;
use super::rcc::ResetCause;
use super::timer::Timer;
use super::usb::Usb;
use super::watchdog::Watchdog;
use super::{Devices, RESET_CLOCKS, map, timers};

impl Devices {
    /// Resets all registers of the chip. The parts wired to it and the recording stay.
    pub(crate) fn reset(&mut self, cause: ResetCause, now: u64) {
        let seconds = self.seconds(now);
        self.epoch = (seconds, now);
        self.clocks = RESET_CLOCKS;
        self.rcc.reset(cause);
        self.flash.reset();
        self.power = Power::new(self.wiring.chip);
        for (index, port) in self.ports.iter_mut().enumerate() {
            port.reset(index as u8);
        }
        self.exti = Exti::default();
        self.syscfg = Syscfg::default();
        self.timers = timers();
        self.adc.reset();
        self.dma = Default::default();
        self.i2s.iter_mut().for_each(I2s::reset);
        self.i2c = I2c::default();
        self.watchdog = Watchdog::default();
        self.usb = Usb::default();
        self.recording.reset(seconds, cause);
        self.pins_changed(now);
    }

    /// Lets the crystal never start again.
    pub(crate) fn kill_crystal(&mut self) {
        self.rcc.kill_crystal();
    }

    /// Resets the registers of the devices whose reset bit is set.
    pub(super) fn reset_held(&mut self) {
        let held = |address| {
            let enable = map::find(address, self.wiring.chip).and_then(|(block, _)| block.enable);
            enable.is_some_and(|(register, bit)| self.rcc.is_held_in_reset(register, bit))
        };
        let timers = [0x4000_0000, 0x4000_0400, 0x4000_0800, 0x4000_0c00].map(held);
        let [spi2, spi3] = [0x4000_3800, 0x4000_3c00].map(held);
        let [i2c, adc, syscfg, power] = [0x4000_5400, 0x4001_2000, 0x4001_3800, 0x4000_7000].map(held);
        let usb = held(0x5000_0000);
        let dma = [0x4002_6000, 0x4002_6400].map(held);
        let ports: [bool; 9] = std::array::from_fn(|port| held(0x4002_0000 + 0x400 * port as u32));
        for (timer, reset) in self.timers.iter_mut().zip(timers) {
            if reset {
                *timer = Timer::new(timer.is_wide());
            }
        }
        for (i2s, reset) in self.i2s.iter_mut().zip([spi2, spi3]) {
            if reset {
                i2s.reset();
            }
        }
        for (dma, reset) in self.dma.iter_mut().zip(dma) {
            if reset {
                *dma = Dma::default();
            }
        }
        for (index, reset) in ports.into_iter().enumerate() {
            if reset {
                self.ports[index].reset(index as u8);
            }
        }
        if i2c {
            self.i2c = I2c::default();
        }
        if adc {
            self.adc.reset();
        }
        if syscfg {
            self.syscfg = Syscfg::default();
        }
        if usb {
            self.usb = Usb::default();
        }
        if power {
            self.power = Power::new(self.wiring.chip);
        }
    }
}
