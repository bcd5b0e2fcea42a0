@ The loops of a ball for a Cortex-M4F: malleus_scrape_turn(frames, turning),
@ malleus_scrape_sink(frames, sinking), and
@ malleus_scrape_press(frames, force, pressing, powers).
@
@ The bits are those of portable.rs.

    .syntax unified
    .thumb
    .fpu fpv4-sp-d16
    .section .text.malleus_scrape_roll,"ax",%progbits

@ Registers: r0 depths, factors 128 bytes behind, r1 end of the depths, r2 cosine, r3 sine, r4 and
@ r5 half and its step, r6 and r7 whole and its step, r8 rest, r9 offset, r10 and r11 rate and its
@ step, lr value.
    .p2align 4
    .global malleus_scrape_turn
    .type   malleus_scrape_turn, %function
malleus_scrape_turn:
    push    {r4-r11, lr}
    ldm     r1, {r2-r11}
    add     r1, r0, #128
1:  .rept   2
    add     r4, r4, r5
    add     r6, r6, r7
    smmlsr  r2, r3, r4, r2
    smmulr  lr, r2, r6
    add     r3, r3, lr, lsl #1
    smmlsr  r2, r3, r4, r2
    add     r10, r10, r11
    smmul   r12, r3, r10
    smmlsr  lr, r2, r9, r8
    str     r12, [r0, #128]
    str     lr, [r0], #4
    .endr
    cmp     r0, r1
    bne     1b
    pop     {r4-r11, pc}
    .size   malleus_scrape_turn, . - malleus_scrape_turn

@ Registers: r0 depths, factors and slopes 128 and 256 bytes behind, r1 sinking, r2 and r3 height,
@ r4 and r5 rise and its step, r6 leak, r7 and r8 rate and its step, r9 factor of 1, r10 depth, r11
@ factor, r12 slope, lr end of the depths.
    .p2align 4
    .global malleus_scrape_sink
    .type   malleus_scrape_sink, %function
malleus_scrape_sink:
    push    {r4-r11, lr}
    ldm     r1, {r2-r9}
    add     lr, r0, #128
1:  .rept   2
    ldr     r12, [r0, #256]
    ldr     r10, [r0]
    ldr     r11, [r0, #128]
    add     r4, r4, r5
    smlal   r2, r3, r3, r6
    smlal   r2, r3, r12, r4
    ssat    r3, #31, r3
    add     r10, r10, r3
    usat    r10, #31, r10
    add     r7, r7, r8
    smmla   r11, r12, r7, r11
    qadd    r11, r11, r9
    usat    r11, #31, r11
    str     r11, [r0, #128]
    str     r10, [r0], #4
    .endr
    cmp     r0, lr
    bne     1b
    strd    r2, r3, [r1]
    pop     {r4-r11, pc}
    .size   malleus_scrape_sink, . - malleus_scrape_sink

@ Registers: r0 depths, factors 128 bytes behind, r1 force, r2 powers, r3 stiffness, r4 and r5
@ terms, r6 and r7 what is left out, r8 its share, r9 mantissa and way from the middle, r10 factor,
@ r11 force, r12 zeros and shift, lr terms and product; s0 shift, s1 end of the force, s2 pressing.
    .p2align 4
    .global malleus_scrape_press
    .type   malleus_scrape_press, %function
malleus_scrape_press:
    push    {r4-r11, lr}
    vmov    s2, r2
    mov     r12, r3
    ldr     r4, [r2, #16]
    ldrd    r6, r7, [r2]
    ldr     r3, [r2, #8]
    ldr     r8, [r2, #12]
    mov     r2, r12
    vmov    s0, r4
    add     r4, r1, #128
    vmov    s1, r4
1:  ldr     r9, [r0], #4
    ldr     r10, [r0, #124]
    ldr     r11, [r1]
    clz     r12, r9
    bic     r12, r12, #1
    lsl     r9, r9, r12
    lsr     lr, r9, #26
    add     lr, r2, lr, lsl #4
    lsl     r9, r9, #6
    ldr     r4, [lr, #8]
    ldr     r5, [lr, #4]
    ldr     lr, [lr]
    eor     r9, r9, #0x80000000
    smmlar  r4, r4, r9, r5
    smmlar  lr, r4, r9, lr
    vmov    r5, s0
    add     r12, r12, r12, lsr #1
    smmulr  lr, lr, r3
    smmulr  lr, lr, r10
    adds    r12, r12, r5
    bmi     3f
    asr     r5, lr, r12
2:  qsub    r5, r5, r7
    smlal   r6, r7, r5, r8
    vmov    r4, s1
    qadd    r11, r11, r5
    str     r11, [r1], #4
    cmp     r1, r4
    bne     1b
    vmov    r2, s2
    strd    r6, r7, [r2]
    pop     {r4-r11, pc}
@ A shift to the left, saturated; at most 31, by which only 0 comes back.
3:  rsb     r12, r12, #0
    cmp     r12, #31
    it      hi
    movhi   r12, #31
    lsl     r5, lr, r12
    asr     r4, r5, r12
    cmp     r4, lr
    beq     2b
    asr     r5, lr, #31
    mvn     r5, r5
    eor     r5, r5, #0x80000000
    b       2b
    .size   malleus_scrape_press, . - malleus_scrape_press
