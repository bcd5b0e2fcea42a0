//! Operations: their conditions, their times, and their ends.

use std::time::Duration;

use virtual_core::Machine;

use super::{Flash, control, misuse, option, status};
use crate::chip::Sector;
use crate::devices::{Access, Context, Problem};
use crate::flash::{FlashChange, FlashEnding, FlashOperation};
use crate::input::Fault;

/// Operation that goes on.
#[derive(Debug, Clone, Copy)]
pub(super) struct Operation {
    at_s: f64,
    change: FlashChange,
    /// Cycle of its end.
    end: u64,
    /// Seed of what is left if power is lost at `end`, or `None` if the operation ends well.
    power_lost: Option<u64>,
}

/// Faults of single operations, by their numbers from 0 on.
#[derive(Debug, Default)]
pub(super) struct Faults {
    /// Operations that fail.
    failing: Vec<u64>,
    /// Operations in which power is lost, with the share of their time and the seed of what they
    /// leave.
    power_lost: Vec<(u64, f64, u64)>,
}

impl Faults {
    pub(super) fn of(faults: &[Fault]) -> Faults {
        let mut found = Faults::default();
        for fault in faults {
            match *fault {
                Fault::FlashError { nth } => found.failing.push(nth),
                Fault::PowerLostInFlash { nth, share, seed } => found.power_lost.push((nth, share, seed)),
                _ => {}
            }
        }
        found
    }
}

impl Flash {
    /// Takes a store of the program to flash.
    pub(super) fn store(&mut self, address: u32, bytes: u32, value: u32, context: &Context<'_>) -> Access<()> {
        if self.operation.is_some() {
            return misuse("flash is written while an operation goes on; wait until FLASH_SR.BSY is 0");
        }
        if !self.key.is_open() {
            return misuse("flash is written while FLASH_CR is locked");
        }
        let Some(sector) = self.chip.sector_at(address) else { return misuse("the chip has no flash there") };
        let parallelism = self.parallelism()?;
        if self.control & (control::PG | control::SER | control::MER) != control::PG {
            self.fail(status::PGSERR);
        } else if bytes != parallelism.bytes() {
            self.fail(status::PGPERR);
        } else if self.is_protected(sector) {
            self.fail(status::WRPERR);
        } else if self.is_program(address, bytes) {
            return misuse("the program overwrites itself");
        } else {
            // What was there is known at the end.
            let change = FlashChange::Program { address, bytes: bytes as u8, old: 0, new: value };
            self.begin(change, self.times.program(), context);
        }
        Ok(())
    }

    /// Begins to erase a sector.
    pub(super) fn begin_erase(&mut self, number: u8, context: &Context<'_>) -> Access<()> {
        let Some(&Sector { address, bytes }) = self.chip.sectors().get(usize::from(number)) else {
            let reason = format!("FLASH_CR.SNB is {number}; the {} has no such sector", self.chip.name());
            return Err(Problem::Misuse { reason });
        };
        let parallelism = self.parallelism()?;
        if self.is_protected(number) {
            self.fail(status::WRPERR);
        } else if self.is_program(address, bytes) {
            return misuse(&format!("sector {number}, which the program erases, contains the program"));
        } else {
            let change = FlashChange::Erase { sector: number };
            self.begin(change, self.times.erase(bytes, parallelism), context);
        }
        Ok(())
    }

    /// Begins to write the option bytes.
    pub(super) fn begin_options(&mut self, context: &Context<'_>) -> Access<()> {
        let change = FlashChange::Options { old: self.memory.options(), new: self.option_control };
        self.begin(change, self.times.options(), context);
        Ok(())
    }

    /// Begins an operation, unless it is one that is to fail.
    fn begin(&mut self, change: FlashChange, time: Duration, context: &Context<'_>) {
        let number = self.history.operations.len() as u64;
        if self.faults.failing.contains(&number) {
            self.fail(status::WRPERR);
            self.history.operations.push(FlashOperation { at_s: context.seconds, change, ending: FlashEnding::Failed });
            return;
        }
        let lost = self.faults.power_lost.iter().find(|lost| lost.0 == number);
        let share = lost.map_or(1.0, |lost| lost.1.clamp(0.0, 1.0));
        let cycles = (time.as_secs_f64() * share * context.clocks.core.as_f64()).ceil() as u64;
        self.operation = Some(Operation {
            at_s: context.seconds,
            change,
            end: context.now + cycles,
            power_lost: lost.map(|lost| lost.2),
        });
    }

    /// Returns the cycle at which the operation that goes on ends.
    pub(crate) fn next_event(&self) -> u64 {
        self.operation.map_or(u64::MAX, |operation| operation.end)
    }

    /// Ends the operation that goes on, if it is due. Returns true if power is lost.
    pub(super) fn end(&mut self, now: u64, machine: &mut Machine) -> bool {
        let Some(operation) = self.operation.filter(|operation| operation.end <= now) else { return false };
        if let Some(seed) = operation.power_lost {
            self.tear(seed, machine);
            return true;
        }
        self.operation = None;
        if self.control & control::EOPIE != 0 {
            self.status |= status::EOP;
        }
        self.finish(operation, FlashEnding::Done, machine);
        false
    }

    /// Breaks the operation that goes on off, if there is one.
    pub(super) fn tear(&mut self, seed: u64, machine: &mut Machine) {
        if let Some(operation) = self.operation.take() {
            self.finish(operation, FlashEnding::Torn { seed }, machine);
        }
    }

    /// Changes the contents as the operation does, and records it.
    fn finish(&mut self, operation: Operation, ending: FlashEnding, machine: &mut Machine) {
        let mut change = operation.change;
        if let FlashChange::Program { address, bytes, old, new } = &mut change {
            let mut word = [0; 4];
            let width = usize::from(*bytes);
            word[..width].copy_from_slice(self.memory.read(*address, width).unwrap_or(&[0xff; 4][..width]));
            *old = u32::from_le_bytes(word);
            if *new & !*old != 0 {
                self.warnings.push(format!(
                    "flash at {address:#010x} holds {old:#x} and is programmed with {new:#x}; a bit becomes 1 only by \
                     an erase"
                ));
            }
            *new &= *old;
        }
        self.history.operations.push(FlashOperation { at_s: operation.at_s, change, ending });
        match ending {
            FlashEnding::Torn { seed } => self.memory.tear(&change, seed),
            _ => self.memory.apply(&change),
        }
        let (first, bytes) = match change {
            FlashChange::Program { address, bytes, .. } => (address, u32::from(bytes)),
            FlashChange::Erase { sector } => {
                if self.is_cached {
                    self.stale |= 1 << sector;
                }
                let Sector { address, bytes } = self.chip.sectors()[usize::from(sector)];
                (address, bytes)
            }
            FlashChange::Options { .. } => {
                self.option_control = self.memory.options();
                return;
            }
        };
        // The range lies in flash, which memory and machine have.
        let _ = machine.write(first, self.memory.read(first, bytes as usize).unwrap_or_default());
    }

    fn is_protected(&self, sector: u8) -> bool {
        self.memory.options() & 1 << (16 + sector) & option::PROTECTION == 0
    }

    /// Returns true if the program has bytes in a range of flash.
    fn is_program(&self, address: u32, bytes: u32) -> bool {
        self.program.iter().any(|&(first, length)| address < first + length && first < address + bytes)
    }
}
