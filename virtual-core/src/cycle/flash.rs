//! Wait states of the STM32F4's flash behind its accelerator (ST RM0090 section 3.5, "Adaptive
//! real-time memory accelerator").
//!
//! The model has an instruction cache of 64 lines of 16 bytes and a data cache of 8 lines of 16
//! bytes. Both are fully associative, evict the line longest unused, and are empty when the machine
//! is made. An instruction waits for a refill for each line that it needs and that is not cached:
//! one line, or two if it straddles them. A literal load from flash waits for a line of the data
//! cache. A refill takes 6 cycles at 168 MHz (5 wait states) and 4 at 96 MHz (3 wait states),
//! beyond the nominal cost.
//!
//! The model leaves out:
//! - the prefetch buffer, which hides a part of the refills of straight code: the columns are too
//!   high for code that runs once;
//! - loads from flash through a pointer, which also use the 8 data lines: the columns are too low
//!   for code that reads tables in flash;
//! - contention between instructions and data;
//! - the order of words inside a refill.

use crate::memory::{FLASH_ADDRESS, FLASH_BYTES};

/// Cycles of a refill at 168 MHz, with 5 wait states.
pub const REFILL_CYCLES_168_MHZ: u64 = 6;
/// Cycles of a refill at 96 MHz, with 3 wait states.
pub const REFILL_CYCLES_96_MHZ: u64 = 4;
/// Number of lines of the instruction cache.
pub const INSTRUCTION_LINES: usize = 64;
/// Number of lines of the data cache.
pub const DATA_LINES: usize = 8;
/// Number of bytes of a line.
pub const LINE_BYTES: u32 = 16;

/// Slot of a line that is not cached.
const ABSENT: u8 = u8::MAX;

/// Fully associative cache that evicts the line longest unused.
#[derive(Debug, Clone)]
struct Cache {
    /// Slot that holds each line of flash, or [`ABSENT`].
    slot_of_line: Vec<u8>,
    /// Line in each slot, if any.
    line_of_slot: Vec<Option<u32>>,
    /// Slot that was used next after each slot, in a ring that closes at `newest`.
    newer: Vec<u8>,
    /// Slot that was used last before each slot, in a ring that closes at `newest`.
    older: Vec<u8>,
    /// Slot that was used last. The slot longest unused is its newer neighbour.
    newest: u8,
}

impl Cache {
    fn new(slots: usize) -> Cache {
        let slot = |index: usize| (index % slots) as u8;
        Cache {
            slot_of_line: vec![ABSENT; (FLASH_BYTES / LINE_BYTES) as usize],
            line_of_slot: vec![None; slots],
            newer: (0..slots).map(|index| slot(index + slots - 1)).collect(),
            older: (0..slots).map(|index| slot(index + 1)).collect(),
            newest: 0,
        }
    }

    /// Uses a line of flash; returns true if it had to be fetched.
    fn touch(&mut self, line: u32) -> bool {
        let held = self.slot_of_line[line as usize];
        let missed = held == ABSENT;
        let slot = if missed { self.newer[usize::from(self.newest)] } else { held };
        if missed {
            if let Some(evicted) = self.line_of_slot[usize::from(slot)].replace(line) {
                self.slot_of_line[evicted as usize] = ABSENT;
            }
            self.slot_of_line[line as usize] = slot;
        }
        self.make_newest(slot);
        missed
    }

    fn make_newest(&mut self, slot: u8) {
        if slot == self.newest {
            return;
        }
        let at = usize::from(slot);
        let (before, after) = (self.newer[at], self.older[at]);
        self.older[usize::from(before)] = after;
        self.newer[usize::from(after)] = before;
        let head = self.newest;
        let tail = self.newer[usize::from(head)];
        self.newer[at] = tail;
        self.older[at] = head;
        self.older[usize::from(tail)] = slot;
        self.newer[usize::from(head)] = slot;
        self.newest = slot;
    }
}

/// Flash accelerator, which tells how many refills an instruction waits for.
#[derive(Debug, Clone)]
pub struct Accelerator {
    instructions: Cache,
    data: Cache,
    /// Line of the last instruction.
    current: u32,
    /// True if the instruction cache is on.
    instructions_on: bool,
    /// True if the data cache is on.
    data_on: bool,
}

impl Default for Accelerator {
    fn default() -> Accelerator {
        Accelerator::new()
    }
}

impl Accelerator {
    /// Makes an accelerator with empty caches, both on.
    pub fn new() -> Accelerator {
        Accelerator {
            instructions: Cache::new(INSTRUCTION_LINES),
            data: Cache::new(DATA_LINES),
            current: u32::MAX,
            instructions_on: true,
            data_on: true,
        }
    }

    /// Switches the instruction cache and the data cache on or off.
    ///
    /// Without the instruction cache every line waits that is not that of the last instruction;
    /// without the data cache every literal waits. A cache keeps its lines while it is off.
    pub fn switch(&mut self, instructions: bool, data: bool) {
        self.instructions_on = instructions;
        self.data_on = data;
    }

    /// Returns the number of refills before the instruction of `bytes` bytes at `address` can run.
    ///
    /// It is 0 outside flash.
    #[inline]
    pub fn fetch(&mut self, address: u32, bytes: u8) -> u64 {
        let offset = address.wrapping_sub(FLASH_ADDRESS);
        let first = offset / LINE_BYTES;
        let last = (offset.wrapping_add(u32::from(bytes)).wrapping_sub(1)) / LINE_BYTES;
        if first == self.current && last == first {
            return 0;
        }
        self.fetch_lines(first, last)
    }

    fn fetch_lines(&mut self, first: u32, last: u32) -> u64 {
        let current = std::mem::replace(&mut self.current, last);
        let lines = (first..=last).filter(|&line| line < FLASH_BYTES / LINE_BYTES);
        if !self.instructions_on {
            return lines.filter(|&line| line != current).count() as u64;
        }
        lines.filter(|&line| self.instructions.touch(line)).count() as u64
    }

    /// Returns the number of refills before a literal at `address` is read, 0 outside flash.
    pub fn load(&mut self, address: u32) -> u64 {
        let line = address.wrapping_sub(FLASH_ADDRESS) / LINE_BYTES;
        u64::from(line < FLASH_BYTES / LINE_BYTES && (!self.data_on || self.data.touch(line)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const LINES: u32 = INSTRUCTION_LINES as u32;

    fn run(accelerator: &mut Accelerator, bytes: u32) -> u64 {
        (0..bytes).step_by(4).map(|offset| accelerator.fetch(FLASH_ADDRESS + offset, 4)).sum()
    }

    #[test]
    fn a_loop_that_fits_waits_once() {
        let mut accelerator = Accelerator::new();
        assert_eq!(run(&mut accelerator, LINES * LINE_BYTES), u64::from(LINES));
        assert_eq!(run(&mut accelerator, LINES * LINE_BYTES), 0);
    }

    #[test]
    fn a_loop_one_line_too_long_waits_for_every_line_every_time() {
        let mut accelerator = Accelerator::new();
        for _ in 0..3 {
            assert_eq!(run(&mut accelerator, (LINES + 1) * LINE_BYTES), u64::from(LINES) + 1);
        }
    }

    #[test]
    fn the_line_longest_unused_is_evicted() {
        let mut accelerator = Accelerator::new();
        let line = |index: u32| FLASH_ADDRESS + index * LINE_BYTES;
        for index in 0..8 {
            assert_eq!(accelerator.load(line(index)), 1);
        }
        assert_eq!(accelerator.load(line(0)), 0);
        assert_eq!(accelerator.load(line(8)), 1, "evicts line 1");
        assert_eq!(accelerator.load(line(0)), 0);
        assert_eq!(accelerator.load(line(1)), 1, "evicts line 2");
        assert_eq!(accelerator.load(line(3)), 0);
        assert_eq!(accelerator.load(line(2)), 1);
    }

    #[test]
    fn an_instruction_across_two_lines_needs_both() {
        let mut accelerator = Accelerator::new();
        assert_eq!(accelerator.fetch(FLASH_ADDRESS + 14, 4), 2);
        assert_eq!(accelerator.fetch(FLASH_ADDRESS + 12, 2), 0);
    }

    #[test]
    fn without_its_caches_every_line_and_literal_waits() {
        let mut accelerator = Accelerator::new();
        accelerator.switch(false, false);
        for _ in 0..2 {
            assert_eq!(run(&mut accelerator, 4 * LINE_BYTES), 4);
            assert_eq!(accelerator.load(FLASH_ADDRESS), 1);
        }
        accelerator.switch(true, true);
        assert_eq!(run(&mut accelerator, 4 * LINE_BYTES), 4);
        assert_eq!(run(&mut accelerator, 4 * LINE_BYTES), 0);
    }

    #[test]
    fn ram_has_no_wait_states() {
        let mut accelerator = Accelerator::new();
        assert_eq!(accelerator.fetch(0x2000_0000, 4) + accelerator.load(0x2000_0100), 0);
    }
}
