//! Wait states of the STM32F4's flash behind its accelerator (ST RM0090 section 3.5, "Adaptive real-time memory accelerator").
//!
//! Modelled: the instruction cache of 64 lines of 16 bytes and the data cache of 8 such lines, each fully associative and evicting the
//! line longest unused, empty when the machine is made. An instruction whose bytes lie in a line that is not there waits
//! for a refill, one that straddles two lines for each of them; a literal load from flash likewise through the data lines.
//! A refill is 6 cycles at 168 MHz (5 wait states) and 4 at 96 MHz (3 wait states), beyond the nominal cost.
//!
//! Not modelled: the prefetch buffer (it hides part of the refills of straight code, so the columns are high for code that runs once),
//! loads from flash through a pointer (they go through the same 8 data lines and are left out, so the columns are low for
//! code that reads tables in flash), contention between both sides, and critical-word order inside a refill.

use crate::memory::{FLASH_ADDRESS, FLASH_BYTES};

/// Cycles of a refill at 168 MHz, 5 wait states.
pub const REFILL_CYCLES_168_MHZ: u64 = 6;
/// Cycles of a refill at 96 MHz, 3 wait states.
pub const REFILL_CYCLES_96_MHZ: u64 = 4;
/// Lines of the instruction cache.
pub const INSTRUCTION_LINES: usize = 64;
/// Lines of the data cache.
pub const DATA_LINES: usize = 8;
/// Bytes of a line.
pub const LINE_BYTES: u32 = 16;

const ABSENT: u8 = u8::MAX;

/// A fully associative cache that evicts the line longest unused.
#[derive(Debug, Clone)]
struct Cache {
    /// For every line of flash the slot that holds it, or [`ABSENT`].
    slot_of_line: Vec<u8>,
    /// For every slot the line in it, if any.
    line_of_slot: Vec<Option<u32>>,
    /// Slots from the one used last to the one longest unused, as a ring of both neighbours; `newest` is its start.
    newer: Vec<u8>,
    older: Vec<u8>,
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

    /// Uses that line of flash; whether it had to be fetched.
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

/// The flash accelerator: says how many refills an instruction waits for.
#[derive(Debug, Clone)]
pub struct Accelerator {
    instructions: Cache,
    data: Cache,
    current: u32,
    instructions_on: bool,
    data_on: bool,
}

impl Default for Accelerator {
    fn default() -> Accelerator {
        Accelerator::new()
    }
}

impl Accelerator {
    /// With empty caches.
    pub fn new() -> Accelerator {
        Accelerator {
            instructions: Cache::new(INSTRUCTION_LINES),
            data: Cache::new(DATA_LINES),
            current: u32::MAX,
            instructions_on: true,
            data_on: true,
        }
    }

    /// Switches the instruction and the data cache. Without them every line that is not the one being executed waits, and every
    /// literal. A cache keeps its lines while it is off.
    pub fn switch(&mut self, instructions: bool, data: bool) {
        self.instructions_on = instructions;
        self.data_on = data;
    }

    /// Refills before the instruction of that length at `address` can run; none outside flash.
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

    /// Refills before a literal at `address` is there; none outside flash.
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
