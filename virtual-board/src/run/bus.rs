//! Devices on the core's bus.

use std::sync::{Mutex, MutexGuard, PoisonError};

use virtual_core::{FLASH_ADDRESS, Peripheral};

use crate::devices::flash::stale_read;
use crate::devices::{Devices, Refused, map};
use crate::error::Problem;

/// Devices that the core and the board share: the core accesses registers, and the board lets time
/// pass.
#[derive(Debug)]
pub(super) struct Shared(Mutex<Devices>);

impl Shared {
    pub(super) fn new(devices: Devices) -> Shared {
        Shared(Mutex::new(devices))
    }

    pub(super) fn lock(&self) -> MutexGuard<'_, Devices> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// Flash, as far as the program's stores go.
#[derive(Debug)]
pub(super) struct FlashStores(pub(super) std::sync::Arc<Shared>);

impl Peripheral for FlashStores {
    fn read(&self, _: u32, _: u32) -> Option<u32> {
        None
    }

    fn write(&self, offset: u32, bytes: u32, value: u32) -> Option<()> {
        let mut devices = self.0.lock();
        let address = FLASH_ADDRESS + offset;
        let problem = devices.store_to_flash(address, bytes, value).err();
        problem.is_none().then_some(()).or_else(|| {
            let access = format!("write of {value:#x} to");
            devices.refused = Some(Refused { access, register: "flash".to_owned(), address, problem: problem? });
            None
        })
    }
}

/// Sector that the program must not read through its data cache.
#[derive(Debug)]
pub(super) struct StaleSector {
    pub(super) address: u32,
    pub(super) devices: std::sync::Arc<Shared>,
}

impl Peripheral for StaleSector {
    fn read(&self, offset: u32, _: u32) -> Option<u32> {
        let refused = Refused {
            access: "read from".to_owned(),
            register: "flash".to_owned(),
            address: self.address + offset,
            problem: stale_read(),
        };
        self.devices.lock().refused = Some(refused);
        None
    }

    fn write(&self, _: u32, _: u32, _: u32) -> Option<()> {
        None
    }
}

/// Range of bus addresses in which peripherals lie.
#[derive(Debug)]
pub(super) struct Window {
    pub(super) base: u32,
    pub(super) devices: std::sync::Arc<Shared>,
}

impl Window {
    /// Keeps a refused access for the error that ends the run.
    fn refuse(devices: &mut Devices, access: String, address: u32, problem: Problem) {
        let register = match map::find(address, devices.wiring.chip) {
            Some((block, offset)) => format!("{}+{offset:#04x}", block.name),
            None => "no peripheral".to_owned(),
        };
        devices.refused = Some(Refused { access, register, address, problem });
    }
}

impl Peripheral for Window {
    fn read(&self, offset: u32, bytes: u32) -> Option<u32> {
        let address = self.base + offset;
        let mut devices = self.devices.lock();
        match devices.read(address & !3) {
            Ok(value) => {
                let shifted = value >> (8 * (address & 3));
                Some(if bytes == 4 { shifted } else { shifted & ((1 << (8 * bytes)) - 1) })
            }
            Err(problem) => {
                Window::refuse(&mut devices, "read from".to_owned(), address, problem);
                None
            }
        }
    }

    fn write(&self, offset: u32, bytes: u32, value: u32) -> Option<()> {
        let address = self.base + offset;
        let mut devices = self.devices.lock();
        let written = if bytes == 4 || address & 3 == 0 {
            devices.write(address, value)
        } else {
            Err(Problem::Unmodelled { what: "writes of the upper part of a register".to_owned() })
        };
        match written {
            Ok(()) => Some(()),
            Err(problem) => {
                Window::refuse(&mut devices, format!("write of {value:#x} to"), address, problem);
                None
            }
        }
    }
}
