//! Instructions of the program, each decoded once, with counts of how often they ran.

use crate::cycle::hazard::{self, Previous};
use crate::cycle::{Band, rules};
use crate::decode::{self, Instruction, Kind};
use crate::error::RunError;
use crate::machine::profile::Functions;
use crate::memory::{FLASH_ADDRESS, Memory, RAM_ADDRESS, RAM_BYTES};

/// Address at which an instruction can start.
#[derive(Debug, Clone, Copy)]
pub(super) struct Slot {
    pub(super) instruction: Instruction,
    /// Cost of the instruction by itself.
    pub(super) alone: Band,
    /// Registers and access by which the instruction before may delay it ([`hazard::reads`]).
    pub(super) reads: u64,
    /// Instruction as the one after it sees it.
    pub(super) previous: Previous,
    /// True if the machine stops at the instruction, or if its cost depends on its operands.
    pub(super) is_special: bool,
    /// Index of the function that contains the instruction.
    pub(super) function: u16,
    /// True if the other fields are valid.
    decoded: bool,
    /// Bits of the instruction when it was decoded.
    opcode: u32,
}

/// Counts of an instruction.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Count {
    /// Number of times that it ran.
    pub(super) executed: u64,
    /// Number of times that it jumped back.
    pub(super) jumped_back: u64,
}

/// Memory from which instructions run. Entry `n` of each table belongs to address `base + 2 n`.
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
            reads: 0,
            previous: Previous::NOTHING,
            is_special: false,
            function: 0,
            decoded: false,
            opcode: 0,
        };
        let slots = bytes.div_ceil(2) as usize;
        Region { base, slots: vec![slot; slots], counts: vec![Count::default(); slots] }
    }
}

/// Code in flash and, once an instruction has run there, in RAM.
#[derive(Debug)]
pub(super) struct Code {
    pub(super) flash: Region,
    pub(super) ram: Option<Region>,
}

impl Code {
    /// Makes the code of a program whose bytes in flash end at `flash_end`, not decoded yet.
    pub(super) fn new(flash_end: u32) -> Code {
        Code { flash: Region::new(FLASH_ADDRESS, flash_end.saturating_sub(FLASH_ADDRESS)), ram: None }
    }

    /// Returns the regions in use.
    pub(super) fn regions(&self) -> impl Iterator<Item = &Region> {
        std::iter::once(&self.flash).chain(&self.ram)
    }

    /// Sets all counts to 0.
    pub(super) fn clear_counts(&mut self) {
        for region in std::iter::once(&mut self.flash).chain(&mut self.ram) {
            region.counts.fill(Count::default());
        }
    }

    /// Forgets the decoded instructions of some bytes in flash, because the bytes have changed.
    pub(super) fn flash_changed(&mut self, address: u32, bytes: usize) {
        let slots = &mut self.flash.slots;
        let offset = address.wrapping_sub(FLASH_ADDRESS) as usize;
        // An instruction may begin in the half-word before.
        let first = (offset / 2).saturating_sub(1).min(slots.len());
        let end = (offset + bytes).div_ceil(2).clamp(first, slots.len());
        slots[first..end].iter_mut().for_each(|slot| slot.decoded = false);
    }

    /// Returns the instruction at `address` and its counts, or `None` if no instruction can be
    /// there.
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
        // Stores can have changed the instruction since it was decoded.
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
        reads: hazard::reads(&instruction),
        previous: Previous::of(&instruction),
        is_special: stops(instruction.kind) || matches!(instruction.kind, Kind::Divide { .. }),
        function: functions.index_at(address),
        decoded: true,
        opcode,
    };
}

/// Returns the bits of the instruction at `address`, the first halfword high. The low half of a
/// 16-bit instruction is 0.
pub(super) fn opcode(address: u32, memory: &Memory) -> Result<u32, RunError> {
    let mut halves = [[0; 2]; 2];
    memory.read(address, &mut halves[0])?;
    let first = u16::from_le_bytes(halves[0]);
    if decode::is_wide(first) {
        memory.read(address.wrapping_add(2), &mut halves[1])?;
    }
    Ok(u32::from(first) << 16 | u32::from(u16::from_le_bytes(halves[1])))
}

/// Returns true if the machine stops at an instruction of this kind instead of executing it.
#[inline]
pub(super) fn stops(kind: Kind) -> bool {
    matches!(kind, Kind::Breakpoint | Kind::Undefined)
}
