//! FPU instructions (DDI 0403 A7.7), single precision.
//!
//! The host's own arithmetic computes most results: it is IEEE 754 too, and rounds to nearest.
//! The arithmetic of `rsemu` computes those whose bits or exception flags could differ: NaN and
//! infinite operands, results next to the subnormals or beyond all numbers, divisions by 0, and the
//! modes of FPSCR other than those of reset.
//!
//! | part | instructions |
//! | --- | --- |
//! | [`arithmetic`] | sums, products, quotients, square roots, comparisons |
//! | [`convert`] | conversions from and to integers, fixed point and halves |
//! | [`transfer`] | moves between registers, loads and stores |
//!
//! `rsemu` itself executes FPU instructions while the FPU is off, while exception frames are lazy,
//! or if they access what [`super::transfer`] leaves to it.

mod arithmetic;
mod convert;
#[cfg(test)]
mod tests;
mod transfer;

use rsemu::cpu::arm::v7m::fp::fpscr;
use rsemu::cpu::arm::v7m::fpisa::FpInsn;
use rsemu::cpu::arm::v7m::sys::control;
use rsemu::float::Flags;

use convert::FixedPoint;

use super::Direct;
use crate::cpu::Core;
use crate::cpu::rsemu::Rsemu;
use crate::decode::{Flow, Instruction};

/// Number of registers s0 to s31.
const SINGLES: usize = 32;

/// Registers s0 to s15, which an exception frame holds.
const FRAME: u32 = 0xffff;

/// Bits of FPSCR that select a mode, all 0 after reset: default NaN, flush to zero, rounding.
const MODES: u32 = fpscr::DN | fpscr::FZ | fpscr::RMODE;

/// Registers of the FPU. `rsemu` has a copy, which is brought up to date before it executes.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct FloatRegisters {
    singles: [u32; SINGLES],
    /// FPSCR.
    status: u32,
    /// Registers s0 to s31 in which the copy differs, as a bit mask.
    changed: u32,
    /// FPSCR of the copy.
    status_of_copy: u32,
}

impl FloatRegisters {
    /// Reads all registers of `rsemu`.
    pub(super) fn of(rsemu: &Rsemu) -> FloatRegisters {
        let mut registers = FloatRegisters { singles: [0; SINGLES], status: 0, changed: 0, status_of_copy: 0 };
        registers.read(rsemu, u32::MAX);
        registers
    }

    /// Reads FPSCR and some registers of `rsemu`, of which `list` is a bit mask.
    fn read(&mut self, rsemu: &Rsemu, list: u32) {
        self.status = rsemu.float_status();
        self.status_of_copy = self.status;
        for register in numbers(list) {
            self.singles[usize::from(register)] = rsemu.float_register(register);
        }
        self.changed &= !list;
    }

    /// Reads what `rsemu` may have changed when it executed an instruction.
    ///
    /// Returns from exceptions are branches to an address from a register or from memory.
    pub(super) fn read_after(&mut self, rsemu: &Rsemu, instruction: &Instruction) {
        let frame = if instruction.flow == Flow::Computed { FRAME } else { 0 };
        self.read(rsemu, instruction.float_result | frame);
    }

    /// Gives `rsemu` the registers that have changed.
    pub(super) fn write(&mut self, rsemu: &mut Rsemu) {
        for register in numbers(self.changed) {
            rsemu.set_float_register(register, self.get(register));
        }
        self.changed = 0;
        if self.status != self.status_of_copy {
            rsemu.set_float_status(self.status);
            self.status_of_copy = self.status;
        }
    }

    /// Returns the bits of register s0 to s31.
    #[inline]
    pub(super) fn get(&self, register: u8) -> u32 {
        self.singles[usize::from(register) % SINGLES]
    }

    /// Sets the bits of register s0 to s31.
    #[inline]
    pub(super) fn set(&mut self, register: u8, bits: u32) {
        self.singles[usize::from(register) % SINGLES] = bits;
        self.changed |= 1 << (register % SINGLES as u8);
    }

    /// Sets a register to a result, and adds the exception flags that computing it has raised.
    #[inline]
    fn finish(&mut self, register: u8, (bits, flags): (u32, Flags)) {
        self.set(register, bits);
        self.status |= flags.to_fpsr();
    }

    /// Sets a register to a rounded result. FPSCR tells from then on if a result was inexact.
    #[inline]
    fn finish_rounded(&mut self, register: u8, result: f32, is_inexact: bool) {
        self.set(register, result.to_bits());
        self.status |= if is_inexact { fpscr::IXC } else { 0 };
    }

    /// Returns true if an earlier result was inexact, and FPSCR says so.
    #[inline]
    fn is_inexact(&self) -> bool {
        self.status & fpscr::IXC != 0
    }

    /// Returns true if FPSCR selects the modes of reset.
    #[inline]
    fn has_reset_modes(&self) -> bool {
        self.status & MODES == 0
    }
}

/// Returns the numbers of the registers in a bit mask.
fn numbers(list: u32) -> impl Iterator<Item = u8> {
    let mut left = list;
    std::iter::from_fn(move || {
        let number = left.trailing_zeros() as u8;
        left &= left.checked_sub(1)?;
        Some(number)
    })
}

impl Direct {
    /// Executes an instruction of the FPU.
    pub(super) fn float(&mut self, instruction: FpInsn) -> Option<()> {
        if !self.protection.is_float_plain {
            return None;
        }
        match instruction {
            FpInsn::Data { op, d, n, m } => self.compute(op, [d, n, m]),
            FpInsn::Unary { op, d, m } => self.compute_unary(op, d, m),
            FpInsn::MovImm { d, imm } => {
                self.floats.set(d, imm);
                Some(())
            }
            FpInsn::Cmp { d, m, with_zero, signal_all } => {
                let right = if with_zero { 0 } else { self.floats.get(m) };
                self.compare(self.floats.get(d), right, signal_all)
            }
            FpInsn::CvtInt { d, m, to_int: true, signed, round_zero } => {
                self.convert_to_integer([d, m], signed, round_zero)
            }
            FpInsn::CvtInt { d, m, to_int: false, signed, .. } => {
                self.convert_from_fixed([d, m], FixedPoint::integer(signed))
            }
            FpInsn::CvtFixed { d, to_fixed, unsigned, wide, frac } => {
                let form = FixedPoint { bits: if wide { 32 } else { 16 }, unsigned, fraction_bits: frac };
                if to_fixed { self.convert_to_fixed([d, d], form) } else { self.convert_from_fixed([d, d], form) }
            }
            FpInsn::CvtHalf { d, m, to_half: true, top } => self.convert_to_half(d, m, top),
            FpInsn::CvtHalf { d, m, to_half: false, top } => self.convert_from_half(d, m, top),
            FpInsn::MovCore { to_fp, rt, n } => self.move_core(to_fp, rt, n),
            FpInsn::MovCore2 { to_fp, rt, rt2, m, .. } => self.move_core_pair(to_fp, [rt, rt2], m),
            FpInsn::Sys { to_core, rt, reg } => self.move_status(to_core, rt, reg),
            FpInsn::Mem { load, d, rn, imm, add, double } => {
                let base = if rn == 15 { self.literal(0, true) } else { self.get(rn) };
                let address = if add { base.wrapping_add(imm) } else { base.wrapping_sub(imm) };
                self.transfer_singles(load, address, d, if double { 2 } else { 1 })
            }
            FpInsn::Multi { load, d, rn, count, add, writeback, .. } => {
                self.transfer_list(load, [d, count, rn], add, writeback)
            }
            // The FPU of the Cortex-M4F lacks these.
            FpInsn::CvtMode { .. } | FpInsn::RintMode { .. } | FpInsn::Sel { .. } => None,
        }?;
        // An exception frame holds the registers of the FPU from now on.
        self.registers.control |= control::FPCA;
        Some(())
    }
}
