//! Program that the tests of virtual-core run: single instructions, loops, whole functions, and a
//! start-up.

#![no_std]
#![no_main]

mod compiled;
mod encodings;
mod instructions;
mod interrupted;
mod operations;
mod rules;
mod startup;

#[panic_handler]
fn panic(_: &core::panic::PanicInfo<'_>) -> ! {
    operations::undefined()
}
