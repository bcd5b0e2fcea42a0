//! The processor itself, as little of it as the machine needs: one trait round whichever emulator executes the
//! instructions. It knows nothing of cycles; those are charged by [`crate::cycle`].

mod rsemu;

pub use rsemu::Rsemu;

/// A fault that the processor raised, with what its status registers say.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum CpuFault {
    /// An access that nothing answered.
    Bus {
        /// The address.
        address: u32,
        /// Whether an instruction was being fetched.
        fetch: bool,
    },
    /// An opcode that is not defined.
    Undefined,
    /// Another fault, by its architectural name.
    Other(&'static str),
}

/// What one step did.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Stepped {
    /// Executed the instruction (or skipped it, when its condition failed), or slept on.
    Instruction,
    /// Entered an exception before, or by, the instruction. Its number is that of the architecture: 3 is a hard fault, 16 the
    /// first external interrupt.
    Exception(u16),
    /// Executed the instruction, which returned from an exception, or from one into the next.
    Return,
}

/// A Cortex-M4F that executes one instruction at a time.
pub trait Core {
    /// Executes the instruction at the program counter, or enters a pending exception. `in_block` says whether the instruction may be inside an IT block.
    fn step(&mut self, in_block: bool) -> Stepped;
    /// The program counter: the next instruction's address.
    fn pc(&self) -> u32;
    /// Sets the program counter, without the Thumb bit.
    fn set_pc(&mut self, address: u32);
    /// Core register 0 to 15.
    fn register(&self, index: u8) -> u32;
    /// Sets core register 0 to 14.
    fn set_register(&mut self, index: u8, value: u32);
    /// FPU register s0 to s31, as bits.
    fn float_register(&self, index: u8) -> u32;
    /// Sets FPU register s0 to s31, as bits.
    fn set_float_register(&mut self, index: u8, bits: u32);
    /// The status word xPSR: flags N Z C V Q in bits 31 to 27, GE in 19 to 16, the IT state in 26, 25 and 15 to 10.
    fn status(&self) -> u32;
    /// Whether the core waits in `wfi` or `wfe`.
    fn is_asleep(&self) -> bool;
    /// Whether SysTick counts, the only device that can wake a core by itself.
    fn is_timer_running(&self) -> bool;
    /// Whether one of those core registers (a bit mask) points to the block of DWT's registers.
    fn is_in_trace_block(&self, registers: u16) -> bool;
    /// DWT's cycle counter, if the program has switched it on.
    fn cycle_counter(&self) -> Option<u32>;
    /// Sets DWT's cycle counter.
    fn set_cycle_counter(&mut self, cycles: u32);
    /// The number of the exception being handled, 0 for none, and how many are active.
    fn exceptions(&self) -> (u16, u32);
    /// Whether the program has asked for a system reset (AIRCR.SYSRESETREQ).
    fn is_reset_requested(&self) -> bool;
    /// Whether the core is locked up by a fault inside a fault.
    fn is_locked_up(&self) -> bool;
    /// What the fault status registers say about the last fault.
    fn fault(&self) -> CpuFault;
    /// Puts the core into privileged thread mode with the FPU on, flags and floating-point status cleared, nothing pending.
    fn prepare_call(&mut self);
    /// Restarts from the vector table; all system registers as after power-on.
    fn reset(&mut self);
    /// Drives an external interrupt line (0 is the first after the system exceptions); level-sensitive.
    fn set_interrupt(&mut self, line: u16, asserted: bool);
}
