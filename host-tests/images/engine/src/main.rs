//! The instrument on a bare Cortex-M4F, without a board.
//!
//! Nothing starts by itself: the virtual core writes kits, events and forces into memory and calls
//! the exported functions. They return 0, or a negative number that gives the reason for a failure.
//! The code on the host is in `host-tests/src/on_chip`.
#![no_std]
#![no_main]

mod engine;
mod wire;

use core::panic::PanicInfo;

/// Entry that a linker needs; the virtual core never starts here.
#[unsafe(no_mangle)]
pub extern "C" fn _start() -> ! {
    loop {}
}

#[panic_handler]
fn panic(_: &PanicInfo<'_>) -> ! {
    // An undefined instruction: the virtual core stops and names the function.
    // SAFETY: never returns.
    unsafe { core::arch::asm!("udf #0", options(noreturn)) }
}
