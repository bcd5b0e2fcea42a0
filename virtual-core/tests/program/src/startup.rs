//! Vector table, copy of the initialised data, and interrupts that count.

use core::arch::global_asm;
use core::sync::atomic::{AtomicU32, Ordering};

static INITIALISED: AtomicU32 = AtomicU32::new(41);
static TICKS: AtomicU32 = AtomicU32::new(0);

global_asm!(
    ".syntax unified",
    ".section .vectors, \"a\", %progbits",
    ".word _stack_start, reset, fault, fault, fault, fault, fault, 0, 0, 0, 0, supervisor_call, 0, 0, 0, tick",
    ".word first_interrupt, second_interrupt, third_interrupt",
    ".section .operations, \"ax\", %progbits",
    ".global reset",
    ".type reset, %function",
    ".thumb_func",
    "reset:",
    "ldr r0, =_data_start",
    "ldr r1, =_data_end",
    "ldr r2, =_data_source",
    "0: cmp r0, r1",
    "beq 1f",
    "ldr r3, [r2], #4",
    "str r3, [r0], #4",
    "b 0b",
    "1: movw r0, #0xed88",
    "movt r0, #0xe000",
    "ldr r1, [r0]",
    "orr r1, r1, #0xf00000",
    "str r1, [r0]",
    "dsb",
    "isb",
    "bl main",
    "bkpt #0",
    "b .",
    ".pool",
    ".size reset, . - reset",
    ".global fault",
    ".type fault, %function",
    ".thumb_func",
    "fault: b fault",
    ".size fault, . - fault",
    ".global supervisor_call",
    ".type supervisor_call, %function",
    ".thumb_func",
    "supervisor_call: bx lr",
    ".size supervisor_call, . - supervisor_call",
);

#[unsafe(no_mangle)]
extern "C" fn main() -> u32 {
    // The write makes it initialised data instead of a constant.
    INITIALISED.fetch_add(1, Ordering::Relaxed) + 1
}

/// Counts interrupts of SysTick.
#[unsafe(no_mangle)]
extern "C" fn tick() {
    TICKS.fetch_add(1, Ordering::Relaxed);
}

/// Counts external interrupts 0.
#[unsafe(no_mangle)]
extern "C" fn first_interrupt() {
    TICKS.fetch_add(1, Ordering::Relaxed);
}

/// Runs SysTick every `period` cycles and sleeps until it has come `count` times.
#[unsafe(no_mangle)]
extern "C" fn sleep_for_ticks(period: u32, count: u32) -> u32 {
    TICKS.store(0, Ordering::Relaxed);
    // SAFETY: these are SysTick's registers, which nothing else in this program uses.
    unsafe {
        core::ptr::write_volatile(0xe000_e014 as *mut u32, period);
        core::ptr::write_volatile(0xe000_e018 as *mut u32, 0);
        core::ptr::write_volatile(0xe000_e010 as *mut u32, 7);
    }
    while TICKS.load(Ordering::Relaxed) < count {
        // SAFETY: the instruction waits and touches nothing.
        unsafe { core::arch::asm!("wfi", options(nomem, nostack)) };
    }
    // SAFETY: this is SysTick's register, which nothing else in this program uses.
    unsafe { core::ptr::write_volatile(0xe000_e010 as *mut u32, 0) };
    TICKS.load(Ordering::Relaxed)
}

/// Function that the tests call by name, so that the linker keeps it.
#[used]
#[unsafe(link_section = ".vectors")]
static KEPT: extern "C" fn(u32, u32) -> u32 = sleep_for_ticks;
