//! The bank alone and its rivals on a bare Cortex-M4F, without a board.
//!
//! Nothing starts by itself: the virtual core writes modes and forces into memory and calls the
//! exported functions. Their documentation says what they return. The code on the host is in
//! `host-tests/src/on_chip` and `host-tests/src/run_time`.
#![no_std]
#![no_main]

mod bank;
mod float;
mod rivals;
mod room;
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
