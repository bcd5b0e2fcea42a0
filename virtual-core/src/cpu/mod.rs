//! Processor, as far as the machine needs it: one trait round the two cores that execute the
//! instructions. They know nothing of cycles, which [`crate::cycle`] charges.
//!
//! `direct` executes the common instructions, those of the FPU included, and has `rsemu` for all
//! others.

mod direct;
mod rsemu;

pub use direct::Direct;

/// Address of the block of DWT registers.
const DWT_ADDRESS: u32 = 0xe000_1000;

/// Address of the block of system registers.
const SYSTEM_ADDRESS: u32 = 0xe000_e000;

/// Returns true if a condition holds for one of the core registers in a bit mask.
#[inline]
fn any_register(registers: u16, holds: impl Fn(u8) -> bool) -> bool {
    let mut left = registers;
    while left != 0 {
        if holds(left.trailing_zeros() as u8) {
            return true;
        }
        left &= left - 1;
    }
    false
}

/// Fault that the processor raised, as its status registers describe it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum CpuFault {
    /// Nothing answered an access.
    Bus {
        /// Address that was accessed.
        address: u32,
        /// True if the access was the fetch of an instruction.
        fetch: bool,
    },
    /// The opcode is not defined.
    Undefined,
    /// The processor raised another fault, of this architectural name.
    Other(&'static str),
}

/// Result of one step of the core.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Stepped {
    /// The core executed the instruction, skipped it because its condition failed, or slept on.
    Instruction,
    /// The core entered the exception of this number, before the instruction or because of it.
    ///
    /// The architecture numbers exceptions: 3 is a hard fault, 16 the first external interrupt.
    Exception(u16),
    /// The core executed the instruction, which returned from an exception, perhaps into the next.
    Return,
}

/// Cortex-M4F that executes one instruction at a time.
pub trait Core {
    /// Returns the program counter: the address of the next instruction.
    fn pc(&self) -> u32;
    /// Sets the program counter, without the Thumb bit.
    fn set_pc(&mut self, address: u32);
    /// Returns core register 0 to 15.
    fn register(&self, index: u8) -> u32;
    /// Sets core register 0 to 14.
    fn set_register(&mut self, index: u8, value: u32);
    /// Returns the bits of FPU register s0 to s31.
    fn float_register(&self, index: u8) -> u32;
    /// Sets the bits of FPU register s0 to s31.
    fn set_float_register(&mut self, index: u8, bits: u32);
    /// Returns the status word xPSR: flags N Z C V Q in bits 31 to 27, GE in 19 to 16, and the IT
    /// state in 26, 25 and 15 to 10.
    fn status(&self) -> u32;
    /// Returns true if the core waits in `wfi` or `wfe`.
    fn is_asleep(&self) -> bool;
    /// Returns true if SysTick counts, the only device that can wake a core by itself.
    fn is_timer_running(&self) -> bool;
    /// Returns true if one of the core registers in a bit mask points to the registers of the DWT.
    fn is_in_trace_block(&self, registers: u16) -> bool;
    /// Returns true if one of the core registers in a bit mask points to the registers of the
    /// system: NVIC, system control block, and debug.
    fn is_in_system_block(&self, registers: u16) -> bool;
    /// Returns DEMCR, of which the bits of vector catch are kept, but have no effect on the core.
    fn debug_monitor_control(&self) -> u32;
    /// Sets DEMCR.
    fn set_debug_monitor_control(&mut self, bits: u32);
    /// Returns the cycle counter of the DWT, or `None` if the program has not switched it on.
    fn cycle_counter(&self) -> Option<u32>;
    /// Sets the cycle counter of the DWT.
    fn set_cycle_counter(&mut self, cycles: u32);
    /// Returns the number of the exception that is handled, 0 for none, and the number of active
    /// exceptions, preempted ones included.
    fn exceptions(&self) -> (u16, u32);
    /// Returns true if the program has requested a system reset (AIRCR.SYSRESETREQ).
    fn is_reset_requested(&self) -> bool;
    /// Returns true if the core is locked up by a fault inside a fault.
    fn is_locked_up(&self) -> bool;
    /// Returns the last fault, as the fault status registers describe it.
    fn fault(&self) -> CpuFault;
    /// Puts the core into privileged thread mode with the FPU on, flags and floating-point status
    /// cleared, and nothing pending.
    fn prepare_call(&mut self);
    /// Restarts the core from the vector table, with all system registers as after power-on.
    fn reset(&mut self);
    /// Drives an external interrupt line, which is level-sensitive. Line 0 is the first after the
    /// system exceptions.
    fn set_interrupt(&mut self, line: u16, asserted: bool);
}
