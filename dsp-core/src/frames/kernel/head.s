@ The hot loop of a head for a Cortex-M4F: malleus_frames_convolve(run).
@
@ The bits are those of portable.rs. The run is HeadRun of cortex_m4.rs.

    .syntax unified
    .thumb
    .fpu fpv4-sp-d16
    .section .text.malleus_frames,"ax",%progbits

@ A run of a head, three outputs at once. 5.5 cycles a sample of force, 1.8 a product, and 5 for the
@ loop of sixteen samples; four loads in a row take 5 cycles, two 3. 32 for each range of force, and
@ 63 for the rounding of three outputs.
@ Registers: r0 force, r1 taps, r2-r3 samples of force, r4-r9 sums of the outputs 0 to 2, r10-r12
@ and lr window of taps; s0 force of two blocks, s1 taps from lag 0 of the first frame on, s2 first
@ range, s3 end of the ranges, s4 frame, s5 output, s6 outputs left, s7 right shift, s8 doublings,
@ s9-s10 half a bus step, s11 next range, s12 end of the loop's samples.
    .macro convolve_two a b c d
    ldr     r2, [r0], #4
    ldr     r3, [r0], #4
    ldr     \c, [r1], #4
    ldr     \d, [r1], #4
    smlal   r4, r5, r2, \c
    smlal   r6, r7, r2, \b
    smlal   r8, r9, r2, \a
    smlal   r4, r5, r3, \d
    smlal   r6, r7, r3, \c
    smlal   r8, r9, r3, \b
    .endm

@ 80 bytes, which the entry into the loop counts on.
    .macro convolve_four
    convolve_two r10, r11, r12, lr
    convolve_two r12, lr, r10, r11
    .endm

@ Adds a sum to an output, in bus steps and saturating; leaves behind the last one. r0 output, r1
@ outputs left, r2 right shift, r3 32 less it, r10 it less 32, r11 the largest step, r12 doublings.
    .macro put_output lo hi
    lsr     \lo, \lo, r2
    lsl     lr, \hi, r3
    orr     \lo, \lo, lr
    cmp     r2, #32
    it      ge
    asrge   \lo, \hi, r10
    asr     \hi, \hi, r2
    cmp     \hi, \lo, asr #31
    it      ne
    eorne   \lo, r11, \hi, asr #31
    movs    lr, r12
    beq     8f
7:  qadd    \lo, \lo, \lo
    subs    lr, lr, #1
    bne     7b
8:  ldr     lr, [r0]
    qadd    lr, lr, \lo
    str     lr, [r0], #4
    subs    r1, r1, #1
    beq     9f
    .endm

    .p2align 4
    .global malleus_frames_convolve
    .type   malleus_frames_convolve, %function
malleus_frames_convolve:
    push    {r4-r11, lr}
    vldm    r0, {s0-s10}
1:  vmov    r4, s9
    vmov    r5, s10
    mov     r6, r4
    mov     r7, r5
    mov     r8, r4
    mov     r9, r5
    vmov    r12, s2
2:  ldrh    r0, [r12]
    ldrh    r2, [r12, #2]
    add     r12, r12, #4
    vmov    s11, r12
    vmov    r3, s4
    add     lr, r3, #6                  @ no force behind the third output, in whole fours
    bic     lr, lr, #3
    cmp     r2, lr
    it      hi
    movhi   r2, lr
    subs    r2, r2, r0
    ble     5f
    vmov    r1, s1
    vmov    r12, s0
    sub     r3, r0, r3
    add     r1, r1, r3, lsl #2
    add     r0, r12, r0, lsl #2
    add     r3, r0, r2, lsl #2
    vmov    s12, r3
    adr     r3, 4f
    and     r2, r2, #12                 @ samples beside whole sixteens, 20 bytes of the loop each
    orr     r3, r3, #1
    sub     r3, r3, r2, lsl #4
    sub     r3, r3, r2, lsl #2
    ldrd    r10, r11, [r1], #8
    bx      r3
    .p2align 2
3:  convolve_four
    convolve_four
    convolve_four
    convolve_four
4:  vmov    r2, s12
    cmp     r0, r2
    bne     3b
5:  vmov    r12, s11
    vmov    r3, s3
    cmp     r12, r3
    bne     2b
    vmov    r0, s5
    vmov    r1, s6
    vmov    r2, s7
    vmov    r12, s8
    mvn     r11, #0x80000000
    rsb     r3, r2, #32
    sub     r10, r2, #32
    put_output r4, r5
    put_output r6, r7
    put_output r8, r9
    vmov    r3, s4
    vmov    s5, r0
    vmov    s6, r1
    add     r3, r3, #3
    vmov    s4, r3
    b       1b
9:  pop     {r4-r11, pc}
    .size   malleus_frames_convolve, . - malleus_frames_convolve
