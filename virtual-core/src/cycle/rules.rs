//! Cost of each kind of instruction by itself.

use super::Band;
use crate::decode::{Instruction, Kind};

/// Cost of refilling the pipeline after a taken branch: Arm's P of 1 to 3, nominal 2.
pub const REFILL: Band = Band::new(1, 2, 3);

/// Cost of an instruction of an IT block whose condition failed.
pub const SKIPPED: Band = Band::exactly(1);

/// Cost of entering an exception: eight registers are stacked while the vector is fetched, which
/// takes 12 cycles without waits (Cortex-M4 manual).
pub const EXCEPTION_ENTRY: Band = Band::exactly(12);

/// Cost of returning from an exception beyond that of the branch (10 to 12 in all).
pub const EXCEPTION_RETURN: Band = Band::new(9, 10, 11);

/// Returns the cost of an instruction that is neither a taken branch nor delayed by the one before.
///
/// VSTR stores through the FPU: it costs 1 like STR, and 2 (Arm's table) at worst. Barriers wait
/// for the bus, and WFI for an interrupt; these waits are not included. [`division`] has the cost
/// of a division.
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

/// Returns the cost of SDIV (`signed`) or UDIV, 2 to 12 cycles.
///
/// Arm says only that the divider ends early depending on the sizes of the operands. The nominal
/// cost is this project's estimate: 2, and 1 for each 4 bits of the quotient or part of them, at
/// most 10 in all.
pub fn division(signed: bool, dividend: u32, divisor: u32) -> Band {
    let magnitude = |value: u32| if signed { value.cast_signed().unsigned_abs() } else { value };
    let bits = |value: u32| 32 - value.leading_zeros();
    let (dividend, divisor) = (magnitude(dividend), magnitude(divisor));
    let quotient_bits = if divisor == 0 || dividend < divisor { 0 } else { bits(dividend) - bits(divisor) + 1 };
    Band::new(2, 2 + quotient_bits.div_ceil(4) as u8, 12)
}
