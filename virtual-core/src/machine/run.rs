//! Running a whole image from its vector table.

use std::sync::Arc;

use super::Machine;
use super::execute::Ended;
use crate::cpu::{Core, Rsemu};
use crate::cycle::Cost;
use crate::cycle::hazard::Previous;
use crate::error::RunError;
use crate::memory::FLASH_ADDRESS;

/// No instruction is there, so that nothing arrives.
const NOWHERE: u32 = u32::MAX;

/// Steps that a sleeping core is given to be woken by its own timer: one period of SysTick at its longest.
const LONGEST_SLEEP_STEPS: u32 = 1 << 24;

/// Why a run paused.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Stop {
    /// At `bkpt #n`, which is not executed.
    Breakpoint(u8),
    /// After `wfi` or `wfe`, with nothing pending.
    Asleep,
    /// After as many instructions as were allowed.
    Limit,
    /// At the time that the clock names.
    Due,
}

/// A whole run.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Run {
    /// The number of the breakpoint that ended it.
    pub breakpoint: u8,
    /// What r0 held then: a result, by convention.
    pub value: u32,
    /// Its cost from the reset on; sleep costs nothing.
    pub cost: Cost,
}

impl Machine {
    /// Starts the image anew from its vector table at the start of flash. RAM keeps what it holds.
    ///
    /// # Errors
    /// [`RunError::NoVectorTable`] if the table's first two words cannot be a stack pointer and a Thumb address in the program.
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
        // A core of its own, because a reset leaves nothing of the NVIC's and the system control block's registers.
        self.core = Rsemu::new(Arc::clone(&self.space), FLASH_ADDRESS);
        self.core.reset();
        self.previous = Previous::NOTHING;
        self.in_block = false;
        self.lowest_stack = stack;
        Ok(())
    }

    /// Goes on from where the core is, for at most so many instructions. For boards that drive devices between pauses.
    ///
    /// A core that sleeps and is not woken by a pending interrupt stays where it is and reports [`Stop::Asleep`] at once.
    ///
    /// # Errors
    /// [`RunError`]: an unknown instruction or address, or a fault.
    pub fn resume(&mut self, instructions: u64) -> Result<Stop, RunError> {
        Ok(match self.execute(NOWHERE, instructions)? {
            Ended::Breakpoint(number) => Stop::Breakpoint(number),
            Ended::Asleep => Stop::Asleep,
            Ended::Limit | Ended::Arrived => Stop::Limit,
            Ended::Due => Stop::Due,
        })
    }

    /// As [`Machine::resume`], with no limit but the time that the machine's [`Clock`](super::Clock) names.
    ///
    /// # Errors
    /// As [`Machine::resume`].
    pub fn resume_until_due(&mut self) -> Result<Stop, RunError> {
        self.resume(u64::MAX)
    }

    /// Runs the whole image from its vector table until it meets a breakpoint.
    ///
    /// # Errors
    /// [`RunError`]: no vector table, an unknown instruction or address, a fault, sleep without end, or no breakpoint
    /// within the limit.
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
            Ended::Limit | Ended::Arrived | Ended::Due => {
                Err(RunError::Limit { limit: limit_instructions, pc, function: self.functions.name_at(pc) })
            }
        }
    }

    /// [`Machine::execute`], with sleep passed over until an interrupt ends it or none has come for [`LONGEST_SLEEP_STEPS`].
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

    /// The lowest stack pointer since the last reset or call: its distance from the top is the stack that was needed.
    pub fn lowest_stack(&self) -> u32 {
        self.lowest_stack
    }
}
