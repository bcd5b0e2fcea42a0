//! Tests of the peripherals as a program sees them: registers are written, time passes, and
//! registers and signals are looked at.

mod clocks;
mod flash;
mod signals;
mod time;
mod usb;

use std::path::Path;
use std::sync::Arc;

use virtual_core::{Image, Machine};

use super::Devices;
use crate::error::Problem;
use crate::wiring::Board;

pub(super) const RCC: u32 = 0x4002_3800;
pub(super) const FLASH: u32 = 0x4002_3c00;
pub(super) const GPIO: u32 = 0x4002_0000;
pub(super) const TIM3: u32 = 0x4000_0400;
pub(super) const ADC: u32 = 0x4001_2000;
pub(super) const DMA1: u32 = 0x4002_6000;
pub(super) const DMA2: u32 = 0x4002_6400;
pub(super) const SPI2: u32 = 0x4000_3800;
pub(super) const I2C1: u32 = 0x4000_5400;
pub(super) const RAM: u32 = 0x2000_1000;

/// Devices with a machine whose core executes nothing.
pub(super) struct Bench {
    pub(super) machine: Machine,
    pub(super) devices: Devices,
}

impl Bench {
    /// Makes devices with the clocks of all modelled peripherals on, at 16 MHz from the HSI.
    pub(super) fn new(board: Board) -> Bench {
        let mut bench = Bench::after_reset(board);
        for (offset, value) in [(0x30, 0x0060_009f), (0x40, 0x1020_c00f), (0x44, 0x4100)] {
            bench.write(RCC + offset, value);
        }
        bench
    }

    pub(super) fn after_reset(board: Board) -> Bench {
        let program = concat!(env!("CARGO_MANIFEST_DIR"), "/../virtual-core/tests/program/Cargo.toml");
        let elf = virtual_core::build(Path::new(program)).unwrap();
        let machine = Machine::new(&Image::from_elf(&elf).unwrap()).unwrap();
        let devices = Devices::new(board.wiring(), Arc::clone(&machine.clock()));
        Bench { machine, devices }
    }

    pub(super) fn write(&mut self, address: u32, value: u32) {
        self.try_write(address, value).unwrap();
    }

    pub(super) fn try_write(&mut self, address: u32, value: u32) -> Result<(), Problem> {
        self.devices.write(address, value)
    }

    pub(super) fn read(&mut self, address: u32) -> u32 {
        self.devices.read(address).unwrap()
    }

    pub(super) fn now(&self) -> u64 {
        self.machine.now()
    }

    /// Lets `cycles` core cycles pass.
    pub(super) fn pass(&mut self, cycles: u64) {
        let until = self.now() + cycles;
        // The transfers that the last write requested come first.
        let now = self.now();
        self.devices.advance(now, &mut self.machine).unwrap();
        loop {
            let next = self.devices.next_event().clamp(self.now(), until);
            self.machine.sleep_until(next);
            self.devices.advance(next, &mut self.machine).unwrap();
            if next == until {
                return;
            }
        }
    }

    pub(super) fn halves(&self, address: u32, count: usize) -> Vec<u16> {
        let mut bytes = vec![0; 2 * count];
        self.machine.read(address, &mut bytes).unwrap();
        bytes.chunks_exact(2).map(|pair| u16::from_le_bytes([pair[0], pair[1]])).collect()
    }
}
