//! Instructions of the FPv4-SP unit.

use rsemu::cpu::arm::v7m::fpisa::{DataOp, FpInsn, UnaryOp};

use super::{Instruction, Kind, core, literal};

/// Returns the set of `count` FPU registers from `first` on.
fn singles(first: u8, count: u8) -> u32 {
    let list = if count >= 32 { u32::MAX } else { (1 << count) - 1 };
    list.checked_shl(u32::from(first)).unwrap_or(0)
}

/// Returns the set of one FPU register.
fn single(register: u8) -> u32 {
    singles(register, 1)
}

/// Returns the properties of an FPU instruction of `bytes` bytes at `address`.
pub(super) fn decode(address: u32, bytes: u8, float: FpInsn) -> Instruction {
    if float.needs_v5() {
        return Instruction::new(Kind::Undefined, bytes);
    }
    let of = |kind| Instruction::new(kind, bytes);
    match float {
        FpInsn::Data { op, d, n, m } => {
            let (kind, addend) = match op {
                DataOp::Add | DataOp::Sub | DataOp::Mul | DataOp::Nmul => (Kind::Float, 0),
                DataOp::Div => (Kind::FloatDivide, 0),
                DataOp::Maxnm | DataOp::Minnm => (Kind::Undefined, 0),
                _ => (Kind::FloatMultiplyAccumulate, single(d)),
            };
            let float_sources = single(n) | single(m);
            Instruction { float_sources, float_addend: addend, float_result: single(d), ..of(kind) }
        }
        FpInsn::Unary { op, d, m } => {
            let kind = if op == UnaryOp::Sqrt { Kind::FloatDivide } else { Kind::FloatMove };
            Instruction { float_sources: single(m), float_result: single(d), ..of(kind) }
        }
        FpInsn::MovImm { d, .. } => Instruction { float_result: single(d), ..of(Kind::FloatMove) },
        FpInsn::Cmp { d, m, with_zero, .. } => {
            let float_sources = single(d) | if with_zero { 0 } else { single(m) };
            Instruction { float_sources, ..of(Kind::FloatMove) }
        }
        FpInsn::CvtInt { d, m, .. } | FpInsn::CvtHalf { d, m, .. } => {
            Instruction { float_sources: single(m), float_result: single(d), ..of(Kind::Float) }
        }
        FpInsn::CvtFixed { d, .. } => {
            Instruction { float_sources: single(d), float_result: single(d), ..of(Kind::Float) }
        }
        FpInsn::MovCore { to_fp: true, n, .. } => Instruction { float_result: single(n), ..of(Kind::FloatMove) },
        FpInsn::MovCore { to_fp: false, rt, n } => {
            Instruction { float_sources: single(n), result: core(rt), ..of(Kind::FloatMove) }
        }
        FpInsn::MovCore2 { to_fp: true, m, .. } => {
            Instruction { float_result: singles(m, 2), ..of(Kind::FloatMovePair) }
        }
        FpInsn::MovCore2 { to_fp: false, rt, rt2, m, .. } => {
            Instruction { float_sources: singles(m, 2), result: core(rt) | core(rt2), ..of(Kind::FloatMovePair) }
        }
        FpInsn::Sys { to_core, rt, .. } => {
            Instruction { result: if to_core { core(rt) } else { 0 }, ..of(Kind::FloatMove) }
        }
        FpInsn::Mem { load, d, rn, imm, add, double } => {
            let words = if double { 2 } else { 1 };
            let kind = match (load, double) {
                (true, false) => Kind::Load,
                (true, true) => Kind::LoadMultiple,
                (false, false) => Kind::StoreFloat,
                (false, true) => Kind::StoreMultiple,
            };
            let target = if load && rn == 15 { literal(address, imm, add) } else { 0 };
            let multiple = if double { words } else { 0 };
            let base = Instruction { words: multiple, address: core(rn), target, ..of(kind) };
            moved(base, load, singles(d, words))
        }
        FpInsn::Multi { load, d, rn, count, writeback, .. } => {
            let kind = if load { Kind::LoadMultiple } else { Kind::StoreMultiple };
            let writeback = if writeback { core(rn) } else { 0 };
            let base = Instruction { words: count, address: core(rn), writeback, ..of(kind) };
            moved(base, load, singles(d, count))
        }
        _ => of(Kind::Undefined),
    }
}

/// Adds a list of FPU registers to an instruction: a load writes them, a store reads them.
fn moved(base: Instruction, load: bool, list: u32) -> Instruction {
    if load { Instruction { float_result: list, ..base } } else { Instruction { float_sources: list, ..base } }
}
