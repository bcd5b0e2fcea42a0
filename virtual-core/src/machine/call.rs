//! Calls of one function, as compiled code makes them.

use super::execute::Ended;
use super::{Machine, RAM_END};
use crate::cpu::Core;
use crate::cycle::Cost;
use crate::cycle::hazard::Previous;
use crate::error::RunError;
use crate::memory::{RAM_ADDRESS, RAM_BYTES};

/// Address to which a called function returns, where no memory is.
const RETURN_ADDRESS: u32 = 0xf000_0000;

/// Result and cost of a call.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Call {
    /// Value of r0 at the return.
    pub value: u32,
    /// Value of r1 at the return: the high half of a 64-bit result.
    pub high: u32,
    /// Bits of s0 at the return: an `f32` result.
    pub float: u32,
    /// Cost from the first instruction of the function to its return.
    pub cost: Cost,
    /// Most bytes of stack that the function and all it called used, below the stack pointer at its
    /// entry.
    pub stack_bytes: u32,
}

impl Machine {
    /// Calls a function by its demangled or linker name, by the rules of the AAPCS.
    ///
    /// Argument words go to r0 to r3, and then to the stack. A 64-bit argument is two words, of
    /// which the first has an even number. Hard-float arguments are set beforehand by
    /// [`Machine::core`] (s0 to s15); a call does not clear them. The FPU is on, and interrupts are
    /// as their lines say.
    ///
    /// The stack starts at the symbol `_stack_start` if the image has one, as that of cortex-m-rt
    /// has, else at the end of RAM.
    ///
    /// # Errors
    /// [`RunError`] if there is no such function, at an unknown instruction or address or a fault,
    /// or if the function does not return within the limit.
    pub fn call(&mut self, function: &str, arguments: &[u32]) -> Result<Call, RunError> {
        let address = match self.image.symbol(function) {
            Some(symbol) if symbol.is_function => symbol.address,
            _ => return Err(RunError::NoFunction { name: function.to_owned() }),
        };
        self.call_at(address, arguments)
    }

    /// Calls the function at an address, by the rules of [`Machine::call`].
    ///
    /// # Errors
    /// [`RunError`] at an unknown instruction or address or a fault, or if the function does not
    /// return within the limit.
    pub fn call_at(&mut self, address: u32, arguments: &[u32]) -> Result<Call, RunError> {
        self.core.prepare_call();
        let (in_registers, on_stack) = arguments.split_at(arguments.len().min(4));
        let stack = self.stack_start();
        let bytes = (4 * on_stack.len()).next_multiple_of(8) as u32;
        let too_many = || RunError::TooManyArguments { count: arguments.len() };
        let stack = stack.checked_sub(bytes).ok_or_else(too_many)?;
        let words: Vec<u8> = on_stack.iter().flat_map(|word| word.to_le_bytes()).collect();
        if !words.is_empty() {
            self.memory.write(stack, &words).map_err(|_| too_many())?;
        }
        for (register, &word) in (0..).zip(in_registers) {
            self.core.set_register(register, word);
        }
        self.core.set_register(13, stack);
        self.core.set_register(14, RETURN_ADDRESS | 1);
        self.core.set_pc(address & !1);

        self.lowest_stack = stack;
        self.previous = Previous::NOTHING;
        self.in_block = false;
        let before = self.total;
        let limit = self.limit_instructions;
        let ended = self.execute_awake(RETURN_ADDRESS, limit)?;
        let pc = self.core.pc();
        let function = self.functions.name_at(pc);
        match ended {
            Ended::Arrived => Ok(Call {
                value: self.core.register(0),
                high: self.core.register(1),
                float: self.core.float_register(0),
                cost: self.total - before,
                stack_bytes: stack.saturating_sub(self.lowest_stack),
            }),
            Ended::Breakpoint(number) => Err(RunError::Breakpoint { number, pc, function }),
            Ended::Asleep => Err(RunError::Asleep { pc, function }),
            Ended::Limit | Ended::Due | Ended::Caught => Err(RunError::Limit { limit, pc, function }),
        }
    }

    fn stack_start(&self) -> u32 {
        let named = self.image.symbol("_stack_start").map(|symbol| symbol.address & !7);
        named.filter(|address| address.wrapping_sub(RAM_ADDRESS) <= RAM_BYTES).unwrap_or(RAM_END)
    }
}
