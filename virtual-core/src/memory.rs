//! Memory map of the board: flash, RAM, CCM, and the peripherals that a caller adds.

use std::fmt::Debug;
use std::sync::Arc;

use rsemu::core::BusError;
use rsemu::core::space::{AddressSpace, Mapping, MappingId, MemAttrs, MemOps, MemResult, Perms, RamStore, Region};
use rsemu::core::value::{Endian, Width};

use crate::error::RunError;

/// First address of the flash, and of the vector table.
pub const FLASH_ADDRESS: u32 = 0x0800_0000;
/// Length of the flash in bytes: 1 MB, as on the STM32F407.
pub const FLASH_BYTES: u32 = 1 << 20;
/// First address of the RAM (SRAM1 and SRAM2).
pub const RAM_ADDRESS: u32 = 0x2000_0000;
/// Length of the RAM in bytes.
pub const RAM_BYTES: u32 = 128 << 10;
/// First address of the core-coupled memory, which holds data but no instructions.
pub const CCM_ADDRESS: u32 = 0x1000_0000;
/// Length of the core-coupled memory in bytes.
pub const CCM_BYTES: u32 = 64 << 10;

/// Returns true if all bytes lie in one of the board's memories.
pub(crate) fn contains(address: u32, bytes: u32) -> bool {
    let within = |(start, length): (u32, u32)| {
        let offset = address.wrapping_sub(start);
        offset < length && bytes <= length - offset
    };
    [(FLASH_ADDRESS, FLASH_BYTES), (RAM_ADDRESS, RAM_BYTES), (CCM_ADDRESS, CCM_BYTES)].into_iter().any(within)
}

/// Device on the bus, which is called for every access to its region ([`crate::Machine::map`]).
pub trait Peripheral: Debug + Send + Sync {
    /// Reads 1, 2 or 4 bytes at `offset` into the region.
    ///
    /// `None` refuses the access: the run ends with an error that names the address.
    fn read(&self, offset: u32, bytes: u32) -> Option<u32>;
    /// Writes 1, 2 or 4 bytes at `offset` into the region.
    ///
    /// `None` refuses the access: the run ends with an error that names the address.
    fn write(&self, offset: u32, bytes: u32, value: u32) -> Option<()>;
}

/// [`Peripheral`] in the form that the address space calls.
#[derive(Debug)]
struct Mapped(Arc<dyn Peripheral>);

impl MemOps for Mapped {
    fn read(&self, offset: u64, destination: &mut [u8], _: MemAttrs) -> MemResult {
        let bytes = destination.len().min(4);
        let value = self.0.read(offset as u32, bytes as u32).ok_or(BusError::Unassigned)?;
        destination[..bytes].copy_from_slice(&value.to_le_bytes()[..bytes]);
        Ok(())
    }

    fn write(&self, offset: u64, source: &[u8], _: MemAttrs) -> MemResult {
        let bytes = source.len().min(4);
        let mut value = [0; 4];
        value[..bytes].copy_from_slice(&source[..bytes]);
        self.0.write(offset as u32, bytes as u32, u32::from_le_bytes(value)).ok_or(BusError::Unassigned)
    }
}

/// Returns the width of an access of 1, 2 or 4 bytes.
#[inline]
fn width(bytes: u32) -> Width {
    match bytes {
        1 => Width::U8,
        2 => Width::U16,
        _ => Width::U32,
    }
}

/// One of the board's memories.
#[derive(Debug, Clone)]
struct Bank {
    address: u32,
    store: Arc<RamStore>,
}

/// Memories of the board, shared with the address space that the core executes from.
#[derive(Debug, Clone)]
pub(crate) struct Memory {
    banks: [Bank; 3],
}

impl Memory {
    /// Makes zeroed RAM and CCM, erased flash, and the address space that contains them.
    pub(crate) fn new() -> Result<(Memory, AddressSpace), RunError> {
        let space = AddressSpace::new("cpu", 32);
        let bank = |address, bytes: u32| Bank { address, store: Arc::new(RamStore::new(u64::from(bytes))) };
        let banks = [bank(FLASH_ADDRESS, FLASH_BYTES), bank(RAM_ADDRESS, RAM_BYTES), bank(CCM_ADDRESS, CCM_BYTES)];
        for (bank, (name, permissions)) in
            banks.iter().zip([("flash", Perms::RX), ("ram", Perms::RWX), ("ccm", Perms::RW)])
        {
            let region = Region::ram(name, Arc::clone(&bank.store));
            space.topology().map_with_perms(region, u64::from(bank.address), permissions).map_err(|error| {
                RunError::Mapping { address: bank.address, bytes: bank.store.len() as u32, reason: error.to_string() }
            })?;
        }
        let memory = Memory { banks };
        let flash = &memory.banks[0].store;
        let _ = flash.fill(0, u64::from(FLASH_BYTES), 0xff);
        Ok((memory, space))
    }

    /// Returns the memory that contains all bytes, and the offset of the first byte in it.
    fn find(&self, address: u32, bytes: usize) -> Result<(&RamStore, u64), RunError> {
        let bank = self.banks.iter().find(|bank| {
            let offset = u64::from(address.wrapping_sub(bank.address));
            offset < bank.store.len() && bytes as u64 <= bank.store.len() - offset
        });
        let bank = bank.ok_or(RunError::NoMemory { address, bytes })?;
        Ok((&bank.store, u64::from(address - bank.address)))
    }

    /// Reads an aligned word, half or byte of flash, RAM or CCM. `None` if there is none.
    #[inline]
    pub(crate) fn load(&self, address: u32, bytes: u32) -> Option<u32> {
        let [flash, ram, ccm] = &self.banks;
        let bank = match address >> 28 {
            2 => ram,
            1 => ccm,
            _ => flash,
        };
        let offset = u64::from(address.wrapping_sub(bank.address));
        bank.store.read_value(offset, width(bytes), Endian::Little).ok().map(|value| value as u32)
    }

    /// Writes an aligned word, half or byte of RAM or CCM. `None` if there is none.
    #[inline]
    pub(crate) fn store(&self, address: u32, bytes: u32, value: u32) -> Option<()> {
        let [_, ram, ccm] = &self.banks;
        let bank = match address >> 28 {
            2 => ram,
            1 => ccm,
            _ => return None,
        };
        let offset = u64::from(address.wrapping_sub(bank.address));
        bank.store.write_value(offset, width(bytes), u64::from(value), Endian::Little).ok()
    }

    /// Copies bytes out of one memory: flash, RAM or CCM.
    pub(crate) fn read(&self, address: u32, destination: &mut [u8]) -> Result<(), RunError> {
        let (store, offset) = self.find(address, destination.len())?;
        let bytes = destination.len();
        store.read_at(offset, destination).map_err(|_| RunError::NoMemory { address, bytes })
    }

    /// Copies bytes into one memory: flash, as a programmer does, RAM or CCM.
    pub(crate) fn write(&self, address: u32, source: &[u8]) -> Result<(), RunError> {
        let (store, offset) = self.find(address, source.len())?;
        store.write_at(offset, source).map_err(|_| RunError::NoMemory { address, bytes: source.len() })
    }
}

/// Maps a device into the address space.
pub(crate) fn map(space: &AddressSpace, address: u32, bytes: u32, device: Arc<dyn Peripheral>) -> Result<(), RunError> {
    let region = Region::io("peripheral", u64::from(bytes), Arc::new(Mapped(device)));
    let mapped = space.topology().map(region, u64::from(address));
    mapped.map(drop).map_err(|error| RunError::Mapping { address, bytes, reason: error.to_string() })
}

/// Maps a device over the flash that takes the program's stores. Reads go to the memory as before.
pub(crate) fn map_flash_stores(space: &AddressSpace, device: Arc<dyn Peripheral>) -> Result<(), RunError> {
    let region = Region::io("flash stores", u64::from(FLASH_BYTES), Arc::new(Mapped(device)));
    let mapped = space.topology().map_with_perms(region, u64::from(FLASH_ADDRESS), Perms::WRITE);
    mapped.map(drop).map_err(|error| RunError::Mapping {
        address: FLASH_ADDRESS,
        bytes: FLASH_BYTES,
        reason: error.to_string(),
    })
}

/// Device that takes the program's reads of a part of memory.
#[derive(Debug)]
pub struct ReadTrap(MappingId);

/// Maps a device over a part of memory that takes the program's reads, until it is unmapped.
pub(crate) fn trap_reads(
    space: &AddressSpace,
    address: u32,
    bytes: u32,
    device: Arc<dyn Peripheral>,
) -> Result<ReadTrap, RunError> {
    let region = Region::io("read trap", u64::from(bytes), Arc::new(Mapped(device)));
    let mapping = Mapping::new(region, u64::from(address)).with_priority(1).with_perms(Perms::READ);
    let mapped = space.topology().map_with(mapping);
    mapped.map(ReadTrap).map_err(|error| RunError::Mapping { address, bytes, reason: error.to_string() })
}

/// Gives the reads of a trap back to the memory.
pub(crate) fn untrap_reads(space: &AddressSpace, trap: &ReadTrap) {
    // A trap is unmapped once, so its mapping is there.
    let _ = space.topology().unmap(trap.0);
}
