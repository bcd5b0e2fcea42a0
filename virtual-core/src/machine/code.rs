//! Every instruction of the program, decoded once, with how often it ran.

use crate::cycle::{Band, rules};
use crate::decode::{self, Instruction, Kind};
use crate::error::RunError;
use crate::machine::profile::Functions;
use crate::memory::{FLASH_ADDRESS, Memory, RAM_ADDRESS, RAM_BYTES};

/// One place where an instruction can start.
#[derive(Debug, Clone, Copy)]
pub(super) struct Slot {
    pub(super) instruction: Instruction,
    pub(super) alone: Band,
    /// Index of the function it is in.
    pub(super) function: u16,
    decoded: bool,
    opcode: u32,
}

/// How often an instruction ran, and how often it jumped back.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Count {
    pub(super) executed: u64,
    pub(super) jumped_back: u64,
}

/// A stretch of memory that instructions run from; entry `n` of each table belongs to the address `base + 2 n`.
#[derive(Debug)]
pub(super) struct Region {
    pub(super) base: u32,
    pub(super) slots: Vec<Slot>,
    pub(super) counts: Vec<Count>,
}

impl Region {
    fn new(base: u32, bytes: u32) -> Region {
        let slot = Slot {
            instruction: Instruction::new(Kind::Undefined, 2),
            alone: Band::default(),
            function: 0,
            decoded: false,
            opcode: 0,
        };
        let slots = bytes.div_ceil(2) as usize;
        Region { base, slots: vec![slot; slots], counts: vec![Count::default(); slots] }
    }
}

/// The code in flash and, once something there runs, in RAM.
#[derive(Debug)]
pub(super) struct Code {
    pub(super) flash: Region,
    pub(super) ram: Option<Region>,
}

impl Code {
    /// For a program whose bytes in flash end at `flash_end`.
    pub(super) fn new(flash_end: u32) -> Code {
        Code { flash: Region::new(FLASH_ADDRESS, flash_end.saturating_sub(FLASH_ADDRESS)), ram: None }
    }

    /// The regions in use.
    pub(super) fn regions(&self) -> impl Iterator<Item = &Region> {
        std::iter::once(&self.flash).chain(&self.ram)
    }

    /// Forgets how often instructions ran.
    pub(super) fn clear_counts(&mut self) {
        for region in std::iter::once(&mut self.flash).chain(&mut self.ram) {
            region.counts.fill(Count::default());
        }
    }

    /// Forgets what was decoded in flash, because its bytes have changed.
    pub(super) fn flash_changed(&mut self) {
        self.flash.slots.iter_mut().for_each(|slot| slot.decoded = false);
    }

    /// The instruction at `address` and its counts; `None` where no instruction can be.
    #[inline]
    pub(super) fn at(&mut self, address: u32, memory: &Memory, functions: &Functions) -> Option<(&Slot, &mut Count)> {
        let index = (address.wrapping_sub(FLASH_ADDRESS) / 2) as usize;
        if index < self.flash.slots.len() {
            if !self.flash.slots[index].decoded {
                fill(&mut self.flash, index, address, memory, functions);
            }
            return Some((&self.flash.slots[index], &mut self.flash.counts[index]));
        }
        self.at_ram(address, memory, functions)
    }

    fn at_ram(&mut self, address: u32, memory: &Memory, functions: &Functions) -> Option<(&Slot, &mut Count)> {
        let offset = address.wrapping_sub(RAM_ADDRESS);
        if offset >= RAM_BYTES {
            return None;
        }
        let region = self.ram.get_or_insert_with(|| Region::new(RAM_ADDRESS, RAM_BYTES));
        let index = (offset / 2) as usize;
        // Stores can have changed it since.
        if !region.slots[index].decoded || region.slots[index].opcode != opcode(address, memory).ok()? {
            fill(region, index, address, memory, functions);
        }
        Some((&region.slots[index], &mut region.counts[index]))
    }
}

#[cold]
fn fill(region: &mut Region, index: usize, address: u32, memory: &Memory, functions: &Functions) {
    let opcode = opcode(address, memory).unwrap_or(0xde00_0000);
    let instruction = decode::decode(address, (opcode >> 16) as u16, opcode as u16);
    region.slots[index] = Slot {
        instruction,
        alone: rules::alone(&instruction),
        function: functions.index_at(address),
        decoded: true,
        opcode,
    };
}

/// The bits of the instruction at `address`, its first halfword high; the low half of a 16-bit one is 0.
pub(super) fn opcode(address: u32, memory: &Memory) -> Result<u32, RunError> {
    let mut halves = [[0; 2]; 2];
    memory.read(address, &mut halves[0])?;
    let first = u16::from_le_bytes(halves[0]);
    if decode::is_wide(first) {
        memory.read(address.wrapping_add(2), &mut halves[1])?;
    }
    Ok(u32::from(first) << 16 | u32::from(u16::from_le_bytes(halves[1])))
}

/// Whether the core may not be let execute it.
#[inline]
pub(super) fn stops(kind: Kind) -> bool {
    matches!(kind, Kind::Breakpoint | Kind::Undefined)
}
