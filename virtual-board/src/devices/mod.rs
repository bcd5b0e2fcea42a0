//! Peripherals of the chip and the parts that are wired to them: registers in, events out.
//!
//! ```text
//! program --register access--> map -> one device
//!                                      '-> effects on others (clock tree, pins)
//! time ---> events.rs -> events of all devices, DMA
//!                           '-> interrupts.rs -> interrupt lines
//! ```

pub(crate) mod adc;
mod connections;
pub(crate) mod dma;
mod events;
pub(crate) mod exti;
pub(crate) mod flash;
pub(crate) mod gpio;
pub(crate) mod i2c;
pub(crate) mod i2s;
mod interrupts;
pub(crate) mod map;
pub(crate) mod pins;
pub(crate) mod power;
pub(crate) mod rcc;
mod recording;
mod resets;
#[cfg(test)]
mod tests;
pub(crate) mod timer;
pub(crate) mod usb;
pub(crate) mod watchdog;

use std::sync::Arc;

use virtual_core::Clock;

use crate::codec::Codec;
use crate::error::Problem;
use crate::frequency::Frequency;
use crate::input::PiezoSignal;
use crate::usb_host::{Host, UsbHost};
use crate::wiring::Wiring;
use adc::Adc;
use dma::Dma;
use exti::{Exti, Syscfg};
use flash::Flash;
use gpio::{Pin, Port};
use i2c::I2c;
use i2s::I2s;
use map::Device;
use pins::{PiezoPin, Pins};
use power::{Debug, Power};
use rcc::{ClockTree, Rcc, ResetCause};
use timer::Timer;
use usb::Usb;
use watchdog::Watchdog;

pub(crate) use recording::{AudioHalf, Recording};

/// Result of an access to a register.
pub(crate) type Access<T> = Result<T, Problem>;

/// Time and clocks of an access or an event.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Context<'a> {
    /// Core cycles from power-on.
    pub(crate) now: u64,
    /// Seconds from power-on.
    pub(crate) seconds: f64,
    /// Clocks of the chip.
    pub(crate) clocks: &'a ClockTree,
}

impl Problem {
    /// Returns the problem of a register that does not exist.
    pub(crate) fn register() -> Problem {
        Problem::Register
    }
}

/// Feature that is not modelled.
pub(crate) struct Unmodelled(String);

impl Unmodelled {
    pub(crate) fn new(what: &str) -> Unmodelled {
        Unmodelled(what.to_owned())
    }
}

impl From<Unmodelled> for Problem {
    fn from(unmodelled: Unmodelled) -> Problem {
        Problem::Unmodelled { what: unmodelled.0 }
    }
}

/// Access that was refused, for the error message.
#[derive(Debug, Clone)]
pub(crate) struct Refused {
    pub(crate) access: String,
    pub(crate) register: String,
    pub(crate) address: u32,
    pub(crate) problem: Problem,
}

/// Faults that happen at the next occasion, or that last.
#[derive(Debug, Default, Clone, Copy)]
pub(crate) struct Armed {
    /// True if the DMA is to miss the next conversion of the ADC.
    pub(crate) adc_overrun: bool,
    /// True if the next transfer to the I2S is to fail.
    pub(crate) audio_dma_error: bool,
    /// True if the next transfer from the ADC is to fail.
    pub(crate) adc_dma_error: bool,
    /// True while the audio interrupt does not reach the core.
    pub(crate) audio_interrupt_lost: bool,
    /// Piezos whose pin is at the supply, as bits.
    pub(crate) piezos_at_rail: u32,
}

/// Board without its core.
#[derive(Debug)]
pub(crate) struct Devices {
    pub(crate) wiring: &'static Wiring,
    clock: Arc<Clock>,
    pub(crate) clocks: ClockTree,
    /// Seconds and cycle from power-on at which the clock tree last changed.
    epoch: (f64, u64),
    rcc: Rcc,
    flash: Flash,
    power: Power,
    debug: Debug,
    ports: [Port; 9],
    exti: Exti,
    syscfg: Syscfg,
    timers: [Timer; 4],
    adc: Adc,
    dma: [Dma; 2],
    i2s: [I2s; 2],
    i2c: I2c,
    watchdog: Watchdog,
    usb: Usb,
    pub(crate) usb_host: Host,
    pub(crate) codec: Option<Codec>,
    pub(crate) piezos: Vec<PiezoSignal>,
    pub(crate) pins: Pins,
    pub(crate) armed: Armed,
    pub(crate) refused: Option<Refused>,
    /// True if power was lost within an operation on flash.
    pub(crate) is_power_lost: bool,
    /// Levels of the pins that the lines of EXTI watch, as bits.
    watched_levels: u32,
    pub(crate) recording: Recording,
}

/// Returns TIM2 to TIM5 after a reset. TIM2 and TIM5 have 32 bits.
fn timers() -> [Timer; 4] {
    [Timer::new(true), Timer::new(false), Timer::new(false), Timer::new(true)]
}

/// Clocks after a reset: all from the HSI.
const RESET_CLOCKS: ClockTree = ClockTree {
    core: Frequency::hz(16_000_000),
    apb1: Frequency::hz(16_000_000),
    apb1_timers: Frequency::hz(16_000_000),
    apb2: Frequency::hz(16_000_000),
    i2s: None,
    usb: None,
};

impl Devices {
    /// Makes the devices of a board at power-on.
    pub(crate) fn new(wiring: &'static Wiring, clock: Arc<Clock>) -> Devices {
        let mut devices = Devices {
            wiring,
            clock,
            clocks: RESET_CLOCKS,
            epoch: (0.0, 0),
            rcc: Rcc::new(wiring.chip, wiring.crystal, ResetCause::Power),
            flash: Flash::new(wiring.chip),
            power: Power::new(wiring.chip),
            debug: Debug::new(wiring.chip),
            ports: std::array::from_fn(|port| Port::new(port as u8)),
            exti: Exti::default(),
            syscfg: Syscfg::default(),
            timers: timers(),
            adc: Adc::default(),
            dma: Default::default(),
            i2s: Default::default(),
            i2c: I2c::default(),
            watchdog: Watchdog::default(),
            usb: Usb::default(),
            usb_host: Host::new(&UsbHost::default()),
            codec: wiring.codec.map(|_| Codec::new(true)),
            piezos: Vec::new(),
            pins: Pins::new(&vec![PiezoPin::Circuit; wiring.piezos.len()], 0.0),
            armed: Armed::default(),
            refused: None,
            is_power_lost: false,
            watched_levels: 0,
            recording: Recording::default(),
        };
        devices.set_button(false);
        devices
    }

    /// Returns the seconds from power-on at a cycle.
    pub(crate) fn seconds(&self, cycle: u64) -> f64 {
        self.epoch.0 + cycle.saturating_sub(self.epoch.1) as f64 / self.clocks.core.as_f64()
    }

    /// Returns the first cycle at or after a time in seconds, at the present clock.
    pub(crate) fn cycle_at(&self, seconds: f64) -> u64 {
        self.epoch.1.saturating_add(((seconds - self.epoch.0).max(0.0) * self.clocks.core.as_f64()).ceil() as u64)
    }

    /// Returns the I2S of the board, with its streams so far.
    pub(crate) fn audio(&mut self) -> &mut I2s {
        &mut self.i2s[usize::from(self.wiring.i2s) - 2]
    }

    /// Returns the number of sequences of the ADC, and the number of triggers that it lost.
    pub(crate) fn adc_counts(&self) -> (u64, u64) {
        (self.adc.sequences, self.adc.lost_triggers)
    }

    /// Notes that a debugger halts the core for some cycles: devices that halt with it go on where
    /// they were.
    pub(crate) fn halted(&mut self, cycles: u64) {
        if self.debug.halts_watchdog() {
            self.watchdog.delay(cycles);
        }
    }

    /// Presses or releases the button.
    pub(crate) fn set_button(&mut self, pressed: bool) {
        let Pin { port, number } = self.wiring.button;
        self.ports[usize::from(port)].drive(number, Some(pressed == self.wiring.pressed_is_high));
    }

    /// Reads a register for the program or the DMA.
    pub(crate) fn read(&mut self, address: u32) -> Access<u32> {
        let now = self.clock.now();
        let (device, offset) = self.reach(address)?;
        let clocks = self.clocks;
        let context = Context { now, seconds: self.seconds(now), clocks: &clocks };
        match device {
            Device::Timer(timer) => self.timers[usize::from(timer)].read(offset, &context),
            Device::Watchdog => self.watchdog.read(offset),
            Device::I2s(i2s) => self.i2s[usize::from(i2s)].read(offset),
            Device::I2c => {
                let due = self.i2c.next_event();
                let value = self.i2c.read(offset, &context);
                if self.i2c.next_event() != due {
                    self.clock.pause_now();
                }
                value
            }
            Device::Usb => self.read_usb(offset, &context),
            Device::Signature => power::signature(offset),
            Device::Power => self.power.read(offset),
            Device::Adc => self.adc.read(offset),
            Device::Syscfg => self.syscfg.read(offset),
            Device::Exti => self.exti.read(offset),
            Device::Gpio(port) => self.ports[usize::from(port)].read(offset),
            Device::Rcc => self.rcc.read(offset, &context),
            Device::Flash => self.flash.read(offset),
            Device::Dma(dma) => self.dma[usize::from(dma)].read(offset),
            Device::Debug => self.debug.read(offset),
        }
    }

    /// Writes a register for the program or the DMA.
    pub(crate) fn write(&mut self, address: u32, value: u32) -> Access<()> {
        let now = self.clock.now();
        let (device, offset) = self.reach(address)?;
        let clocks = self.clocks;
        let context = Context { now, seconds: self.seconds(now), clocks: &clocks };
        // The write may change lines and next events, which are looked at after this instruction.
        self.clock.pause_now();
        match device {
            Device::Timer(timer) => {
                let mut outputs = Vec::new();
                self.timers[usize::from(timer)].write(offset, value, &context, |output| outputs.push(output))?;
                for output in outputs {
                    self.adc.triggered(timer + 2, output, &context)?;
                }
                Ok(())
            }
            Device::Watchdog => self.watchdog.write(offset, value, &context),
            Device::I2s(i2s) => self.i2s[usize::from(i2s)].write(offset, value, &context),
            Device::I2c => self.i2c.write(offset, value, &context),
            Device::Usb => self.write_usb(offset, value, &context),
            Device::Signature => Err(Problem::register()),
            Device::Power => {
                self.power.write(offset, value)?;
                self.clocks_changed(now)
            }
            Device::Adc => self.adc.write(offset, value, &context),
            Device::Syscfg => {
                self.syscfg.write(offset, value)?;
                // Choosing another port makes no edge.
                self.watched_levels = self.exti_levels();
                Ok(())
            }
            Device::Exti => self.exti.write(offset, value),
            Device::Gpio(port) => {
                self.ports[usize::from(port)].write(offset, value)?;
                self.pins_changed(now);
                Ok(())
            }
            Device::Rcc => {
                self.rcc.write(offset, value, &context)?;
                if self.rcc.holds_resets() {
                    self.reset_held();
                }
                self.clocks_changed(now)
            }
            Device::Flash => self.write_flash(offset, value, &context),
            Device::Dma(dma) => self.dma[usize::from(dma)].write(offset, value),
            Device::Debug => self.debug.write(offset, value),
        }
    }

    /// Returns the device at an address and the offset in it, if its clock is on.
    fn reach(&self, address: u32) -> Access<(Device, u32)> {
        let (block, offset) = map::find(address, self.wiring.chip).ok_or_else(Problem::register)?;
        let device = block.device.ok_or_else(|| Unmodelled::new("this peripheral"))?;
        if let Some((register, bit)) = block.enable {
            let bus = match register {
                0x30 => "AHB1",
                0x34 => "AHB2",
                0x40 => "APB1",
                _ => "APB2",
            };
            if !self.rcc.is_enabled(register, bit) {
                return Err(Problem::ClockOff { enable: format!("RCC_{bus}ENR bit {bit}") });
            }
            if self.rcc.is_held_in_reset(register, bit) {
                return Err(Problem::InReset { reset: format!("RCC_{bus}RSTR bit {bit}") });
            }
        }
        Ok((device, offset))
    }

    /// Checks the clock tree after a write and passes a change to the devices.
    fn clocks_changed(&mut self, now: u64) -> Access<()> {
        let tree = self.rcc.tree()?;
        let needed = self.wiring.chip.wait_states(tree.core);
        if u32::from(self.flash.switches().wait_states) < needed {
            let states = if needed == 1 { "wait state" } else { "wait states" };
            let reason = format!(
                "the core runs at {}, which needs {needed} {states} of flash; FLASH_ACR.LATENCY is {}",
                tree.core,
                self.flash.switches().wait_states
            );
            return Err(Problem::ClockTree { reason });
        }
        let limit = self.wiring.chip.hclk_at_scale(self.power.scale());
        if tree.core > limit {
            let reason = format!("the core runs at {}; PWR_CR.VOS allows {limit}", tree.core);
            return Err(Problem::ClockTree { reason });
        }
        if tree == self.clocks {
            return Ok(());
        }
        let running = self.i2s.iter().any(I2s::is_running) || self.adc.is_running() || self.usb.is_attached();
        if running {
            let reason = "the clock tree changes while the I2S, the ADC or USB runs".to_owned();
            return Err(Problem::ClockTree { reason });
        }
        let seconds = self.seconds(now);
        let before = self.clocks;
        self.watchdog.clock_changed(now, before.core, tree.core);
        self.epoch = (seconds, now);
        self.clocks = tree;
        let context = Context { now, seconds, clocks: &tree };
        self.timers.iter_mut().for_each(|timer| timer.clock_changed(&context));
        Ok(())
    }
}
