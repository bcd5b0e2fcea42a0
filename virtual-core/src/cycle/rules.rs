//! What each kind of instruction costs by itself.

use super::Band;
use crate::decode::{Instruction, Kind};

/// Refilling the pipeline after the program counter went elsewhere: P = 1 to 3, nominal 2.
pub const REFILL: Band = Band::new(1, 2, 3);

/// An instruction of an IT block whose condition failed.
pub const SKIPPED: Band = Band::exactly(1);

/// Entering an exception: eight registers stacked while the vector is fetched (Cortex-M4 manual: 12 cycles without waits).
pub const EXCEPTION_ENTRY: Band = Band::exactly(12);

/// Returning from an exception, beyond the branch itself (10 to 12 in all).
pub const EXCEPTION_RETURN: Band = Band::new(9, 10, 11);

/// The cost of an instruction by itself: neither taken as a branch nor delayed by the one before it.
///
/// VSTR is a store through the FPU: 1 like STR, 2 (Arm's table) at worst. Barriers wait for the bus, WFI for an interrupt: only their own
/// cycles are here. A division is charged by [`division`].
pub const fn alone(instruction: &Instruction) -> Band {
    match instruction.kind {
        Kind::Alu | Kind::Branch | Kind::Hint | Kind::Wait | Kind::SupervisorCall => Band::exactly(1),
        Kind::MultiplyAccumulate => Band::new(1, 1, 2),
        Kind::Divide { .. } => Band::new(2, 2, 12),
        Kind::Load | Kind::TableBranch | Kind::StoreExclusive => Band::exactly(2),
        Kind::StoreImmediate => Band::exactly(1),
        Kind::StoreFloat => Band::new(1, 1, 2),
        Kind::StoreRegister => Band::exactly(2),
        Kind::LoadMultiple | Kind::StoreMultiple => Band::exactly(1 + instruction.words),
        Kind::IfThen => Band::new(0, 1, 1),
        Kind::Float | Kind::FloatMove => Band::exactly(1),
        Kind::FloatMovePair => Band::exactly(2),
        Kind::FloatMultiplyAccumulate => Band::exactly(3),
        Kind::FloatDivide => Band::exactly(14),
        Kind::Special => Band::exactly(2),
        Kind::ChangeState => Band::new(1, 1, 2),
        Kind::Barrier => Band::new(1, 2, 4),
        Kind::Breakpoint | Kind::Undefined => Band::exactly(1),
    }
}

/// SDIV and UDIV: 2 to 12 cycles. Arm says only that the divider ends early depending on the operands' sizes; the nominal
/// figure is our estimate of that: 2, and 1 for each 4 bits of the quotient or part of them (at most 10 in all).
pub fn division(signed: bool, dividend: u32, divisor: u32) -> Band {
    let magnitude = |value: u32| if signed { value.cast_signed().unsigned_abs() } else { value };
    let bits = |value: u32| 32 - value.leading_zeros();
    let (dividend, divisor) = (magnitude(dividend), magnitude(divisor));
    let quotient_bits = if divisor == 0 || dividend < divisor { 0 } else { bits(dividend) - bits(divisor) + 1 };
    Band::new(2, 2 + quotient_bits.div_ceil(4) as u8, 12)
}
