//! The loop of a Hertz pulse in assembly: some 22 cycles a frame, counted from the code. In Rust,
//! LLVM makes a product of 64 by 64 bits of one by 32 where a factor is the same in all frames.
#![allow(unsafe_code)] // assembly; the only place of this folder

use super::Turning;

core::arch::global_asm!(
    r#"
    .syntax unified
    .thumb
    .section .text.malleus_pulse_means,"ax",%progbits
    .p2align 2
    .global malleus_pulse_means
    .type   malleus_pulse_means, %function
@ r0: force, r1: its end, r2: Turning
malleus_pulse_means:
    push    {{r2, r4-r11, lr}}
    ldm     r2, {{r2-r10}}               @ sine, cosine (Q62), sin d, cos d - 1, even, odd, peak
1:
    smmlar  r11, r9, r5, r8              @ even + odd cos
    smull   r12, r11, r3, r11
    lsr     r12, r12, #30
    orr     r12, r12, r11, lsl #2
    usat    r12, #29, r12                @ mean, Q29
    smull   r11, r12, r12, r10
    lsr     r11, r11, #29
    orr     r11, r11, r12, lsl #3
    ldr     r12, [r0]
    mov     lr, r5
    qadd    r12, r12, r11
    str     r12, [r0], #4
    rsb     r11, r6, #0
    smlal   r4, r5, r5, r7
    smlal   r4, r5, r3, r11
    smlal   r2, r3, r3, r7
    smlal   r2, r3, lr, r6
    cmp     r0, r1
    bne     1b
    pop     {{r6}}
    stm     r6, {{r2-r5}}
    pop     {{r4-r11, pc}}
    .size   malleus_pulse_means, . - malleus_pulse_means
    "#
);

unsafe extern "C" {
    fn malleus_pulse_means(force: *mut i32, end: *mut i32, turning: *mut Turning);
}

/// Adds a mean to each frame of a force and turns the angle.
pub(in super::super) fn add_means(force: &mut [i32], turning: &mut Turning) {
    if force.is_empty() {
        return;
    }
    let frames = force.as_mut_ptr_range();
    // SAFETY: the loop writes to the frames of the slice, of which there is one at least, and to
    // the angle of `turning`, whose layout is that of C. It keeps all registers that a
    // callee must keep.
    unsafe { malleus_pulse_means(frames.start, frames.end, turning) }
}
