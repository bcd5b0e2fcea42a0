//! What an instruction pays, or saves, because of the one straight before it.

use super::Band;
use crate::decode::{Instruction, Kind};

/// What the previous instruction left behind.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Previous {
    result: u16,
    writeback: u16,
    float_result: u32,
    load: bool,
    memory: bool,
}

impl Previous {
    /// Nothing to wait for: after a refilled pipeline that began elsewhere.
    pub const NOTHING: Previous = Previous { result: 0, writeback: 0, float_result: 0, load: false, memory: false };

    /// What that instruction leaves to the next one.
    #[inline]
    pub fn of(instruction: &Instruction) -> Previous {
        use Kind::{Float, FloatDivide, FloatMultiplyAccumulate};
        let late = matches!(instruction.kind, Float | FloatDivide | FloatMultiplyAccumulate);
        let load = instruction.kind.is_load();
        Previous {
            result: instruction.result,
            writeback: instruction.writeback,
            float_result: if late { instruction.float_result } else { 0 },
            load,
            memory: load || instruction.kind.is_store(),
        }
    }

    /// The cost of `instruction`, `alone` by itself, after this one. The rules, in all three columns unless said:
    ///
    /// - a single load straight after a load whose result is not in its address saves 1 (the two are pipelined);
    /// - a store with a register offset straight after another load or store saves 1 at best;
    /// - an address made of the previous instruction's result costs 1 more; of a base that it updated, 1 more at worst (the address
    ///   unit has it early);
    /// - an operand that a floating-point instruction has just computed (VADD, VMUL, VCVT, VMLA, VDIV ...) costs 1 more, and
    ///   nothing at best where it is the addend of a multiply-accumulate, which is taken up a cycle later.
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
