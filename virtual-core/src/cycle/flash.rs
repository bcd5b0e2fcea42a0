//! Wait states of the STM32F4's flash behind its accelerator (ST RM0090 section 3.5, "Adaptive
//! real-time memory accelerator").
//!
//! The model has an instruction cache of 64 lines of 16 bytes, a data cache of 8 such lines and a
//! prefetch buffer of one line. Both caches are fully associative, evict the line longest unused,
//! and are empty when the machine is made.
//!
//! ```text
//! line of the last instruction      0 cycles
//! line of the instruction cache     0 cycles
//! line of the prefetch buffer       until its read ends; it is not cached
//! any other line                    until a read under way ends, and one of its own; it is cached
//! literal outside the data cache    until a read under way ends, and one of its own
//! ```
//!
//! A read takes one cycle more than there are wait states: 6 cycles at 168 MHz and 4 at 96 MHz.
//!
//! If the prefetch is on, each line that is used starts the read of the next line. The manual does
//! not say whether a line in the cache starts one, nor whether a branch ends one. The model assumes
//! what takes longer: a cached line starts a read, and a branch does not end it. Most lines of a
//! loop are then never cached, and each pass reads them from flash. That is why the firmware leaves
//! the prefetch off: 1025 modes and 100 bands struck each millisecond take up to 2879 cycles a
//! frame without it, and 3376 with it (`cargo test -p host-tests --test on_chip frames::engine_of
//! -- --nocapture`).
//!
//! The model leaves out:
//! - loads from flash through a pointer, which also use the 8 data lines: the columns are too low
//!   for code that reads tables in flash;
//! - contention between instructions and data but for the reads above;
//! - the order of words inside a line.

use crate::memory::{FLASH_ADDRESS, FLASH_BYTES};

/// Wait states at 168 MHz and 2.7 to 3.6 V (RM0090 table 10).
pub const WAIT_STATES_168_MHZ: u8 = 5;
/// Number of lines of the instruction cache.
pub const INSTRUCTION_LINES: usize = 64;
/// Number of lines of the data cache.
pub const DATA_LINES: usize = 8;
/// Number of bytes of a line.
pub const LINE_BYTES: u32 = 16;

/// Number of lines of flash.
const FLASH_LINES: u32 = FLASH_BYTES / LINE_BYTES;
/// Line that flash does not have.
const NO_LINE: u32 = u32::MAX;

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
            slot_of_line: vec![ABSENT; FLASH_LINES as usize],
            line_of_slot: vec![None; slots],
            newer: (0..slots).map(|index| slot(index + slots - 1)).collect(),
            older: (0..slots).map(|index| slot(index + 1)).collect(),
            newest: 0,
        }
    }

    fn holds(&self, line: u32) -> bool {
        self.slot_of_line[line as usize] != ABSENT
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

/// Switches of the accelerator (FLASH_ACR).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Switches {
    /// Wait states of a read. Without any, flash has no waits.
    pub wait_states: u8,
    /// True if the instruction cache is on.
    pub instructions: bool,
    /// True if the data cache is on.
    pub data: bool,
    /// True if the prefetch buffer is on.
    pub prefetch: bool,
}

impl Switches {
    /// Switches of the firmware at 168 MHz: both caches are on.
    pub const AT_168_MHZ: Switches =
        Switches { wait_states: WAIT_STATES_168_MHZ, instructions: true, data: true, prefetch: false };
}

/// Flash accelerator, which tells how many cycles an instruction waits for flash.
#[derive(Debug, Clone)]
pub struct Accelerator {
    instructions: Cache,
    data: Cache,
    switches: Switches,
    /// Line of the last instruction.
    current: u32,
    /// Line in the prefetch buffer, or on its way there.
    prefetched: u32,
    /// Cycle at which the read of flash ends that is under way, or was the last.
    reads_until: u64,
}

impl Default for Accelerator {
    fn default() -> Accelerator {
        Accelerator::new(Switches::AT_168_MHZ)
    }
}

impl Accelerator {
    /// Makes an accelerator with empty caches.
    pub fn new(switches: Switches) -> Accelerator {
        Accelerator {
            instructions: Cache::new(INSTRUCTION_LINES),
            data: Cache::new(DATA_LINES),
            switches,
            current: NO_LINE,
            prefetched: NO_LINE,
            reads_until: 0,
        }
    }

    /// Sets the switches. A cache keeps its lines while it is off.
    pub fn switch(&mut self, switches: Switches) {
        self.switches = switches;
    }

    /// Empties the caches and the prefetch buffer, and ends the read under way.
    pub fn clear(&mut self) {
        *self = Accelerator::new(self.switches);
    }

    /// Returns the cycles for which the instruction of `bytes` bytes at `address` waits at the
    /// cycle `now`. These are 0 outside flash.
    #[inline]
    pub fn fetch(&mut self, address: u32, bytes: u8, now: u64) -> u64 {
        let offset = address.wrapping_sub(FLASH_ADDRESS);
        let first = offset / LINE_BYTES;
        let last = (offset.wrapping_add(u32::from(bytes)).wrapping_sub(1)) / LINE_BYTES;
        if first == self.current && last == first {
            return 0;
        }
        self.fetch_lines(first, last, now)
    }

    fn fetch_lines(&mut self, first: u32, last: u32, now: u64) -> u64 {
        let current = std::mem::replace(&mut self.current, last);
        let mut at = now;
        if first < FLASH_LINES && first != current {
            at = self.fetch_line(first, at);
        }
        if last != first && last < FLASH_LINES && last != current {
            at = self.fetch_line(last, at);
        }
        at - now
    }

    /// Returns the cycle at which a line is there that is needed at the cycle `now`.
    fn fetch_line(&mut self, line: u32, now: u64) -> u64 {
        let there_at = if self.switches.instructions && self.instructions.holds(line) {
            self.instructions.touch(line);
            now
        } else if line == self.prefetched {
            now.max(self.reads_until)
        } else {
            if self.switches.instructions {
                self.instructions.touch(line);
            }
            self.read(now)
        };
        if self.switches.prefetch && self.prefetched != line + 1 {
            self.prefetched = line + 1;
            self.read(there_at);
        }
        there_at
    }

    /// Returns the cycle at which a read of flash ends that is asked for at the cycle `now`.
    fn read(&mut self, now: u64) -> u64 {
        let wait_states = u64::from(self.switches.wait_states);
        self.reads_until = now.max(self.reads_until) + if wait_states > 0 { wait_states + 1 } else { 0 };
        self.reads_until
    }

    /// Returns the cycles for which a literal waits that is read at the cycle `now`, 0 outside
    /// flash.
    pub fn load(&mut self, address: u32, now: u64) -> u64 {
        let line = address.wrapping_sub(FLASH_ADDRESS) / LINE_BYTES;
        if line < FLASH_LINES && (!self.switches.data || self.data.touch(line)) { self.read(now) - now } else { 0 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const LINES: u32 = INSTRUCTION_LINES as u32;
    /// Cycles of a read.
    const READ: u64 = WAIT_STATES_168_MHZ as u64 + 1;
    const WITH_PREFETCH: Switches = Switches { prefetch: true, ..Switches::AT_168_MHZ };

    /// Accelerator with a clock, which runs instructions of four bytes in one cycle each.
    struct Runner(Accelerator, u64);

    impl Runner {
        fn new(switches: Switches) -> Runner {
            Runner(Accelerator::new(switches), 0)
        }

        /// Runs the instructions of `bytes` bytes from `address` on; returns the cycles waited.
        fn run(&mut self, address: u32, bytes: u32) -> u64 {
            let mut waited = 0;
            for offset in (0..bytes).step_by(4) {
                let waits = self.0.fetch(address + offset, 4, self.1);
                self.1 += waits + 1;
                waited += waits;
            }
            waited
        }

        fn load(&mut self, line: u32) -> u64 {
            let waits = self.0.load(FLASH_ADDRESS + line * LINE_BYTES, self.1);
            self.1 += waits + 1;
            waits
        }
    }

    #[test]
    fn a_loop_that_fits_waits_once() {
        let mut runner = Runner::new(Switches::AT_168_MHZ);
        assert_eq!(runner.run(FLASH_ADDRESS, LINES * LINE_BYTES), READ * u64::from(LINES));
        assert_eq!(runner.run(FLASH_ADDRESS, LINES * LINE_BYTES), 0);
    }

    #[test]
    fn a_loop_one_line_too_long_waits_for_every_line_every_time() {
        let mut runner = Runner::new(Switches::AT_168_MHZ);
        for _ in 0..3 {
            assert_eq!(runner.run(FLASH_ADDRESS, (LINES + 1) * LINE_BYTES), READ * u64::from(LINES + 1));
        }
    }

    #[test]
    fn prefetch_leaves_straight_code_the_cycles_that_a_read_is_longer_than_its_line() {
        let mut runner = Runner::new(WITH_PREFETCH);
        // Four instructions a line, one cycle each.
        assert_eq!(runner.run(FLASH_ADDRESS, 10 * LINE_BYTES), READ + 9 * (READ - 4));
        // Line 0 alone was cached. The last prefetch, of line 10, goes on for two cycles.
        assert_eq!(runner.run(FLASH_ADDRESS, 3 * LINE_BYTES), 2 + 2 * (READ - 4));
    }

    #[test]
    fn branch_away_waits_for_the_prefetch_under_way() {
        let mut runner = Runner::new(WITH_PREFETCH);
        runner.run(FLASH_ADDRESS, 4);
        // One cycle of the prefetch has passed.
        assert_eq!(runner.run(FLASH_ADDRESS + 10 * LINE_BYTES, 4), READ - 1 + READ);
        assert_eq!(runner.load(20), READ - 1 + READ);
    }

    #[test]
    fn the_line_longest_unused_is_evicted() {
        let mut runner = Runner::new(Switches::AT_168_MHZ);
        for line in 0..8 {
            assert_eq!(runner.load(line), READ);
        }
        assert_eq!(runner.load(0), 0);
        assert_eq!(runner.load(8), READ, "evicts line 1");
        assert_eq!(runner.load(0), 0);
        assert_eq!(runner.load(1), READ, "evicts line 2");
        assert_eq!(runner.load(3), 0);
        assert_eq!(runner.load(2), READ);
    }

    #[test]
    fn an_instruction_across_two_lines_needs_both() {
        let mut accelerator = Accelerator::new(Switches::AT_168_MHZ);
        assert_eq!(accelerator.fetch(FLASH_ADDRESS + 14, 4, 0), 2 * READ);
        assert_eq!(accelerator.fetch(FLASH_ADDRESS + 12, 2, 20), 0);
    }

    #[test]
    fn without_its_caches_every_line_and_literal_waits() {
        let off = Switches { instructions: false, data: false, ..Switches::AT_168_MHZ };
        let mut runner = Runner::new(off);
        for _ in 0..2 {
            assert_eq!(runner.run(FLASH_ADDRESS, 4 * LINE_BYTES), 4 * READ);
            assert_eq!(runner.load(0), READ);
        }
        runner.0.switch(Switches::AT_168_MHZ);
        assert_eq!(runner.run(FLASH_ADDRESS, 4 * LINE_BYTES), 4 * READ);
        assert_eq!(runner.run(FLASH_ADDRESS, 4 * LINE_BYTES), 0);
    }

    #[test]
    fn ram_and_flash_without_wait_states_do_not_wait() {
        let mut accelerator = Accelerator::default();
        assert_eq!(accelerator.fetch(0x2000_0000, 4, 0) + accelerator.load(0x2000_0100, 0), 0);
        accelerator.switch(Switches { wait_states: 0, ..Switches::AT_168_MHZ });
        assert_eq!(accelerator.fetch(FLASH_ADDRESS, 4, 0) + accelerator.load(FLASH_ADDRESS, 0), 0);
    }
}
