//! What the cycle model has to know of an instruction: its kind, how it moves the program counter, and which registers its
//! address, its result and its floating-point operands are. The opcode tables themselves are those of `rsemu`'s decoder.

mod float;
mod integer;

use rsemu::cpu::arm::v7m::isa::{self, Insn};

/// The kind of an instruction, as far as kinds differ in their cost.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Kind {
    /// Integer arithmetic, logic, shifts, bit fields, saturation, SIMD, and every multiplication that is not MLA or MLS.
    Alu,
    /// MLA, MLS.
    MultiplyAccumulate,
    /// SDIV (`signed`), UDIV.
    Divide {
        /// SDIV.
        signed: bool,
    },
    /// LDR in every width, also literal; VLDR of one word.
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
    /// STREX in every width.
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
    /// Not an instruction of the Cortex-M4F, or UDF.
    Undefined,
}

impl Kind {
    /// Whether it reads memory.
    pub fn is_load(self) -> bool {
        matches!(self, Kind::Load | Kind::LoadMultiple)
    }

    /// Whether it writes memory.
    pub fn is_store(self) -> bool {
        use Kind::{StoreExclusive, StoreFloat, StoreImmediate, StoreMultiple, StoreRegister};
        matches!(self, StoreImmediate | StoreRegister | StoreFloat | StoreMultiple | StoreExclusive)
    }
}

/// How an instruction moves the program counter.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Flow {
    /// To the next instruction.
    Next,
    /// To [`Instruction::target`].
    Always,
    /// To [`Instruction::target`] or to the next one.
    Conditional,
    /// To an address from a register or from memory.
    Computed,
}

/// One decoded instruction. Sets of core registers are bit masks (bit 13 is SP), sets of FPU registers too (bit n is s*n*).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Instruction {
    /// Its kind.
    pub kind: Kind,
    /// How it moves the program counter.
    pub flow: Flow,
    /// 2 or 4.
    pub bytes: u8,
    /// Words that a multiple load or store moves; else 0.
    pub words: u8,
    /// The comment of BKPT.
    pub comment: u8,
    /// Dividend and divisor of SDIV and UDIV.
    pub operands: [u8; 2],
    /// Core registers that its address is made of (base and index).
    pub address: u16,
    /// Core registers that it writes, other than an updated base.
    pub result: u16,
    /// The base register that it updates.
    pub writeback: u16,
    /// FPU registers that it reads, other than an addend.
    pub float_sources: u32,
    /// The FPU register that a multiply-accumulate adds to.
    pub float_addend: u32,
    /// FPU registers that it writes.
    pub float_result: u32,
    /// Where a branch goes, or where a literal load reads; else 0.
    pub target: u32,
}

impl Instruction {
    /// Whether it may change the stack pointer.
    pub fn moves_stack(&self) -> bool {
        (self.result | self.writeback) & (1 << 13) != 0
    }

    /// Whether it is a branch to a fixed place that is not a call.
    pub fn jumps(&self) -> bool {
        matches!(self.flow, Flow::Always | Flow::Conditional) && self.result == 0
    }

    /// Whether it reads a literal beside the code.
    pub fn is_literal_load(&self) -> bool {
        self.target != 0 && self.kind.is_load()
    }

    pub(crate) fn new(kind: Kind, bytes: u8) -> Instruction {
        Instruction {
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

/// Whether that halfword is the first of two.
pub fn is_wide(first: u16) -> bool {
    isa::is_32bit(first)
}

/// Decodes the instruction at `address` from its first halfword and the one after it (ignored by a 16-bit instruction).
pub fn decode(address: u32, first: u16, second: u16) -> Instruction {
    let bytes = if is_wide(first) { 4 } else { 2 };
    match isa::decode(first, second) {
        Insn::Fp(float) => float::decode(address, bytes, float),
        other => integer::decode(address, bytes, other),
    }
}

/// The set of one core register; the program counter is none that a later instruction could wait for.
fn core(register: u8) -> u16 {
    if register == 15 { 0 } else { 1 << register }
}

/// The address of a literal: the program counter, aligned down to a word, and an offset.
fn literal(address: u32, offset: u32, add: bool) -> u32 {
    let base = address.wrapping_add(4) & !3;
    if add { base.wrapping_add(offset) } else { base.wrapping_sub(offset) }
}
