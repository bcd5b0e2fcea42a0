//! Core that executes the common instructions itself and leaves all others to `rsemu`.
//!
//! Most of what a program runs is arithmetic on core registers, loads and stores of memory, and
//! branches. `rsemu` fetches and decodes each of these anew, looks its addresses up on the bus, and
//! arbitrates exceptions. Here an instruction comes decoded, and exceptions are arbitrated only
//! after something that can make one due.
//!
//! | part | instructions |
//! | --- | --- |
//! | [`data`] | moves, sums, logic, shifts, bit fields, extension, saturation |
//! | [`multiply`] | products of words and halves, their sums, and quotients |
//! | [`transfer`] | loads and stores of core registers in flash, RAM and CCM |
//! | [`flow`] | branches, table branches, IT |
//! | [`float`] | the FPU: arithmetic, comparisons, conversions, moves, loads and stores |
//!
//! All else is `rsemu`'s: devices, system registers, faults, exceptions, sleep, unaligned and
//! exclusive accesses. Before it executes one instruction it gets all registers that have changed,
//! and behind it they are read back. `tests` compares both cores instruction by instruction.

mod data;
mod float;
mod flow;
mod multiply;
#[cfg(test)]
mod tests;
mod transfer;

use std::sync::Arc;

use rsemu::core::space::AddressSpace;
use rsemu::cpu::arm::v7m::isa::{Cond, Insn};
use rsemu::cpu::arm::v7m::{Regs, xpsr};

use super::rsemu::{Protection, Rsemu, advanced};
use super::{Core, CpuFault, DWT_ADDRESS, SYSTEM_ADDRESS, Stepped, any_register};
use crate::decode::{Instruction, Kind};
use crate::memory::Memory;
use float::FloatRegisters;

/// Bit of CONTROL that makes PSP the stack pointer of thread mode.
const CONTROL_PROCESS_STACK: u32 = 2;

/// Core that executes the common instructions itself, and has the crate `rsemu` for all others.
#[derive(Debug)]
pub struct Direct {
    rsemu: Rsemu,
    memory: Memory,
    /// Registers of the core, of which `rsemu` has a copy only while it executes. Entry 15 is the
    /// address of the next instruction.
    registers: Regs,
    floats: FloatRegisters,
    /// Address of the instruction that follows the one that executes.
    next: u32,
    /// True if no exception can be due before the next instruction.
    is_calm: bool,
    protection: Protection,
    /// Number of devices that take reads of memory.
    traps: u32,
}

impl Direct {
    /// Makes a core on an address space with these memories, which boots from the vector table at
    /// `vectors`. It has not executed an instruction yet.
    pub(crate) fn new(space: Arc<AddressSpace>, memory: Memory, vectors: u32) -> Direct {
        let rsemu = Rsemu::new(space, vectors);
        Direct {
            registers: rsemu.registers(),
            floats: FloatRegisters::of(&rsemu),
            rsemu,
            memory,
            next: 0,
            is_calm: false,
            protection: Protection::default(),
            traps: 0,
        }
    }

    /// Puts the core in the state of power-on.
    pub(crate) fn power_on(&mut self, space: Arc<AddressSpace>, vectors: u32) {
        self.rsemu = Rsemu::new(space, vectors);
        self.registers = self.rsemu.registers();
        self.floats = FloatRegisters::of(&self.rsemu);
        self.protection = Protection::default();
        self.is_calm = false;
    }

    /// Tells the core that a device takes reads of memory from now on, or no longer.
    pub(crate) fn set_trap(&mut self, trapped: bool) {
        self.traps = if trapped { self.traps + 1 } else { self.traps.saturating_sub(1) };
    }

    /// Executes an instruction itself. `None` leaves it to `rsemu`, with nothing changed.
    #[inline]
    fn execute(&mut self, instruction: &Instruction, in_block: bool) -> Option<()> {
        let pc = self.registers.r[15];
        if self.protection.covers(pc) {
            return None;
        }
        self.next = pc.wrapping_add(u32::from(instruction.bytes));
        let block = if in_block { self.registers.xpsr & xpsr::IT_MASK } else { 0 };
        // Instructions read the program counter as their own address and 4.
        self.registers.r[15] = pc.wrapping_add(4);
        let done = if block == 0 {
            self.operate(&instruction.operation, true)
        } else {
            self.operate_in_block(instruction, block)
        };
        self.registers.r[15] = if done.is_some() { self.next } else { pc };
        done
    }

    /// Executes an instruction of an IT block, which a condition may skip.
    fn operate_in_block(&mut self, instruction: &Instruction, block: u32) -> Option<()> {
        // Both are unpredictable in a block.
        if matches!(instruction.operation, Insn::It { .. } | Insn::Branch { cond: Some(_), .. }) {
            return None;
        }
        let condition = Cond((block >> 12 & 0xf) as u8);
        if condition.passes(self.registers.xpsr) {
            // Short instructions leave the flags alone in a block.
            self.operate(&instruction.operation, instruction.bytes == 4)?;
        }
        self.registers.xpsr = self.registers.xpsr & !xpsr::IT_MASK | advanced(block);
        Some(())
    }

    /// Executes an operation. Flags change only if `sets_flags`, but for tests.
    #[inline]
    fn operate(&mut self, operation: &Insn, sets_flags: bool) -> Option<()> {
        match *operation {
            Insn::DataProc { op, s, rd, rn, operand } => {
                self.process(op, s && (sets_flags || op.is_test()), rd, rn, operand)
            }
            Insn::ShiftReg { ty, s, rd, rn, rm } => self.shift(ty, s && sets_flags, [rd, rn, rm]),
            Insn::MovImm16 { top, rd, imm } => self.move_half(top, rd, imm),
            Insn::Adr { rd, imm, add } => self.address_of(rd, imm, add),
            Insn::Bitfield { op, rd, rn, lsb, width } => self.bit_field(op, [rd, rn], [lsb, width]),
            Insn::Extend { op, rd, rn, rm, rotate } => self.extend(op, [rd, rn, rm], rotate),
            Insn::Misc { op, rd, rm } => self.rearrange(op, [rd, rm]),
            Insn::Sat { unsigned, halves: false, rd, rn, imm, shift } => self.saturate(unsigned, [rd, rn], imm, shift),
            Insn::SatQ { op, rd, rn, rm } => self.saturating_sum(op, [rd, rn, rm]),
            Insn::Pkh { tb, rd, rn, rm, shift } => self.pack(tb, [rd, rn, rm], shift),
            Insn::Mul { rd, rn, rm, ra, sub, s } => self.multiply([rd, rn, rm], ra, sub, s && sets_flags),
            Insn::MulLong { signed, accumulate, rdlo, rdhi, rn, rm, umaal } => {
                self.multiply_long([rdlo, rdhi, rn, rm], signed, accumulate, umaal)
            }
            Insn::Div { signed, rd, rn, rm } => self.divide(signed, [rd, rn, rm]),
            Insn::HalfMul { op, rd, rn, rm, ra, x, y } => self.multiply_halves(op, [rd, rn, rm, ra], [x, y]),
            Insn::DualMul { op, rd, rn, rm, ra, x } => self.multiply_dual(op, [rd, rn, rm, ra], x),
            Insn::LoadStore { load, size, signed, rt, rn, offset, index, add, wback, unpriv: false } => {
                let address = self.address(rn, offset, index, add);
                self.transfer(load, size, signed, [rt, rn], address, wback)
            }
            Insn::LoadLiteral { size, signed, rt, imm, add } => self.load_literal(size, signed, rt, imm, add),
            Insn::LoadStoreDual { load, rt, rt2, rn, imm, index, add, wback } => {
                self.transfer_pair(load, [rt, rt2, rn], imm, [index, add, wback])
            }
            Insn::LoadStoreMultiple { load, rn, list, wback, before } => {
                self.transfer_block(load, rn, list, wback, before)
            }
            Insn::Branch { cond, offset } => self.branch(cond, offset),
            Insn::BranchLink { offset } => self.branch_link(offset),
            Insn::Bx { rm } => self.branch_exchange(rm, false),
            Insn::Blx { rm } => self.branch_exchange(rm, true),
            Insn::Cbz { nonzero, rn, offset } => self.branch_zero(nonzero, rn, offset),
            Insn::TableBranch { rn, rm, half } => self.branch_table(rn, rm, half),
            Insn::It { cond, mask } => self.begin_block(cond, mask),
            Insn::Fp(instruction) => self.float(instruction),
            _ => None,
        }
    }

    /// Executes the instruction at the program counter, unless it must be left to `rsemu` with
    /// [`Direct::leave`]. Returns true if it has been executed. The core must not be asleep.
    #[inline]
    pub(crate) fn step_itself(&mut self, instruction: &Instruction, in_block: bool) -> bool {
        self.is_calm && self.traps == 0 && self.execute(instruction, in_block).is_some()
    }

    /// Lets `rsemu` execute the instruction at the program counter, or enter a pending exception.
    ///
    /// `in_block` is true if the instruction may be inside an IT block.
    pub(crate) fn leave(&mut self, instruction: &Instruction, in_block: bool) -> Stepped {
        let is_system = self.reaches_system(instruction);
        self.put_registers();
        let stepped = self.rsemu.step(in_block);
        self.registers = self.rsemu.registers();
        self.floats.read_after(&self.rsemu, instruction);
        let is_plain = !is_system
            && !matches!(
                instruction.kind,
                Kind::Special | Kind::ChangeState | Kind::Barrier | Kind::Wait | Kind::SupervisorCall
            );
        // `rsemu` found no exception due before this instruction, which has made none due.
        self.is_calm = is_plain && stepped == Stepped::Instruction && !self.protection.is_timer_running;
        if !is_plain {
            self.protection = self.rsemu.protection();
        }
        stepped
    }

    /// Gives `rsemu` all registers.
    fn put_registers(&mut self) {
        let stack = self.registers.r[13];
        if self.uses_process_stack() {
            self.registers.psp = stack;
        } else {
            self.registers.msp = stack;
        }
        self.rsemu.set_registers(self.registers);
        self.floats.write(&mut self.rsemu);
    }

    /// Returns true if the stack pointer is PSP.
    fn uses_process_stack(&self) -> bool {
        self.registers.control & CONTROL_PROCESS_STACK != 0 && !self.registers.in_handler()
    }

    /// Returns true if an address of a load or store may be that of a system register.
    fn reaches_system(&self, instruction: &Instruction) -> bool {
        any_register(instruction.address, |register| self.get(register) >> 28 == 0xe)
    }

    /// Returns core register 0 to 15. Number 15 is the address of the instruction that executes,
    /// and 4.
    #[inline]
    fn get(&self, register: u8) -> u32 {
        self.registers.r[usize::from(register & 15)]
    }

    /// Sets core register 0 to 14. Where an encoding is unpredictable and names 15, nothing
    /// changes.
    #[inline]
    fn set(&mut self, register: u8, value: u32) {
        if register < 15 {
            self.registers.r[usize::from(register & 15)] = value;
        }
    }

    #[inline]
    fn has_flag(&self, flag: u32) -> bool {
        self.registers.xpsr & flag != 0
    }

    #[inline]
    fn set_negative_zero(&mut self, result: u32) {
        let zero = if result == 0 { xpsr::Z } else { 0 };
        self.registers.xpsr = self.registers.xpsr & !(xpsr::N | xpsr::Z) | result & xpsr::N | zero;
    }

    /// Runs a function on `rsemu`, and reads the registers that it may have changed.
    fn reconfigure(&mut self, change: impl FnOnce(&mut Rsemu)) {
        self.put_registers();
        change(&mut self.rsemu);
        self.registers = self.rsemu.registers();
        self.floats = FloatRegisters::of(&self.rsemu);
        self.protection = self.rsemu.protection();
        self.is_calm = false;
    }
}

impl Core for Direct {
    #[inline]
    fn pc(&self) -> u32 {
        self.registers.r[15]
    }

    fn set_pc(&mut self, address: u32) {
        self.registers.r[15] = address;
    }

    #[inline]
    fn register(&self, index: u8) -> u32 {
        self.registers.r[usize::from(index & 15)]
    }

    fn set_register(&mut self, index: u8, value: u32) {
        self.registers.r[usize::from(index & 15)] = value;
    }

    fn float_register(&self, index: u8) -> u32 {
        self.floats.get(index)
    }

    fn set_float_register(&mut self, index: u8, bits: u32) {
        self.floats.set(index, bits);
    }

    #[inline]
    fn status(&self) -> u32 {
        self.registers.xpsr
    }

    fn is_asleep(&self) -> bool {
        self.rsemu.is_asleep()
    }

    fn is_timer_running(&self) -> bool {
        self.rsemu.is_timer_running()
    }

    #[inline]
    fn is_in_trace_block(&self, registers: u16) -> bool {
        any_register(registers, |register| self.get(register) & !0xfff == DWT_ADDRESS)
    }

    #[inline]
    fn is_in_system_block(&self, registers: u16) -> bool {
        any_register(registers, |register| self.get(register) & !0xfff == SYSTEM_ADDRESS)
    }

    fn debug_monitor_control(&self) -> u32 {
        self.rsemu.debug_monitor_control()
    }

    fn set_debug_monitor_control(&mut self, bits: u32) {
        self.rsemu.set_debug_monitor_control(bits);
    }

    fn cycle_counter(&self) -> Option<u32> {
        self.rsemu.cycle_counter()
    }

    fn set_cycle_counter(&mut self, cycles: u32) {
        self.rsemu.set_cycle_counter(cycles);
    }

    fn exceptions(&self) -> (u16, u32) {
        self.rsemu.exceptions()
    }

    fn is_reset_requested(&self) -> bool {
        self.rsemu.is_reset_requested()
    }

    fn is_locked_up(&self) -> bool {
        self.rsemu.is_locked_up()
    }

    fn fault(&self) -> CpuFault {
        self.rsemu.fault()
    }

    fn prepare_call(&mut self) {
        self.reconfigure(Rsemu::prepare_call);
    }

    fn reset(&mut self) {
        self.reconfigure(Rsemu::reset);
    }

    fn set_interrupt(&mut self, line: u16, asserted: bool) {
        self.is_calm = false;
        self.rsemu.set_interrupt(line, asserted);
    }
}
