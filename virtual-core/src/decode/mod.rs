//! Properties of an instruction that the cycle model needs: its kind, how it moves the program
//! counter, and the registers of its address, result and floating-point operands.
//!
//! The opcode tables are those of `rsemu`'s decoder.

mod float;
mod integer;

use rsemu::cpu::arm::v7m::isa::{self, Insn};

/// Kind of an instruction. Kinds are told apart if they differ in their cost.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Kind {
    /// Integer arithmetic, logic, shifts, bit fields, saturation, SIMD, and multiplications other
    /// than MLA and MLS.
    Alu,
    /// MLA, MLS.
    MultiplyAccumulate,
    /// SDIV and UDIV.
    Divide {
        /// True for SDIV.
        signed: bool,
    },
    /// LDR of every width, from a literal too, and VLDR of one word.
    Load,
    /// STR with an immediate offset.
    StoreImmediate,
    /// STR with a register offset.
    StoreRegister,
    /// VSTR of one word.
    StoreFloat,
    /// LDRD, LDM, POP, VLDM, VPOP, and VLDR of two words.
    LoadMultiple,
    /// STRD, STM, PUSH, VSTM, VPUSH, and VSTR of two words.
    StoreMultiple,
    /// STREX of every width.
    StoreExclusive,
    /// B, BL, BX, BLX, CBZ, CBNZ.
    Branch,
    /// TBB, TBH.
    TableBranch,
    /// IT.
    IfThen,
    /// VADD, VSUB, VMUL, VNMUL, VCVT.
    Float,
    /// VMLA, VMLS, VFMA, VFMS and their negated forms.
    FloatMultiplyAccumulate,
    /// VDIV, VSQRT.
    FloatDivide,
    /// VMOV, VNEG, VABS, VCMP, VMRS, VMSR.
    FloatMove,
    /// VMOV between two core registers and two singles.
    FloatMovePair,
    /// MRS, MSR.
    Special,
    /// CPSIE, CPSID.
    ChangeState,
    /// DMB, DSB, ISB.
    Barrier,
    /// NOP, SEV, PLD, YIELD, CLREX.
    Hint,
    /// WFI, WFE.
    Wait,
    /// SVC.
    SupervisorCall,
    /// BKPT.
    Breakpoint,
    /// UDF, or an opcode that the Cortex-M4F does not define.
    Undefined,
}

impl Kind {
    /// Returns true if the instruction reads memory.
    pub fn is_load(self) -> bool {
        matches!(self, Kind::Load | Kind::LoadMultiple)
    }

    /// Returns true if the instruction writes memory.
    pub fn is_store(self) -> bool {
        use Kind::{StoreExclusive, StoreFloat, StoreImmediate, StoreMultiple, StoreRegister};
        matches!(self, StoreImmediate | StoreRegister | StoreFloat | StoreMultiple | StoreExclusive)
    }
}

/// Place to which an instruction moves the program counter.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Flow {
    /// The next instruction.
    Next,
    /// [`Instruction::target`].
    Always,
    /// [`Instruction::target`] or the next instruction.
    Conditional,
    /// An address from a register or from memory.
    Computed,
}

/// Decoded instruction.
///
/// A set of registers is a bit mask: bit 13 of a set of core registers is SP, and bit n of a set of
/// FPU registers is s*n*.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Instruction {
    /// Operation with its operands, for the core that executes it.
    pub operation: Insn,
    /// Kind of the instruction.
    pub kind: Kind,
    /// Place to which it moves the program counter.
    pub flow: Flow,
    /// Length in bytes, 2 or 4.
    pub bytes: u8,
    /// Number of words that a multiple load or store moves, 0 for other instructions.
    pub words: u8,
    /// Comment field of BKPT or SVC, 0 for other instructions.
    pub comment: u8,
    /// Numbers of the registers with dividend and divisor of SDIV or UDIV; of STR, the first is
    /// that of the stored register.
    pub operands: [u8; 2],
    /// Core registers of its address, base and index.
    pub address: u16,
    /// Core registers that it writes, other than an updated base.
    pub result: u16,
    /// Base register that it updates.
    pub writeback: u16,
    /// FPU registers that it reads, other than an addend.
    pub float_sources: u32,
    /// FPU register to which a multiply-accumulate adds.
    pub float_addend: u32,
    /// FPU registers that it writes.
    pub float_result: u32,
    /// Address to which a branch goes or which a literal load reads, 0 for other instructions.
    pub target: u32,
}

impl Instruction {
    /// Returns true if the instruction may change the stack pointer.
    pub fn moves_stack(&self) -> bool {
        (self.result | self.writeback) & (1 << 13) != 0
    }

    /// Returns true if the instruction is a branch to a fixed address, but not a call.
    pub fn jumps(&self) -> bool {
        matches!(self.flow, Flow::Always | Flow::Conditional) && self.result == 0
    }

    /// Returns true if the instruction reads a literal beside the code.
    pub fn is_literal_load(&self) -> bool {
        self.target != 0 && self.kind.is_load()
    }

    /// Makes an instruction of a kind that uses no registers and goes to the next instruction.
    pub(crate) fn new(kind: Kind, bytes: u8) -> Instruction {
        Instruction {
            operation: Insn::Undefined,
            kind,
            flow: Flow::Next,
            bytes,
            words: 0,
            comment: 0,
            operands: [0; 2],
            address: 0,
            result: 0,
            writeback: 0,
            float_sources: 0,
            float_addend: 0,
            float_result: 0,
            target: 0,
        }
    }
}

/// Returns true if a halfword is the first of an instruction of two.
pub fn is_wide(first: u16) -> bool {
    isa::is_32bit(first)
}

/// Decodes the instruction at `address` from its first halfword and the one after it, which a
/// 16-bit instruction ignores.
pub fn decode(address: u32, first: u16, second: u16) -> Instruction {
    let bytes = if is_wide(first) { 4 } else { 2 };
    let operation = isa::decode(first, second);
    let properties = match operation {
        Insn::Fp(float) => float::decode(address, bytes, float),
        other => integer::decode(address, bytes, other),
    };
    Instruction { operation, ..properties }
}

/// Returns the set of one core register.
///
/// The program counter gives the empty set, since no later instruction could wait for it.
fn core(register: u8) -> u16 {
    if register == 15 { 0 } else { 1 << register }
}

/// Returns the address of a literal: the program counter, aligned down to a word, and an offset.
fn literal(address: u32, offset: u32, add: bool) -> u32 {
    let base = address.wrapping_add(4) & !3;
    if add { base.wrapping_add(offset) } else { base.wrapping_sub(offset) }
}
