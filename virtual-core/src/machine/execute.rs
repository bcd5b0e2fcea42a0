//! Loop that executes instructions and charges their cost.

use std::ops::RangeInclusive;

use rsemu::cpu::arm::v7m::isa::Cond;

use super::Machine;
use super::clock::ExceptionChange;
use super::{catch, code};
use crate::cpu::{Core, CpuFault, Direct, Stepped};
use crate::cycle::hazard::Previous;
use crate::cycle::rules;
use crate::decode::{Flow, Instruction, Kind};
use crate::error::{Access, RunError};

/// Numbers of the exceptions that are faults: hard fault, memory management, bus and usage fault.
const FAULTS: RangeInclusive<u16> = 3..=6;

/// Reason for which [`Machine::execute`] ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Ended {
    /// The program counter is the address that was to be reached.
    Arrived,
    /// The next instruction is the breakpoint of this number, which is not executed.
    Breakpoint(u8),
    /// A debug probe has halted the core where it entered a fault.
    Caught,
    /// The core sleeps after WFI or WFE.
    Asleep,
    /// The limit of instructions is reached.
    Limit,
    /// The time at which the clock lets the machine pause is reached.
    Due,
}

impl Machine {
    /// Executes from the program counter to the address `arrival`, at most `limit` instructions.
    pub(super) fn execute(&mut self, arrival: u32, limit: u64) -> Result<Ended, RunError> {
        let mut pc = self.core.pc();
        let mut from = pc;
        let mut remaining = limit;
        let mut asleep = self.core.is_asleep();
        loop {
            if pc == arrival {
                return Ok(Ended::Arrived);
            }
            if remaining == 0 {
                return self.at_limit(pc);
            }
            let now = self.now();
            if now >= self.clock.due() {
                return Ok(Ended::Due);
            }
            self.clock.set_now(now);
            remaining -= 1;
            let Some((slot, count)) = self.code.at(pc, &self.memory, &self.functions) else {
                return Err(self.address_error(Access::Fetch, pc, from));
            };
            // A copy of all its fields would take longer than most instructions do.
            let instruction = &slot.instruction;
            let function = slot.function;
            let mut alone = slot.alone;
            if slot.is_special {
                if code::stops(instruction.kind) && !(self.fault_expected && instruction.kind == Kind::Undefined) {
                    let (kind, comment) = (instruction.kind, instruction.comment);
                    return self.at_stop(kind, comment, pc);
                }
                if let Kind::Divide { signed } = instruction.kind {
                    let [dividend, divisor] = instruction.operands.map(|register| self.core.register(register));
                    alone = rules::division(signed, dividend, divisor);
                }
            }
            let passed = !self.in_block || in_block_passes(&self.core, &mut self.in_block);

            let stepped = if !asleep && self.core.step_itself(instruction, self.in_block) {
                Stepped::Instruction
            } else {
                let origin = &mut self.cycle_counter_origin;
                let stepped = leave(&mut self.core, instruction, self.in_block, self.has_probe, now, origin);
                asleep = asleep && self.core.is_asleep();
                if asleep {
                    return Ok(Ended::Asleep);
                }
                stepped
            };
            if !self.functions.is_current(function) {
                self.functions.enter(function, self.total);
            }
            let next = pc.wrapping_add(u32::from(instruction.bytes));
            if let Stepped::Exception(number) = stepped {
                if FAULTS.contains(&number) && !std::mem::take(&mut self.fault_expected) {
                    let kind = instruction.kind;
                    return Err(self.fault_error(kind, pc));
                }
                if self.has_probe && catch::catches(&self.core, number) {
                    return Ok(Ended::Caught);
                }
                // The exception was entered before the instruction, unless this is the SVC that
                // raised it.
                if instruction.kind == Kind::SupervisorCall {
                    count.executed += 1;
                    let waits = self.accelerator.fetch(pc, instruction.bytes, self.total.with_flash());
                    self.total.charge(alone, waits);
                }
                let cycle = self.now();
                record_exceptions(&mut self.exception_changes, &self.core, cycle, self.total.instructions);
                self.total.wait(rules::EXCEPTION_ENTRY, 0);
                self.previous = Previous::NOTHING;
                self.in_block = false;
                self.lowest_stack = self.lowest_stack.min(self.core.register(13));
                from = pc;
                pc = self.core.pc();
                continue;
            }

            count.executed += 1;
            let mut waits = self.accelerator.fetch(pc, instruction.bytes, self.total.with_flash());
            let mut band = alone;
            if passed {
                if self.previous.affects(slot.reads) {
                    band = self.previous.cost(instruction, alone);
                }
                self.previous = slot.previous;
            } else {
                band = rules::SKIPPED;
                self.previous = Previous::NOTHING;
            }
            from = pc;
            pc = match instruction.flow {
                Flow::Next => next,
                _ if !passed => next,
                Flow::Always => instruction.target,
                Flow::Conditional | Flow::Computed => self.core.pc(),
            };
            if pc != next {
                band = band + rules::REFILL;
                self.previous = Previous::NOTHING;
                if stepped == Stepped::Return {
                    let cycle = self.pace.cycles(&self.total).wrapping_add_signed(self.cycles_beyond_cost);
                    record_exceptions(&mut self.exception_changes, &self.core, cycle, self.total.instructions);
                    band = band + rules::EXCEPTION_RETURN;
                    // The interrupted code may have been inside an IT block.
                    self.in_block = true;
                } else if pc <= from && instruction.jumps() && self.functions.index_at(pc) == function {
                    count.jumped_back += 1;
                }
            } else if instruction.kind == Kind::IfThen {
                self.in_block = true;
            } else if instruction.kind == Kind::Wait && self.core.is_asleep() {
                self.total.charge(band, waits);
                return Ok(Ended::Asleep);
            }
            if instruction.is_literal_load() && passed {
                waits += self.accelerator.load(instruction.target, self.total.with_flash() + waits);
            }
            self.total.charge(band, waits);
            if instruction.moves_stack() {
                self.lowest_stack = self.lowest_stack.min(self.core.register(13));
            }
        }
    }

    #[cold]
    fn at_limit(&self, pc: u32) -> Result<Ended, RunError> {
        if self.core.is_locked_up() {
            let function = self.functions.name_at(pc);
            return Err(RunError::Fault { fault: "a fault inside a fault (lock-up)", pc, function });
        }
        Ok(Ended::Limit)
    }

    #[cold]
    fn at_stop(&self, kind: Kind, comment: u8, pc: u32) -> Result<Ended, RunError> {
        if kind == Kind::Breakpoint {
            return Ok(Ended::Breakpoint(comment));
        }
        let opcode = code::opcode(pc, &self.memory)?;
        Err(RunError::Undefined { pc, opcode, function: self.functions.name_at(pc) })
    }

    fn address_error(&self, access: Access, address: u32, pc: u32) -> RunError {
        RunError::Address { access, address, pc, function: self.functions.name_at(pc) }
    }

    #[cold]
    fn fault_error(&self, kind: Kind, pc: u32) -> RunError {
        match self.core.fault() {
            CpuFault::Bus { address, fetch: true } => self.address_error(Access::Fetch, address, pc),
            CpuFault::Bus { address, fetch: false } => {
                self.address_error(if kind.is_store() { Access::Write } else { Access::Read }, address, pc)
            }
            CpuFault::Undefined => {
                let opcode = code::opcode(pc, &self.memory).unwrap_or(0);
                RunError::Undefined { pc, opcode, function: self.functions.name_at(pc) }
            }
            CpuFault::Other(fault) => RunError::Fault { fault, pc, function: self.functions.name_at(pc) },
        }
    }
}

/// Lets the core leave an instruction at the cycle `now` to `rsemu`, or enter an exception.
///
/// `origin` is the cycle at which the counter of the DWT was 0. The instruction may read that
/// counter, or set it.
fn leave(
    core: &mut Direct,
    instruction: &Instruction,
    in_block: bool,
    has_probe: bool,
    now: u64,
    origin: &mut u64,
) -> Stepped {
    let trace_block = instruction.address != 0 && core.is_in_trace_block(instruction.address);
    if trace_block && core.cycle_counter().is_some() {
        core.set_cycle_counter(now.wrapping_sub(*origin) as u32);
    }
    let stored =
        (has_probe && instruction.kind == Kind::StoreImmediate && core.is_in_system_block(instruction.address))
            .then(|| core.register(instruction.operands[0]));
    if stored.is_some() {
        catch::before_store(core);
    }
    let stepped = core.leave(instruction, in_block);
    if let Some(value) = stored {
        catch::after_store(core, value);
    }
    if trace_block && let Some(cycles) = core.cycle_counter() {
        *origin = now.wrapping_sub(u64::from(cycles));
    }
    stepped
}

/// Adds a change of exceptions to the record, if there is one.
fn record_exceptions(record: &mut Option<Vec<ExceptionChange>>, core: &impl Core, cycle: u64, instructions: u64) {
    let (running, depth) = core.exceptions();
    if let Some(changes) = record {
        changes.push(ExceptionChange { cycle, instructions, running, depth });
    }
}

/// Returns true if the IT block of the next instruction lets it execute, or if it is in none.
///
/// `in_block` becomes false if the instruction is in no IT block.
fn in_block_passes(core: &impl Core, in_block: &mut bool) -> bool {
    let status = core.status();
    let state = (status >> 8 & 0xfc) | (status >> 25 & 3);
    if state == 0 {
        *in_block = false;
        return true;
    }
    Cond((state >> 4) as u8).passes(status)
}
