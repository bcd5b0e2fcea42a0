@ A loop's band-pass for a Cortex-M4F. The bits are those of portable.rs.
@
@ malleus_loop_{0,1,2,3}(band, line, mix, frames): k of the band's shift.
@ band (checked at compile time in cortex_m4.rs): u 0, v 4, turn 8, damp 12, gain_u 16, gain_v 20, scale 24, shift 28.
@ Nominal cycles a frame, this file alone: 167 as plain Rust on a bank of its own, 11 here.

    .syntax unified
    .thumb
    .section .text.malleus_loop,"ax",%progbits

@ r4 u, r5 v, r6 turn, r7 damp, r8 gain_u, r9 gain_v, r10 scale
    .macro loop_frame k x sum
    smmlsr  r4, r7, r4, r4
    smmlsr  r4, r6, r5, r4
    .if \k == 0
    smmlar  r5, r6, r4, r5
    .else
    add     r5, r5, r4, lsl #\k
    .endif
    smmlar  r4, r8, \x, r4
    smmlar  r5, r9, \x, r5
    smmulr  \x, r5, r10
    qadd    \sum, \sum, \x
    .endm

    .macro loop_of k
    .p2align 2
    .global malleus_loop_\k
    .type   malleus_loop_\k, %function
    .thumb_func
malleus_loop_\k:
    push    {r0, r4-r11, lr}
    ldm     r0, {r4-r10}
    subs    r3, #8
    blo     2f
1:  .irp    at, 0, 8, 16, 24
    ldr     r11, [r1, #\at]
    ldr     r12, [r1, #\at + 4]
    ldr     lr, [r2, #\at]
    ldr     r0, [r2, #\at + 4]
    loop_frame \k, r11, lr
    loop_frame \k, r12, r0
    str     lr, [r2, #\at]
    str     r0, [r2, #\at + 4]
    .endr
    adds    r1, #32
    adds    r2, #32
    subs    r3, #8
    bhs     1b
2:  adds    r3, #8
    beq     4f
3:  ldr     r11, [r1], #4
    ldr     lr, [r2]
    loop_frame \k, r11, lr
    str     lr, [r2], #4
    subs    r3, #1
    bne     3b
4:  pop     {r0}
    strd    r4, r5, [r0]
    pop     {r4-r11, pc}
    .size   malleus_loop_\k, . - malleus_loop_\k
    .endm

    loop_of 0
    loop_of 1
    loop_of 2
    loop_of 3
