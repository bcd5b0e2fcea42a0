//! Core that the crate `rsemu` emulates.
//!
//! It is known to differ from silicon in the sign and payload of the NaNs that VSUB makes. Two more
//! differences are made up for here (tests/interrupts.rs):
//! - Its exception frames do not hold the IT state, so that the rest of an interrupted IT block
//!   would execute unconditionally. This module keeps the IT states.
//! - It overwrites FPSCR before a lazy frame has kept it, so that the flags of a comparison would
//!   be lost. This module never makes frames lazy, which would save time on silicon but none here.

use std::sync::Arc;

use rsemu::core::space::AddressSpace;
use rsemu::cpu::arm::v7m::sys::{MPU_REGIONS, fpccr, fsr};
use rsemu::cpu::arm::v7m::{ArmV7m, Config, Regs, xpsr};

use super::{Core, CpuFault, DWT_ADDRESS, SYSTEM_ADDRESS, Stepped, any_register};

/// Fewest cycles that rsemu itself counts for entering or leaving an exception.
///
/// Fewer cycles exclude a change of exception. A long LDM or VLDM reaches this number too, and is
/// told apart by the exception number.
const EXCEPTION_CYCLES: u64 = 7;

/// Bits of CPACR that give full access to coprocessors 10 and 11, the FPU.
const CPACR_FPU: u32 = 0xf << 20;

/// Bit of SysTick's control register that enables it.
const SYST_CSR_ENABLE: u32 = 1;

/// Bit of CONTROL that makes thread mode unprivileged.
const CONTROL_UNPRIVILEGED: u32 = 1;

/// Bits of MPU_CTRL that enable the protection unit, and the default map for privileged code.
const MPU_CTRL_ENABLE: u32 = 1;
const MPU_CTRL_DEFAULT_MAP: u32 = 4;

/// Addresses that agree with a base in the bits of a mask.
#[derive(Debug, Clone, Copy, Default)]
struct Window {
    base: u32,
    mask: u32,
}

/// Memory of which the protection unit decides access by access, and the switches of the timer and
/// the FPU.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Protection {
    windows: [Window; MPU_REGIONS],
    count: usize,
    /// True if SysTick counts.
    pub(super) is_timer_running: bool,
    /// True if the FPU is on, all of its half of a frame is written at once, and only for code that
    /// uses the FPU.
    pub(super) is_float_plain: bool,
}

impl Protection {
    fn add(&mut self, window: Window) {
        self.windows[self.count] = window;
        self.count += 1;
    }

    /// Returns true if an aligned access of at most a word at `address` needs a decision.
    #[inline]
    pub(super) fn covers(&self, address: u32) -> bool {
        self.windows[..self.count].iter().any(|window| address & window.mask == window.base)
    }
}

/// Core that `rsemu` emulates.
#[derive(Debug)]
pub(super) struct Rsemu {
    core: ArmV7m,
    /// Number of the exception that is handled, 0 for none.
    exception: u16,
    /// Number of active exceptions, preempted ones included.
    active: u32,
    /// IT state that each active exception interrupted, as bits of the status word.
    interrupted_blocks: Vec<u32>,
}

/// Number of the exception that SVC raises.
const SUPERVISOR_CALL: u16 = 11;

impl Rsemu {
    /// Makes a core on an address space, which boots from the vector table at `vectors`. It has not
    /// executed an instruction yet.
    pub(super) fn new(space: Arc<AddressSpace>, vectors: u32) -> Rsemu {
        let core = ArmV7m::new(Config::CORTEX_M4F.with_reset_vtor(vectors).with_priority_bits(4));
        core.attach_space(space);
        // The first step is the reset sequence, which executes no instruction.
        core.step();
        core.with_sys(|sys| sys.fpccr &= !fpccr::LSPEN);
        Rsemu { core, exception: 0, active: 0, interrupted_blocks: Vec::new() }
    }

    /// Returns all registers of the core.
    pub(super) fn registers(&self) -> Regs {
        self.core.regs()
    }

    /// Sets all registers of the core.
    pub(super) fn set_registers(&mut self, registers: Regs) {
        self.core.set_regs(registers);
    }

    /// Executes the instruction at the program counter, or enters a pending exception.
    ///
    /// `in_block` is true if the instruction may be inside an IT block.
    #[inline]
    pub(super) fn step(&mut self, in_block: bool) -> Stepped {
        let block = if in_block { self.core.xpsr() & xpsr::IT_MASK } else { 0 };
        if self.core.step() < EXCEPTION_CYCLES { Stepped::Instruction } else { self.exception_changed(block) }
    }

    /// Switches the FPU on.
    pub(super) fn switch_float_on(&mut self) {
        self.core.with_sys(|sys| sys.cpacr |= CPACR_FPU);
    }

    /// Returns FPSCR.
    pub(super) fn float_status(&self) -> u32 {
        self.core.fpscr()
    }

    /// Sets FPSCR.
    pub(super) fn set_float_status(&mut self, bits: u32) {
        self.core.set_fpscr(bits);
    }

    /// Returns the memory that not each access may reach, as the system registers have it now.
    pub(super) fn protection(&self) -> Protection {
        let unprivileged = self.core.regs().control & CONTROL_UNPRIVILEGED != 0;
        self.core.with_sys(|sys| {
            let mut protection = Protection {
                is_timer_running: sys.syst_csr & SYST_CSR_ENABLE != 0,
                is_float_plain: sys.fp_enabled(!unprivileged)
                    && sys.fpccr & (fpccr::ASPEN | fpccr::LSPEN | fpccr::LSPACT) == fpccr::ASPEN,
                ..Protection::default()
            };
            let is_on = sys.mpu_ctrl & MPU_CTRL_ENABLE != 0;
            if unprivileged || is_on && sys.mpu_ctrl & MPU_CTRL_DEFAULT_MAP == 0 {
                protection.add(Window { base: 0, mask: 0 });
            } else if is_on {
                for (base, attributes) in sys.mpu_rbar.iter().zip(sys.mpu_rasr) {
                    let bits = (attributes >> 1 & 0x1f) + 1;
                    if attributes & 1 != 0 && bits >= 5 {
                        let mask = if bits == 32 { 0 } else { u32::MAX << bits };
                        protection.add(Window { base: base & mask, mask });
                    }
                }
            }
            protection
        })
    }

    /// Finds out if the last step entered or left an exception, and keeps or restores the IT state.
    ///
    /// `block` is the IT state before the step.
    fn exception_changed(&mut self, block: u32) -> Stepped {
        let exception = (self.core.xpsr() & xpsr::EXCEPTION) as u16;
        if exception == self.exception {
            return Stepped::Instruction;
        }
        let active = self.core.with_sys(|sys| sys.active_count());
        let entered = active > self.active;
        if entered {
            // The return goes to the instruction after SVC, so its IT state is kept.
            let block = if exception == SUPERVISOR_CALL { advanced(block) } else { block };
            self.interrupted_blocks.push(block);
        } else if active < self.active {
            self.interrupted_blocks.truncate(active as usize + 1);
            let block = self.interrupted_blocks.pop().unwrap_or(0);
            if block != 0 {
                self.core.set_xpsr(self.core.xpsr() & !xpsr::IT_MASK | block);
            }
        }
        self.exception = exception;
        self.active = active;
        if entered { Stepped::Exception(exception) } else { Stepped::Return }
    }
}

/// Returns the IT state of the next instruction (ITAdvance, DDI 0403 A7.3.2), as bits of the status
/// word.
pub(super) fn advanced(block: u32) -> u32 {
    let state = block >> 8 & 0xfc | block >> 25 & 3;
    let next = if state & 7 == 0 { 0 } else { state & 0xe0 | state << 1 & 0x1f };
    (next & 0xfc) << 8 | (next & 3) << 25
}

impl Core for Rsemu {
    #[inline]
    fn pc(&self) -> u32 {
        self.core.pc()
    }

    fn set_pc(&mut self, address: u32) {
        self.core.set_pc(address);
    }

    #[inline]
    fn register(&self, index: u8) -> u32 {
        self.core.reg(index)
    }

    fn set_register(&mut self, index: u8, value: u32) {
        self.core.set_reg(index, value);
    }

    fn float_register(&self, index: u8) -> u32 {
        self.core.s(index)
    }

    fn set_float_register(&mut self, index: u8, bits: u32) {
        self.core.set_s(index, bits);
    }

    #[inline]
    fn status(&self) -> u32 {
        self.core.xpsr()
    }

    fn is_asleep(&self) -> bool {
        self.core.is_asleep()
    }

    fn is_timer_running(&self) -> bool {
        self.core.with_sys(|sys| sys.syst_csr & SYST_CSR_ENABLE != 0)
    }

    #[inline]
    fn is_in_trace_block(&self, registers: u16) -> bool {
        any_register(registers, |register| self.core.reg(register) & !0xfff == DWT_ADDRESS)
    }

    #[inline]
    fn is_in_system_block(&self, registers: u16) -> bool {
        any_register(registers, |register| self.core.reg(register) & !0xfff == SYSTEM_ADDRESS)
    }

    fn debug_monitor_control(&self) -> u32 {
        self.core.with_sys(|sys| sys.demcr)
    }

    fn set_debug_monitor_control(&mut self, bits: u32) {
        self.core.with_sys(|sys| sys.demcr = bits);
    }

    fn cycle_counter(&self) -> Option<u32> {
        self.core.with_sys(|sys| sys.cyccnt_enabled().then_some(sys.dwt_cyccnt))
    }

    fn set_cycle_counter(&mut self, cycles: u32) {
        self.core.with_sys(|sys| sys.dwt_cyccnt = cycles);
    }

    #[inline]
    fn exceptions(&self) -> (u16, u32) {
        (self.exception, self.active)
    }

    fn is_reset_requested(&self) -> bool {
        self.core.reset_requested()
    }

    fn is_locked_up(&self) -> bool {
        self.core.is_locked_up()
    }

    fn fault(&self) -> CpuFault {
        let (status, hard, address) = self.core.with_sys(|sys| (sys.cfsr, sys.hfsr, sys.bfar));
        let named = [
            (fsr::UF_INVSTATE, "a jump to an address without the Thumb bit (INVSTATE)"),
            (fsr::UF_INVPC, "an invalid exception return (INVPC)"),
            (fsr::UF_NOCP, "a coprocessor instruction without that coprocessor (NOCP)"),
            (fsr::UF_UNALIGNED, "an unaligned access (UNALIGNED)"),
            (fsr::UF_DIVBYZERO, "a division by zero (DIVBYZERO)"),
            (fsr::MM_IACCVIOL | fsr::MM_DACCVIOL, "an access that the memory protection unit refuses"),
            (fsr::BF_STKERR | fsr::BF_UNSTKERR, "an exception frame outside memory (STKERR)"),
        ];
        if status & fsr::BF_PRECISERR != 0 {
            return CpuFault::Bus { address, fetch: false };
        }
        if status & fsr::BF_IBUSERR != 0 {
            return CpuFault::Bus { address: self.core.bus_faults().1, fetch: true };
        }
        if status & fsr::UF_UNDEFINSTR != 0 {
            return CpuFault::Undefined;
        }
        let other = named.iter().find(|(bits, _)| status & bits != 0);
        CpuFault::Other(
            other.map_or(if hard & fsr::HF_VECTTBL != 0 { "a vector outside memory" } else { "a hard fault" }, |f| f.1),
        )
    }

    fn prepare_call(&mut self) {
        // The reset sequence is the only way out of sleep and lock-up.
        self.core.request_reset();
        self.core.step();
        self.exception = 0;
        self.active = 0;
        self.interrupted_blocks.clear();
        self.core.with_sys(|sys| {
            sys.active.fill(0);
            sys.pending.fill(0);
            sys.cfsr = 0;
            sys.hfsr = 0;
            sys.fpccr &= !fpccr::LSPEN;
        });
        self.switch_float_on();
        let Regs { msp, psp, .. } = self.core.regs();
        self.core.set_regs(Regs {
            r: [0; 16],
            msp,
            psp,
            xpsr: xpsr::T,
            primask: false,
            faultmask: false,
            basepri: 0,
            control: 0,
        });
        self.core.set_fpscr(0);
    }

    fn reset(&mut self) {
        self.prepare_call();
        self.core.with_sys(|sys| sys.cpacr &= !CPACR_FPU);
        self.core.request_reset();
        self.core.step();
        self.core.with_sys(|sys| sys.fpccr &= !fpccr::LSPEN);
    }

    fn set_interrupt(&mut self, line: u16, asserted: bool) {
        self.core.set_irq(line, asserted);
    }
}
