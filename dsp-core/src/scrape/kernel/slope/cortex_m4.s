@ Readings of the slope for a Cortex-M4F:
@ malleus_scrape_mix_row(strip, strip_end, row, weights), and
@ malleus_scrape_read_strip(strides, mix, rises, rises_end, strip).
@
@ The bits are those of portable.rs.

    .syntax unified
    .thumb
    .fpu fpv4-sp-d16
    .section .text.malleus_scrape_slope,"ax",%progbits

@ Coefficients of two limits, which lie side by side every 6 bytes, by their weights.
@ Registers: r0 strip, r1 its end, r2 row, r3 and r12 weights, r4-r11 coefficients and their mixes.
    .p2align 4
    .global malleus_scrape_mix_row
    .type   malleus_scrape_mix_row, %function
malleus_scrape_mix_row:
    push    {r4-r11, lr}
    ldrd    r3, r12, [r3]
1:  ldr     r4, [r2]
    ldr     r5, [r2, #6]
    ldr     r6, [r2, #12]
    ldr     r7, [r2, #18]
    adds    r2, #24
    smulwb  r8, r3, r4
    smulwt  r4, r12, r4
    add     r8, r8, r4
    smulwb  r9, r3, r5
    smulwt  r5, r12, r5
    add     r9, r9, r5
    smulwb  r10, r3, r6
    smulwt  r6, r12, r6
    add     r10, r10, r6
    smulwb  r11, r3, r7
    smulwt  r7, r12, r7
    add     r11, r11, r7
    stm     r0!, {r8-r11}
    cmp     r0, r1
    bne     1b
    pop     {r4-r11, pc}
    .size   malleus_scrape_mix_row, . - malleus_scrape_mix_row

@ The spline's value at the place r1, r2 into r10. The coefficients a to d in r8 to r11.
    .macro strip_value
    and     r12, r2, #31
    add     r12, r3, r12, lsl #2
    ldm     r12, {r8-r11}
    add     r12, r9, r10
    add     lr, r8, r11
    sub     r9, r10, r9
    sub     r8, r11, r8
    add     r10, r9, r9, lsl #1
    sub     r10, r8, r10
    lsl     r10, r10, #3
    sub     r11, lr, r12
    add     r11, r11, r11, lsl #1
    lsl     r11, r11, #2
    add     r9, r9, r9, lsl #2
    add     r9, r9, r8
    add     r9, r9, r9, lsl #1
    lsl     r9, r9, #1
    add     r8, r12, r12, lsl #1
    add     r8, lr, r8, lsl #3
    sub     r8, r8, r12
    eor     r12, r1, #0x80000000
    smmlar  r10, r10, r12, r11
    smmlar  r10, r10, r12, r9
    smmlar  r10, r10, r12, r8
    .endm

@ Registers: r0 rises, r1 and r2 place, r3 strip, r4 and r5 speed, r6 its step, r7 last value,
@ r8-r12 and lr coefficients, their sums, and the value; s0 largest rise, s1 shift, s2 end of the
@ rises.
    .p2align 4
    .global malleus_scrape_read_strip
    .type   malleus_scrape_read_strip, %function
malleus_scrape_read_strip:
    push    {r4-r11, lr}
    vldr    s0, [r1, #8]
    vldr    s1, [r1, #12]
    vmov    s2, r3
    mov     r12, r2
    ldr     r3, [sp, #36]
    ldr     r6, [r0, #16]
    ldrd    r4, r5, [r0, #8]
    ldrd    r1, r2, [r0]
    mov     r0, r12
    strip_value
    mov     r7, r10
1:  adds    r4, r4, r6
    adc     r5, r5, r6, asr #31
    adds    r1, r1, r4
    adc     r2, r2, r5
    strip_value
    sub     r8, r10, r7
    vmov    r12, s0
    vmov    lr, s1
    mov     r7, r10
    add     r9, r8, r12
    cmp     r9, r12, lsl #1
    bhi     3f
2:  lsl     r8, r8, lr
    vmov    r12, s2
    str     r8, [r0], #4
    cmp     r0, r12
    bne     1b
    pop     {r4-r11, pc}
@ More than the largest rise, or less than the least.
3:  cmp     r8, #0
    ite     ge
    movge   r8, r12
    rsblt   r8, r12, #0
    b       2b
    .size   malleus_scrape_read_strip, . - malleus_scrape_read_strip
