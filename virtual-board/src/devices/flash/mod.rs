//! FLASH: wait states, the accelerator's switches, programming and erasing (RM0090 section 3,
//! RM0383 section 3).
//!
//! ```text
//! program ──registers──► keys, controls, flags ─► interrupt line
//!         ──stores─────► operation.rs ──────────► contents (virtual core), history
//! ```
//!
//! While an operation goes on, the core stands still, and everything else goes on. On silicon it is
//! the accesses to flash that wait. All programs here run from flash, so that no instruction comes
//! before the end; a program in RAM that begins an operation ends the run. Lines of the instruction
//! cache do not let the core go on either: the manuals promise nothing about them.
//!
//! Stores that a program makes reach the data cache as well, but erases do not. A read of an erased
//! sector through a data cache that may hold the sector's old bytes ends the run (RM0090 section
//! 3.7.6): a program resets the cache first.
//!
//! Mass erase, programming of 64 bits, read protection and the one-time memory are not modelled. An
//! alignment error (PGAERR) cannot happen without 64 bits.

mod board;
mod key;
mod operation;

pub(crate) use board::stale_read;

use super::{Access, Context, Problem, Unmodelled};
use virtual_core::cycle::flash::Switches;

use crate::chip::Chip;
use crate::flash::{FlashHistory, FlashMemory, FlashTimes, Parallelism};
use key::Key;
use operation::{Faults, Operation};

/// Bits of FLASH_ACR.
mod access {
    pub(super) const LATENCY: u32 = 7;
    pub(super) const PREFETCH: u32 = 1 << 8;
    pub(super) const INSTRUCTION_CACHE: u32 = 1 << 9;
    pub(super) const DATA_CACHE: u32 = 1 << 10;
    pub(super) const INSTRUCTION_RESET: u32 = 1 << 11;
    pub(super) const DATA_RESET: u32 = 1 << 12;
    pub(super) const ALL: u32 = LATENCY | PREFETCH | INSTRUCTION_CACHE | DATA_CACHE | INSTRUCTION_RESET | DATA_RESET;
}

/// Bits of FLASH_SR.
mod status {
    pub(super) const EOP: u32 = 1 << 0;
    pub(super) const OPERR: u32 = 1 << 1;
    pub(super) const WRPERR: u32 = 1 << 4;
    pub(super) const PGAERR: u32 = 1 << 5;
    pub(super) const PGPERR: u32 = 1 << 6;
    pub(super) const PGSERR: u32 = 1 << 7;
    pub(super) const BSY: u32 = 1 << 16;
    /// Flags that writing 1 clears.
    pub(super) const CLEARED: u32 = EOP | OPERR | WRPERR | PGAERR | PGPERR | PGSERR;
}

/// Bits of FLASH_CR.
mod control {
    pub(super) const PG: u32 = 1 << 0;
    pub(super) const SER: u32 = 1 << 1;
    pub(super) const MER: u32 = 1 << 2;
    pub(super) const STRT: u32 = 1 << 16;
    pub(super) const EOPIE: u32 = 1 << 24;
    pub(super) const ERRIE: u32 = 1 << 25;
    pub(super) const LOCK: u32 = 1 << 31;
    /// Bits that stay as they are written.
    pub(super) const KEPT: u32 = PG | SER | MER | 0xf << 3 | 3 << 8 | EOPIE | ERRIE;
}

/// Bits of FLASH_OPTCR.
mod option {
    pub(super) const LOCK: u32 = 1 << 0;
    pub(super) const START: u32 = 1 << 1;
    pub(super) const BROWN_OUT: u32 = 3 << 2;
    /// Bits that protect the sectors while they are 0.
    pub(super) const PROTECTION: u32 = 0xfff << 16;
}

/// Keys of FLASH_KEYR.
const KEYS: [u32; 2] = [0x4567_0123, 0xcdef_89ab];
/// Keys of FLASH_OPTKEYR.
const OPTION_KEYS: [u32; 2] = [0x0819_2a3b, 0x4c5d_6e7f];

/// Flash controller. Its registers do not outlive a reset, the rest does.
#[derive(Debug)]
pub(crate) struct Flash {
    chip: Chip,
    /// FLASH_ACR.
    access: u32,
    /// Flags of FLASH_SR.
    status: u32,
    /// FLASH_CR without its lock.
    control: u32,
    key: Key,
    /// FLASH_OPTCR without its lock.
    option_control: u32,
    option_key: Key,
    /// True if the data cache may hold lines that were read since it was last reset.
    is_cached: bool,
    /// Sectors whose old bytes the data cache may hold, as bits.
    stale: u16,
    operation: Option<Operation>,
    /// Contents, which the machine has as well.
    memory: FlashMemory,
    history: FlashHistory,
    /// Ranges of the program in flash, as address and length in bytes.
    program: Vec<(u32, u32)>,
    times: FlashTimes,
    faults: Faults,
    /// Faults of the program that a chip would let pass, as sentences.
    warnings: Vec<String>,
}

impl Flash {
    /// Makes the controller of an erased flash.
    pub(crate) fn new(chip: Chip) -> Flash {
        let memory = FlashMemory::erased(chip);
        Flash {
            chip,
            access: 0,
            status: 0,
            control: 0,
            key: Key::default(),
            option_control: memory.options(),
            option_key: Key::default(),
            is_cached: false,
            stale: 0,
            operation: None,
            history: FlashHistory { start: memory.clone(), operations: Vec::new() },
            memory,
            program: Vec::new(),
            times: FlashTimes::default(),
            faults: Faults::default(),
            warnings: Vec::new(),
        }
    }

    /// Resets the registers. An operation must not be going on.
    pub(crate) fn reset(&mut self) {
        self.access = 0;
        self.status = 0;
        self.control = 0;
        self.key = Key::default();
        self.option_control = self.memory.options();
        self.option_key = Key::default();
        self.is_cached = false;
        self.stale = 0;
    }

    pub(crate) fn read(&self, offset: u32) -> Access<u32> {
        let running = |bit: u32| if self.operation.is_some() { bit } else { 0 };
        Ok(match offset {
            0x00 => self.access,
            0x04 | 0x08 => 0,
            0x0c => self.status | running(status::BSY),
            0x10 if self.key.is_open() => self.control | running(control::STRT),
            0x10 => self.control | control::LOCK,
            0x14 => self.option_control & !option::LOCK | u32::from(!self.option_key.is_open()),
            _ => return Err(Problem::register()),
        })
    }

    pub(crate) fn write(&mut self, offset: u32, value: u32, context: &Context<'_>) -> Access<()> {
        if self.operation.is_some() {
            return misuse("a register of FLASH is written while an operation goes on; wait until FLASH_SR.BSY is 0");
        }
        match offset {
            0x00 => self.write_access(value),
            0x04 => self.key.take(value, KEYS, "FLASH_KEYR"),
            0x08 => self.option_key.take(value, OPTION_KEYS, "FLASH_OPTKEYR"),
            0x0c => {
                self.status &= !(value & status::CLEARED);
                Ok(())
            }
            0x10 => self.write_control(value, context),
            0x14 => self.write_options(value, context),
            _ => Err(Problem::register()),
        }
    }

    fn write_access(&mut self, value: u32) -> Access<()> {
        let resets = value & (access::INSTRUCTION_RESET | access::DATA_RESET);
        let on = self.access & (access::INSTRUCTION_CACHE | access::DATA_CACHE);
        if resets & on << 2 != 0 {
            return misuse("FLASH_ACR: a cache is reset while it is on; switch it off first");
        }
        self.access = value & access::ALL;
        if value & access::DATA_RESET != 0 {
            self.is_cached = false;
            self.stale = 0;
        }
        self.is_cached |= value & access::DATA_CACHE != 0;
        Ok(())
    }

    fn write_control(&mut self, value: u32, context: &Context<'_>) -> Access<()> {
        if !self.key.is_open() {
            if value & !control::LOCK != self.control {
                self.warn("FLASH_CR is written while it is locked, which has no effect; write the keys to FLASH_KEYR");
            }
            return Ok(());
        }
        self.control = value & control::KEPT;
        if value & control::LOCK != 0 {
            self.key.lock();
        }
        if value & control::STRT == 0 {
            return Ok(());
        }
        match self.control & (control::PG | control::SER | control::MER) {
            control::SER => self.begin_erase((self.control >> 3 & 0xf) as u8, context),
            0 => misuse("FLASH_CR.STRT is set while neither SER nor MER says what to erase"),
            control::MER => Err(Unmodelled::new("a mass erase, which would erase the program").into()),
            _ => Err(Unmodelled::new("an erase while more than one of PG, SER and MER is set").into()),
        }
    }

    fn write_options(&mut self, value: u32, context: &Context<'_>) -> Access<()> {
        if !self.option_key.is_open() {
            self.warn("FLASH_OPTCR is written while it is locked, which has no effect");
            return Ok(());
        }
        if (value ^ self.memory.options()) & !(option::LOCK | option::START | option::BROWN_OUT | option::PROTECTION)
            != 0
        {
            return Err(Unmodelled::new("option bytes besides brown-out level and protection of sectors").into());
        }
        self.option_control = value & !option::START | option::LOCK;
        if value & option::LOCK != 0 {
            self.option_key.lock();
        }
        if value & option::START == 0 { Ok(()) } else { self.begin_options(context) }
    }

    /// Returns the parallelism of the next operation.
    fn parallelism(&self) -> Access<Parallelism> {
        let parallelism = Parallelism::of(self.control >> 8 & 3);
        parallelism.ok_or_else(|| Unmodelled::new("a parallelism of 64 bits, which takes a supply at VPP").into())
    }

    /// Raises an error flag.
    fn fail(&mut self, flag: u32) {
        self.status |= flag;
        if self.control & control::ERRIE != 0 {
            self.status |= status::OPERR;
        }
    }

    fn warn(&mut self, warning: &str) {
        self.warnings.push(warning.to_owned());
    }

    /// Returns true if the interrupt is asserted.
    pub(crate) fn is_asserted(&self) -> bool {
        self.status & status::EOP != 0 && self.control & control::EOPIE != 0
            || self.status & status::OPERR != 0 && self.control & control::ERRIE != 0
    }

    /// Returns the switches of the accelerator, and the wait states.
    pub(crate) fn switches(&self) -> Switches {
        let is_on = |bit| self.access & bit != 0;
        Switches {
            wait_states: (self.access & access::LATENCY) as u8,
            instructions: is_on(access::INSTRUCTION_CACHE),
            data: is_on(access::DATA_CACHE),
            prefetch: is_on(access::PREFETCH),
        }
    }

    /// Returns the sectors, as bits, that a read through the data cache might see as they were
    /// before their erase.
    pub(crate) fn stale_sectors(&self) -> u16 {
        if self.switches().data { self.stale } else { 0 }
    }
}

/// Returns the problem of an access that the manual forbids.
fn misuse<T>(reason: &str) -> Access<T> {
    Err(Problem::Misuse { reason: reason.to_owned() })
}
