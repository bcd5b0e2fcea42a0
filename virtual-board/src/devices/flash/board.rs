//! Flash on its board: its power, its contents in the machine, and the core that waits for it.

use virtual_core::Machine;
use virtual_core::cycle::flash::Switches;

use super::Flash;
use super::operation::Faults;
use crate::devices::{Access, Context, Devices, Problem};
use crate::flash::{FlashHistory, FlashMemory, FlashTimes};
use crate::input::Fault;

impl Devices {
    /// Gives the board its flash at power-on, and the ranges of it that the program has.
    pub(crate) fn insert_flash(
        &mut self,
        memory: FlashMemory,
        program: Vec<(u32, u32)>,
        times: FlashTimes,
        faults: &[Fault],
    ) {
        let history = FlashHistory { start: memory.clone(), operations: Vec::new() };
        self.flash =
            Flash { memory, history, program, times, faults: Faults::of(faults), ..Flash::new(self.wiring.chip) };
        self.flash.reset();
    }

    /// Returns the flash as it is now, and all operations on it.
    pub(crate) fn flash_contents(&self) -> (&FlashMemory, &FlashHistory) {
        (&self.flash.memory, &self.flash.history)
    }

    /// Returns the switches of the flash accelerator, and the wait states.
    pub(crate) fn flash_switches(&self) -> Switches {
        self.flash.switches()
    }

    /// Returns true while an operation on flash goes on, for which the core waits.
    pub(crate) fn is_flash_busy(&self) -> bool {
        self.flash.next_event() != u64::MAX
    }

    /// Returns the sectors, as bits, that the data cache may hold as they were before their erase.
    pub(crate) fn stale_sectors(&self) -> u16 {
        self.flash.stale_sectors()
    }

    /// Takes a store of the program to flash.
    pub(crate) fn store_to_flash(&mut self, address: u32, bytes: u32, value: u32) -> Access<()> {
        let now = self.clock.now();
        let clocks = self.clocks;
        self.clock.pause_now();
        self.flash.store(address, bytes, value, &Context { now, seconds: self.seconds(now), clocks: &clocks })
    }

    /// Ends the operation on flash that is due.
    pub(in crate::devices) fn end_flash_operation(&mut self, now: u64, machine: &mut Machine) {
        self.is_power_lost |= self.flash.end(now, machine);
        self.flash.warnings.drain(..).for_each(|warning| self.recording.warn(&warning));
    }

    /// Breaks off the operation on flash that goes on, if there is one: the chip is reset, or its
    /// power is lost.
    pub(crate) fn break_flash_operation(&mut self, seed: u64, machine: &mut Machine) {
        self.flash.tear(seed, machine);
    }

    pub(in crate::devices) fn write_flash(&mut self, offset: u32, value: u32, context: &Context<'_>) -> Access<()> {
        let written = self.flash.write(offset, value, context);
        self.flash.warnings.drain(..).for_each(|warning| self.recording.warn(&warning));
        written?;
        self.clocks_changed(context.now)
    }
}

/// Returns the problem of a read of a sector through a data cache that may hold old bytes.
pub(crate) fn stale_read() -> Problem {
    Problem::Misuse {
        reason:
            "the sector was erased, and the data cache may hold what it was before; switch the cache off, reset it \
                 (FLASH_ACR.DCRST), and switch it on"
                .to_owned(),
    }
}
