//! Macro for functions in assembly, simple functions, and functions that end in an error.

use core::arch::global_asm;

macro_rules! operations {
    ($section:literal: $($name:ident: $($line:literal),+;)*) => {
        $(global_asm!(
            ".syntax unified",
            ".fpu fpv4-sp-d16",
            concat!(".section ", $section, ", \"ax\", %progbits"),
            concat!(".global ", stringify!($name)),
            concat!(".type ", stringify!($name), ", %function"),
            ".thumb_func",
            concat!(stringify!($name), ":"),
            $($line,)+
            concat!(".size ", stringify!($name), ", . - ", stringify!($name)),
            ".balign 4",
            options(raw),
        );)*
    };
}

pub(crate) use operations;

operations! { ".operations":
    nothing: "bx lr";
    mac_loop: "mov r2, #0", "mov r3, #0",
        "0: smlal r2, r3, r0, r1", "smmla r3, r0, r1, r3", "mla r2, r0, r1, r2", "add r1, r1, #3", "subs r0, r0, #1", "bne 0b",
        "mov r0, r2", "bx lr";
    float_loop: "vmov s0, r1", "vmov s1, r1", "vmov s2, r1",
        "0: vmul.f32 s0, s0, s1", "vfma.f32 s0, s1, s2", "vadd.f32 s2, s0, s1", "vmul.f32 s2, s2, s1", "subs r0, r0, #1",
        "bne 0b", "vmov r0, s0", "bx lr";
    endless: "b endless";
    undefined: "udf #7";
    breakpoint: "bkpt #3", "bx lr";
    load: "ldr r0, [r0]", "bx lr";
    store: "str r1, [r0]", "bx lr";
    jump: "bx r0";
    sleep: "wfi", "mov r0, #1", "bx lr";
    divide_by: "sdiv r0, r0, r1", "bx lr";
}

unsafe extern "C" {
    #[link_name = "undefined"]
    fn undefined_operation() -> !;
}

/// Ends the program at an undefined instruction.
pub(crate) fn undefined() -> ! {
    // SAFETY: the function faults and does not return.
    unsafe { undefined_operation() }
}
