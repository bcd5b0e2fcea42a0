//! Square root of the Cortex-M4F's floating-point unit: 20 cycles with the call, where the library
//! takes some 75 (both by the cycle model). What banks and filters play is compared with the PC
//! bit for bit (`cargo test -p host-tests --test on_chip`).
#![allow(unsafe_code)] // assembly; the only place of this file

core::arch::global_asm!(
    r#"
    .syntax unified
    .thumb
    .section .text.malleus_root,"ax",%progbits
    .p2align 2
    .global malleus_root
    .type   malleus_root, %function
malleus_root:
    vsqrt.f32 s0, s0
    bx      lr
    .size   malleus_root, . - malleus_root
    "#,
    options(raw)
);

unsafe extern "C" {
    fn malleus_root(x: f32) -> f32;
}

/// Square root, rounded to the nearest `f32`.
#[inline(always)]
pub(crate) fn rounded_root(x: f32) -> f32 {
    // SAFETY: the function works on the register of its argument alone, which holds the result.
    unsafe { malleus_root(x) }
}
