//! Program that carries out a script: a list of accesses in flash sector 5, which the tests write.
//!
//! Each line of the script has three words: a number of `virtual-board/tests/flash/script.rs`, an
//! address and a value. What the program reads is listed in RAM, behind the number of words read.

#![no_std]
#![no_main]

use core::arch::{asm, global_asm};
use core::ptr::{read_volatile, write_volatile};

// The vector table: the initial stack pointer, the entry, and no other vectors.
global_asm!(
    ".section .vectors, \"a\"",
    ".word _stack_start",
    ".word reset",
    ".space 0x1b8",
    // A store from RAM: `str r1, [r0]`, and the way back.
    ".section .ramfunc, \"awx\"",
    ".thumb_func",
    ".global store_from_ram",
    "store_from_ram:",
    "str r1, [r0]",
    "bx lr",
);

unsafe extern "C" {
    fn store_from_ram(address: u32, value: u32);
}

/// First line of the script.
const SCRIPT: *const [u32; 3] = 0x0802_0000 as *const [u32; 3];
/// Number of words that were read. The words follow.
const READ: *mut u32 = 0x2000_8000 as *mut u32;

/// Entry of the program.
#[unsafe(no_mangle)]
extern "C" fn reset() -> ! {
    // SAFETY: the tests write scripts whose addresses the chip has, and RAM behind the program is
    // free for what is read.
    unsafe {
        write_volatile(READ, 0);
        let mut line = SCRIPT;
        loop {
            let [kind, address, value] = read_volatile(line);
            line = line.add(1);
            match kind {
                1 => write_volatile(address as *mut u32, value),
                2 => write_volatile(address as *mut u16, value as u16),
                3 => write_volatile(address as *mut u8, value as u8),
                4 => {
                    let word = read_volatile(address as *const u32);
                    let count = read_volatile(READ) + 1;
                    write_volatile(READ.add(count as usize), word);
                    write_volatile(READ, count);
                }
                5 => while read_volatile(address as *const u32) & value == 0 {},
                6 => store_from_ram(address, value),
                _ => loop {
                    asm!("wfi");
                },
            }
        }
    }
}

#[panic_handler]
fn panic(_: &core::panic::PanicInfo<'_>) -> ! {
    loop {}
}
