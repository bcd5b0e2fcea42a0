//! Integer, memory, branch and system instructions.

use rsemu::cpu::arm::v7m::isa::{DualMulOp, HalfMulOp, HintOp, Insn, MemOffset};

use super::{Flow, Instruction, Kind, core, literal};

/// Returns an instruction that writes `rd`. Writing the program counter is a jump.
fn writes(kind: Kind, bytes: u8, rd: u8) -> Instruction {
    let flow = if rd == 15 { Flow::Computed } else { Flow::Next };
    Instruction { flow, result: core(rd), ..Instruction::new(kind, bytes) }
}

/// Returns the properties of an instruction of `bytes` bytes at `address` that is not the FPU's.
pub(super) fn decode(address: u32, bytes: u8, insn: Insn) -> Instruction {
    let of = |kind| Instruction::new(kind, bytes);
    let alu = |rd| writes(Kind::Alu, bytes, rd);
    let target = |offset: i32| address.wrapping_add(4).wrapping_add_signed(offset);
    match insn {
        Insn::DataProc { op, .. } if op.is_test() => of(Kind::Alu),
        Insn::DataProc { rd, .. } => alu(rd),
        Insn::ShiftReg { rd, .. }
        | Insn::Adr { rd, .. }
        | Insn::MovImm16 { rd, .. }
        | Insn::Sat { rd, .. }
        | Insn::SatQ { rd, .. }
        | Insn::Simd { rd, .. }
        | Insn::Sel { rd, .. }
        | Insn::Usad { rd, .. }
        | Insn::Pkh { rd, .. }
        | Insn::Extend { rd, .. }
        | Insn::Misc { rd, .. }
        | Insn::Bitfield { rd, .. } => alu(rd),
        Insn::Mul { rd, ra, .. } => {
            Instruction { result: core(rd), ..of(if ra.is_some() { Kind::MultiplyAccumulate } else { Kind::Alu }) }
        }
        Insn::MulLong { rdlo, rdhi, .. } => Instruction { result: core(rdlo) | core(rdhi), ..of(Kind::Alu) },
        Insn::HalfMul { op, rd, ra, .. } => {
            let low = if op == HalfMulOp::Smlal { core(ra) } else { 0 };
            Instruction { result: core(rd) | low, ..of(Kind::Alu) }
        }
        Insn::DualMul { op, rd, ra, .. } => {
            let low = if matches!(op, DualMulOp::Smlald | DualMulOp::Smlsld) { core(ra) } else { 0 };
            Instruction { result: core(rd) | low, ..of(Kind::Alu) }
        }
        Insn::Div { signed, rd, rn, rm } => {
            Instruction { result: core(rd), operands: [rn, rm], ..of(Kind::Divide { signed }) }
        }

        Insn::Branch { cond, offset } => {
            let flow = if cond.is_some() { Flow::Conditional } else { Flow::Always };
            Instruction { flow, target: target(offset), ..of(Kind::Branch) }
        }
        Insn::BranchLink { offset } => {
            Instruction { flow: Flow::Always, target: target(offset), result: core(14), ..of(Kind::Branch) }
        }
        Insn::Bx { .. } => Instruction { flow: Flow::Computed, ..of(Kind::Branch) },
        Insn::Blx { .. } => Instruction { flow: Flow::Computed, result: core(14), ..of(Kind::Branch) },
        Insn::Cbz { offset, .. } => {
            Instruction { flow: Flow::Conditional, target: target(offset as i32), ..of(Kind::Branch) }
        }
        Insn::TableBranch { rn, rm, .. } => {
            Instruction { flow: Flow::Computed, address: core(rn) | core(rm), ..of(Kind::TableBranch) }
        }
        Insn::It { .. } => of(Kind::IfThen),

        Insn::LoadStore { load, rt, rn, offset, wback, .. } => {
            let (index, store) = match offset {
                MemOffset::Imm(_) => (0, Kind::StoreImmediate),
                MemOffset::Reg { rm, .. } => (core(rm), Kind::StoreRegister),
            };
            let base = if load { writes(Kind::Load, bytes, rt) } else { of(store) };
            let writeback = if wback { core(rn) } else { 0 };
            let operands = if load { [0; 2] } else { [rt, 0] };
            Instruction { address: core(rn) | index, writeback, operands, ..base }
        }
        Insn::LoadLiteral { rt, imm, add, .. } => {
            Instruction { target: literal(address, imm, add), ..writes(Kind::Load, bytes, rt) }
        }
        Insn::LoadStoreDual { load, rt, rt2, rn, imm, add, wback, .. } => {
            let (kind, result) =
                if load { (Kind::LoadMultiple, core(rt) | core(rt2)) } else { (Kind::StoreMultiple, 0) };
            let target = if load && rn == 15 { literal(address, imm, add) } else { 0 };
            let writeback = if wback { core(rn) } else { 0 };
            Instruction { words: 2, address: core(rn), result, writeback, target, ..of(kind) }
        }
        Insn::LoadStoreExclusive { load: true, rt, rn, .. } => {
            Instruction { address: core(rn), result: core(rt), ..of(Kind::Load) }
        }
        Insn::LoadStoreExclusive { load: false, rd, rn, .. } => {
            Instruction { address: core(rn), result: core(rd), ..of(Kind::StoreExclusive) }
        }
        Insn::LoadStoreMultiple { load, rn, list, wback, .. } => {
            let (kind, result) = if load { (Kind::LoadMultiple, list & 0x7fff) } else { (Kind::StoreMultiple, 0) };
            let flow = if load && list & 0x8000 != 0 { Flow::Computed } else { Flow::Next };
            let writeback = if wback { core(rn) } else { 0 };
            Instruction { flow, words: list.count_ones() as u8, address: core(rn), result, writeback, ..of(kind) }
        }

        Insn::Mrs { rd, .. } => Instruction { result: core(rd), ..of(Kind::Special) },
        // MSR can move the stack pointer, by writing it or by choosing the other one.
        Insn::Msr { .. } => Instruction { result: core(13), ..of(Kind::Special) },
        Insn::Cps { .. } => of(Kind::ChangeState),
        Insn::Barrier { .. } => of(Kind::Barrier),
        Insn::Hint { op: HintOp::Wfe | HintOp::Wfi } => of(Kind::Wait),
        Insn::Hint { .. } | Insn::ClearExclusive => of(Kind::Hint),
        Insn::Bkpt { imm } => Instruction { comment: imm, ..of(Kind::Breakpoint) },
        Insn::Svc { imm } => Instruction { flow: Flow::Computed, comment: imm, ..of(Kind::SupervisorCall) },
        _ => of(Kind::Undefined),
    }
}
