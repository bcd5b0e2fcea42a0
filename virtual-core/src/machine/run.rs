//! Runs of a whole image from its vector table.

use std::sync::Arc;

use super::Machine;
use super::execute::Ended;
use crate::cpu::Core;
use crate::cycle::Cost;
use crate::cycle::hazard::Previous;
use crate::error::RunError;
use crate::memory::FLASH_ADDRESS;

/// Address to which no program comes, for runs that end otherwise.
const NOWHERE: u32 = u32::MAX;

/// Number of steps after which a sleeping core that its timer has not woken sleeps for ever: the
/// longest period of SysTick.
const LONGEST_SLEEP_STEPS: u32 = 1 << 24;

/// Reason for which a run paused.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Stop {
    /// The next instruction is `bkpt` of this number, which is not executed.
    Breakpoint(u8),
    /// A debug probe has halted the core where it entered a fault ([`Machine::catch_faults`]).
    Caught,
    /// The core sleeps after `wfi` or `wfe`, and no interrupt is pending.
    Asleep,
    /// The allowed number of instructions has been executed.
    Limit,
    /// The time at which the clock lets the machine pause is reached.
    Due,
}

/// Result and cost of a whole run.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Run {
    /// Number of the breakpoint that ended the run.
    pub breakpoint: u8,
    /// Value of r0 at the breakpoint, which is a result by convention.
    pub value: u32,
    /// Cost since the reset. Sleep costs nothing.
    pub cost: Cost,
}

impl Machine {
    /// Restarts the image from its vector table at the start of flash. RAM keeps its content.
    ///
    /// # Errors
    /// [`RunError::NoVectorTable`] if the first two words of the table cannot be a stack pointer
    /// and a Thumb address in the program.
    pub fn reset(&mut self) -> Result<(), RunError> {
        let mut words = [[0; 4]; 2];
        self.memory.read(FLASH_ADDRESS, &mut words[0])?;
        self.memory.read(FLASH_ADDRESS + 4, &mut words[1])?;
        let [stack, reset] = words.map(u32::from_le_bytes);
        let code = self.code.at(reset & !1, &self.memory, &self.functions).is_some();
        if reset & 1 == 0 || !code || stack % 4 != 0 || self.memory.read(stack.wrapping_sub(4), &mut words[0]).is_err()
        {
            return Err(RunError::NoVectorTable { address: FLASH_ADDRESS, stack, reset });
        }
        // A new core is made, because a reset clears all registers of the NVIC and of the system
        // control block.
        let debug = self.core.debug_monitor_control();
        self.core.power_on(Arc::clone(&self.space), FLASH_ADDRESS);
        self.core.reset();
        if self.has_probe {
            // Only power-on clears the bits of the debugger.
            self.core.set_debug_monitor_control(debug);
        }
        self.previous = Previous::NOTHING;
        self.in_block = false;
        self.lowest_stack = stack;
        Ok(())
    }

    /// Executes at most `instructions` instructions from the program counter, for boards that drive
    /// devices between pauses.
    ///
    /// A core that sleeps and is not woken by a pending interrupt stays where it is and reports
    /// [`Stop::Asleep`] at once.
    ///
    /// # Errors
    /// [`RunError`] at an unknown instruction or address, or a fault.
    pub fn resume(&mut self, instructions: u64) -> Result<Stop, RunError> {
        Ok(match self.execute(NOWHERE, instructions)? {
            Ended::Breakpoint(number) => Stop::Breakpoint(number),
            Ended::Asleep => Stop::Asleep,
            Ended::Caught => Stop::Caught,
            Ended::Limit | Ended::Arrived => Stop::Limit,
            Ended::Due => Stop::Due,
        })
    }

    /// Executes from the program counter until the machine's [`Clock`](super::Clock) lets it pause.
    ///
    /// # Errors
    /// [`RunError`] at an unknown instruction or address, or a fault.
    pub fn resume_until_due(&mut self) -> Result<Stop, RunError> {
        self.resume(u64::MAX)
    }

    /// Runs the whole image from its vector table until it meets a breakpoint.
    ///
    /// # Errors
    /// [`RunError`] if there is no vector table, at an unknown instruction or address or a fault,
    /// or if the core sleeps for ever or meets no breakpoint within the limit.
    pub fn run_image(&mut self, limit_instructions: u64) -> Result<Run, RunError> {
        self.reset()?;
        let before = self.total;
        let ended = self.execute_awake(NOWHERE, limit_instructions)?;
        let pc = self.core.pc();
        match ended {
            Ended::Breakpoint(breakpoint) => {
                Ok(Run { breakpoint, value: self.core.register(0), cost: self.total - before })
            }
            Ended::Asleep => Err(RunError::Asleep { pc, function: self.functions.name_at(pc) }),
            Ended::Limit | Ended::Arrived | Ended::Due | Ended::Caught => {
                Err(RunError::Limit { limit: limit_instructions, pc, function: self.functions.name_at(pc) })
            }
        }
    }

    /// Executes as [`Machine::execute`] does, and passes over sleep that an interrupt ends.
    ///
    /// Sleep of more than [`LONGEST_SLEEP_STEPS`] steps counts as endless.
    pub(super) fn execute_awake(&mut self, arrival: u32, limit: u64) -> Result<Ended, RunError> {
        let before = self.total.instructions;
        let mut asleep_steps = 0;
        loop {
            let spent = self.total.instructions - before;
            let ended = self.execute(arrival, limit.saturating_sub(spent))?;
            if ended != Ended::Asleep || asleep_steps > LONGEST_SLEEP_STEPS || !self.core.is_timer_running() {
                return Ok(ended);
            }
            let slept_on = self.total.instructions - before == spent;
            asleep_steps = if slept_on { asleep_steps + 1 } else { 0 };
        }
    }

    /// Returns the lowest stack pointer since the last reset or call. Its distance from the start
    /// of the stack is the number of bytes that were needed.
    pub fn lowest_stack(&self) -> u32 {
        self.lowest_stack
    }
}
