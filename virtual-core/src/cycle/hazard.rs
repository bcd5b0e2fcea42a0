//! Hazards: cycles that an instruction costs or saves because of the one straight before it.

use super::Band;
use crate::decode::{Instruction, Kind};

/// Properties of the previous instruction on which the cost of the next one depends.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Previous {
    /// Core registers that it wrote, other than an updated base.
    result: u16,
    /// Base register that it updated.
    writeback: u16,
    /// FPU registers whose value it computes late.
    float_result: u32,
    /// True if it read memory.
    load: bool,
    /// True if it read or wrote memory.
    memory: bool,
    /// Bits of [`reads`] of a next instruction whose cost may change.
    leaves: u64,
}

/// Bits of [`reads`] beside the core registers: loads after a load, and stores with a register
/// offset after an access of memory.
const LOADS: u64 = 1 << 16;
const STORES: u64 = 1 << 17;

/// Returns what an instruction reads that the previous one may make dearer or cheaper: core
/// registers in bits 0 to 15, FPU registers in bits 32 to 63, and the form of the access.
pub(crate) fn reads(instruction: &Instruction) -> u64 {
    let access = match instruction.kind {
        Kind::Load => LOADS,
        Kind::StoreRegister => STORES,
        _ => 0,
    };
    access | u64::from(instruction.address) | u64::from(instruction.float_sources | instruction.float_addend) << 32
}

impl Previous {
    /// No previous instruction: the pipeline was refilled, and nothing can delay the next one.
    pub const NOTHING: Previous =
        Previous { result: 0, writeback: 0, float_result: 0, load: false, memory: false, leaves: 0 };

    /// Returns the properties of an instruction.
    #[inline]
    pub fn of(instruction: &Instruction) -> Previous {
        use Kind::{Float, FloatDivide, FloatMultiplyAccumulate};
        let late = matches!(instruction.kind, Float | FloatDivide | FloatMultiplyAccumulate);
        let load = instruction.kind.is_load();
        let memory = load || instruction.kind.is_store();
        let float_result = if late { instruction.float_result } else { 0 };
        let access = if load { LOADS } else { 0 } | if memory { STORES } else { 0 };
        let registers = u64::from(instruction.result | instruction.writeback) | u64::from(float_result) << 32;
        Previous {
            result: instruction.result,
            writeback: instruction.writeback,
            float_result,
            load,
            memory,
            leaves: access | registers,
        }
    }

    /// Returns false if an instruction that reads `reads` costs what it costs alone.
    #[inline]
    pub(crate) fn affects(&self, reads: u64) -> bool {
        self.leaves & reads != 0
    }

    /// Returns the cost of `instruction` after this one; `alone` is its cost by itself.
    ///
    /// The rules apply to all three columns unless a rule names one:
    /// - A single load straight after a load saves 1, since the two are pipelined. Its address must
    ///   not be made of the result of the first load.
    /// - A store with a register offset straight after another load or store saves 1 at best.
    /// - An address made of the result of the previous instruction costs 1 more. An address made of
    ///   a base that it updated costs 1 more at worst, since the address unit has it early.
    /// - An operand that a floating-point instruction has just computed (VADD, VMUL, VCVT, VMLA,
    ///   VDIV ...) costs 1 more. The addend of a multiply-accumulate costs nothing more at best,
    ///   since it is taken up a cycle later.
    #[inline]
    pub fn cost(&self, instruction: &Instruction, alone: Band) -> Band {
        let mut band = alone;
        if instruction.address & self.result != 0 {
            band = band + Band::exactly(1);
        } else {
            if instruction.address & self.writeback != 0 {
                band.worst += 1;
            }
            if self.load && instruction.kind == Kind::Load {
                band = Band::new(band.best - 1, band.nominal - 1, band.worst - 1);
            }
        }
        if self.memory && instruction.kind == Kind::StoreRegister {
            band.best -= 1;
        }
        if instruction.float_sources & self.float_result != 0 {
            band = band + Band::exactly(1);
        } else if instruction.float_addend & self.float_result != 0 {
            band = band + Band::new(0, 1, 1);
        }
        band
    }
}
