@ Readings of the slope for a Cortex-M4F:
@ malleus_scrape_read_rises(strides, mix, rises, end, octave).
@
@ The bits are those of portable.rs.

    .syntax unified
    .thumb
    .fpu fpv4-sp-d16
    .section .text.malleus_scrape_slope,"ax",%progbits

@ Slopes at both limits into r5 and r6: the spline's weights, Q24, of four points in r7 to r10.
    .macro slope_values
    eor     r11, r1, #0x80000000
    smmulr  r12, r11, r11
    smmulr  lr, r12, r11
    asr     r12, r12, #6
    add     r12, r12, r12, lsl #1
    asr     r11, r11, #7
    add     r11, r11, r11, lsl #1
    asr     lr, lr, #5
    add     r7, r11, lr
    add     r11, r11, r11, lsl #2
    add     lr, lr, lr, lsl #1
    sub     r8, r11, lr
    add     r9, r12, #0x01000000
    rsb     r12, r12, #0x17000000
    add     lr, r2, r2, lsl #1
    vmov    r11, s9
    add     lr, r11, lr, lsl #1
    add     r10, r9, r7
    sub     r7, r9, r7
    add     r9, r12, r8
    sub     r8, r12, r8
    ldr     r11, [lr]
    ldr     r12, [lr, #6]
    smulwb  r5, r7, r11
    smulwt  r6, r7, r11
    smlawb  r5, r8, r12, r5
    smlawt  r6, r8, r12, r6
    ldr     r11, [lr, #12]
    ldr     r12, [lr, #18]
    smlawb  r5, r9, r11, r5
    smlawt  r6, r9, r11, r6
    smlawb  r5, r10, r12, r5
    smlawt  r6, r10, r12, r6
    .endm

@ Registers: r0 rises, r1 fraction, r2 point, r3 and r4 speed, r5-r12 and lr slopes, weights and
@ coefficients; s0 and s1 step of the speed, s2 and s3, s4 and s5 weights of both limits and their
@ steps, s6 and s7 last slopes, s8 number of points, s9 coefficients of the first limit, s10 largest
@ mix, s11 and s12 its shifts, s13 end of the rises, s14 mix.
    .p2align 4
    .global malleus_scrape_read_rises
    .type   malleus_scrape_read_rises, %function
malleus_scrape_read_rises:
    push    {r4-r11, lr}
    ldr     r12, [sp, #36]
    vldmia  r12, {s8-s9}
    vldmia  r1, {s2-s5}
    adds    r1, #16
    vldmia  r1, {s10-s12}
    subs    r1, #16
    vmov    s14, r1
    vmov    s13, r3
    mov     r12, r2
    ldm     r0, {r1-r6}
    mov     r0, r12
    vmov    s0, r5
    vmov    s1, r6
    slope_values
    vmov    s6, r5
    vmov    s7, r6
1:  vmov    r5, s0
    vmov    r6, s1
    adds    r3, r3, r5
    adc     r4, r4, r6
    adds    r1, r1, r3
    adc     r2, r2, r4
    vmov    r5, s8
    cmp     r2, r5
    bhs     4f
2:  slope_values
    vmov    r7, s6
    vmov    r8, s7
    vmov    s6, r5
    vmov    s7, r6
    sub     r5, r5, r7
    sub     r6, r6, r8
    vmov    r7, s2
    vmov    r8, s3
    add     r7, r7, r8
    vmov    s2, r7
    vmov    r9, s4
    vmov    r10, s5
    add     r9, r9, r10
    vmov    s4, r9
    smmulr  r5, r5, r7
    smmlar  r5, r6, r9, r5
    vmov    r6, s10
    add     r7, r5, r6
    cmp     r7, r6, lsl #1
    bhi     5f
3:  vmov    r6, s11
    vmov    r7, s12
    lsl     r5, r5, r6
    asr     r5, r5, r7
    vmov    r6, s13
    str     r5, [r0], #4
    cmp     r0, r6
    bne     1b
    vmov    r1, s14
    vmov    r5, s2
    vmov    r6, s4
    str     r5, [r1]
    str     r6, [r1, #8]
    pop     {r4-r11, pc}
@ Over the table's end, or before its begin.
4:  cmp     r2, #0
    ite     mi
    addmi   r2, r2, r5
    subpl   r2, r2, r5
    b       2b
@ More than the largest mix, or less than the least.
5:  cmp     r5, #0
    ite     ge
    movge   r5, r6
    rsblt   r5, r6, #0
    b       3b
    .size   malleus_scrape_read_rises, . - malleus_scrape_read_rises
