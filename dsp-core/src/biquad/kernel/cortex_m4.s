@ The hot loop of a bank of biquads for a Cortex-M4F: all sections that stand alone, one at a time, over one run of frames.
@
@ malleus_biquads(call) -> whether any section has left its bounds
@
@ The bits are those of portable.rs. Layouts (checked at compile time in cortex_m4.rs):
@   call      section 0, end 4, frames 8, then sources 12, 16 and mixes 20, 24
@   section   u 0, v 4, turn 8, damp 12, gain u 16, gain v 20, direct 24, scale 28, low 32, span 36, kind 40, source 41; BIQUAD_SECTION bytes
@
@ Registers in a loop: r0 input, r1 mix, r2 u, r3 v, r4 turn, r5 damp, r6 gain u, r7 gain v, r8 passes, r9 scale; r10, r11 inputs, r12, lr sums.
@ s0 section, s1 end, s2 frames, s3 whether one asks.
@
@ Optimisation log (nominal cycles a section and sample, 64 sections: cargo test -p host-tests --test virtual_biquads -- --nocapture):
@   11.7   sixteen frames a pass, loads in fours: 9.5 a frame, and 70 cycles a section and tick to enter and leave the loops. With what Rust
@          adds, 14.4.
    .syntax unified
    .thumb
    .fpu fpv4-sp-d16
    .section .text.malleus_biquads,"ax",%progbits

    .macro biquad_step form x
    smmlsr  r2, r4, r3, r2
    .if \form == 0
    smmlar  r3, r4, r2, r3
    .elseif \form == 1
    add     r3, r3, r2, lsl #1
    .else
    add     r3, r3, r2, lsl #2
    .endif
    .if \form == 3
    lsl     r2, r2, #1
    smmulr  r2, r2, r5
    .else
    smmlsr  r2, r5, r2, r2
    .endif
    smmlar  r2, r6, \x, r2
    smmlar  r3, r7, \x, r3
    .endm

    .macro biquad_two_frames form at
    ldr     r10, [r0, #\at]
    ldr     r11, [r0, #\at + 4]
    ldr     r12, [r1, #\at]
    ldr     lr, [r1, #\at + 4]
    smmlar  r12, r3, r9, r12
    biquad_step    \form, r10
    smmlar  lr, r3, r9, lr
    biquad_step    \form, r11
    str     r12, [r1, #\at]
    str     lr, [r1, #\at + 4]
    .endm

    .macro biquad_alone form shift
    .p2align 2
biquad_alone_\form:
    vmov    r8, s2
    subs    r8, #16
    blo     2f
1:  .irp    at, 0, 8, 16, 24, 32, 40, 48, 56
    biquad_two_frames \form, \at
    .endr
    add     r0, #64
    add     r1, #64
    subs    r8, #16
    bhs     1b
2:  adds    r8, #16
    beq     4f
3:  ldr     r10, [r0], #4
    ldr     r12, [r1]
    smmlar  r12, r3, r9, r12
    biquad_step    \form, r10
    str     r12, [r1], #4
    subs    r8, #1
    bne     3b
4:  eor     r5, r2, r2, asr #31
    eor     r4, r3, r3, asr #31
    .if \shift
    orr     r4, r4, r5, lsl #\shift
    .else
    orr     r4, r4, r5
    .endif
    b       biquad_after
    .endm

    .p2align 2
    .global malleus_biquads
    .type   malleus_biquads, %function
    .thumb_func
malleus_biquads:
    push    {r4-r11, lr}
    ldm     r0, {r1-r3}
    vmov    s0, r1
    vmov    s1, r2
    vmov    s2, r3
    mov     r4, #0
    vmov    s3, r4
    adds    r0, #12
    vmov    s4, r0
    mov     r12, r1
    cmp     r1, r2
    bhs     9f
5:  ldrb    r10, [r12, #40]
    ldrb    r0, [r12, #41]
    vmov    r1, s4
    add     r1, r1, r0, lsl #2
    ldr     r9, [r12, #28]
    ldr     r0, [r1]
    ldr     r1, [r1, #8]
    ldm     r12, {r2-r7}
    cmp     r10, #12
    beq     8f
    and     r10, r10, #3
    tbb     [pc, r10]
7:  .byte   (biquad_to_0 - 7b) / 2, (biquad_to_1 - 7b) / 2, (biquad_to_2 - 7b) / 2, (biquad_to_3 - 7b) / 2
biquad_to_0:
    b.w     biquad_alone_0
biquad_to_1:
    b.w     biquad_alone_1
biquad_to_2:
    b.w     biquad_alone_2
biquad_to_3:
    b.w     biquad_alone_3
biquad_after:
    vmov    r12, s0
    ldr     r6, [r12, #32]
    ldr     r7, [r12, #36]
    str     r2, [r12]
    str     r3, [r12, #4]
    subs    r4, r4, r6
    cmp     r4, r7
    bhs     biquad_asks
8:  vmov    r11, s1
    add     r12, #BIQUAD_SECTION
    vmov    s0, r12
    cmp     r12, r11
    blo     5b
9:  vmov    r0, s3
    pop     {r4-r11, pc}
biquad_asks:
    mov     r4, #1
    vmov    s3, r4
    b       8b
    biquad_alone 0, 0
    biquad_alone 1, 1
    biquad_alone 2, 2
    biquad_alone 3, 2
    .size   malleus_biquads, . - malleus_biquads
