@ The loops of a contact for a Cortex-M4F: malleus_scrape_read(course, values, end),
@ malleus_scrape_limit(limited, pieces, values, end),
@ malleus_scrape_limit_halves(limited, pieces, rises, end, values),
@ malleus_scrape_smooth(history, taps, frames, taps_end), and
@ malleus_scrape_add_up(adding, frames, slopes).
@
@ The bits are those of portable.rs.

    .syntax unified
    .thumb
    .fpu fpv4-sp-d16
    .section .text.malleus_scrape,"ax",%progbits

@ The coefficients a to d of a course's interval, two in a word, as terms of 1, t, t^2 and t^3 of
@ the way t from its middle: 512 (a + 23 b + 23 c + d), 3072 (d - a + 5 (c - b)),
@ 6144 (a - b - c + d), and 4096 (d - a + 3 (b - c)).
    .macro course_terms
    ldr     r10, [r3]
    ldr     r11, [r3, #4]
    vmov    r12, s0
    smuad   r4, r10, r12
    smladx  r4, r11, r12, r4
    vmov    r12, s1
    smuad   r5, r10, r12
    smuadx  lr, r11, r12
    sub     r5, lr, r5
    vmov    r12, s2
    smuad   r6, r10, r12
    smladx  r6, r11, r12, r6
    vmov    r12, s3
    smuad   r7, r10, r12
    smuadx  lr, r11, r12
    sub     r7, r7, lr
    .endm

@ The next place of a course, and its value. Label \value follows a course's next interval.
    .macro course_value value, next
    add     r1, r1, r2
    adds    r0, r0, r1
    bvs     \next
\value: smmlar  r12, r7, r0, r6
    smmlar  r12, r12, r0, r5
    smmlar  r12, r12, r0, r4
    str     r12, [r8], #4
    .endm

@ The interval before or behind: by the sign of the way. The table goes round.
    .macro course_next value
    asrs    r12, r1, #31
    add     r3, r3, r12, lsl #2
    adds    r3, r3, #2
    vmov    r10, s5
    vmov    r11, s4
    cmp     r3, r10
    it      hs
    movhs   r3, r11
    cmp     r3, r11
    it      lo
    sublo   r3, r10, #2
    course_terms
    b       \value
    .endm

@ Values of the spline along a course.
@ Registers: r0 way from the interval's middle, r1 speed, r2 its step, r3 coefficients of the
@ interval, r4-r7 terms, r8 values, r9 their end, r10 a and b, r11 c and d, r12 sum; s0-s3 weights
@ of the coefficients, s4 the table's first one, s5 the end of its points.
    .p2align 4
    .global malleus_scrape_read
    .type   malleus_scrape_read, %function
malleus_scrape_read:
    push    {r4-r11, lr}
    mov     r8, r1
    mov     r9, r2
    ldr     r12, =0x2e000200
    vmov    s0, r12
    ldr     r12, =0x3c000c00
    vmov    s1, r12
    ldr     r12, =0xe8001800
    vmov    s2, r12
    ldr     r12, =0x3000f000
    vmov    s3, r12
    ldm     r0, {r0-r5}
    vmov    s4, r4
    vmov    s5, r5
    course_terms
    sub     r12, r9, r8
    tst     r12, #4
    bne     2f
1:  course_value 3, 5f
2:  course_value 4, 6f
    cmp     r8, r9
    bne     1b
    pop     {r4-r11, pc}
5:  course_next 3b
6:  course_next 4b
    .ltorg
    .size   malleus_scrape_read, . - malleus_scrape_read

@ A value's argument of tanh, and the place of its piece.
    .macro limit_argument value, piece
    smmulr  \value, \value, r4
    ssat    \piece, #9, \value, asr #14
    .endm

@ Terms of both pieces, from their places, and tanh of both arguments into r12 and r0.
    .macro limit_both
    add     r11, r1, r11, lsl #3
    add     lr, r1, lr, lsl #3
    ldr     r12, [r11, #4]
    ldr     r11, [r11]
    ldr     r0, [lr, #4]
    ldr     lr, [lr]
    smlabb  r12, r12, r9, r12
    smlawb  r12, r12, r9, r11
    smlabb  r0, r0, r10, r0
    smlawb  r0, r0, r10, lr
    .endm

@ Limits each value by tanh, parabolas of 512 pieces from -8 to 8, and takes its rise.
@ Registers: r0 and r12 slopes, r1 pieces from 0 on, r2 values, r3 their end, r4 factor, r5 its
@ step, r6 rise, r7 its step, r8 what is added, r9 and r10 arguments, r11 and lr pieces; s0 limits.
    .p2align 4
    .global malleus_scrape_limit
    .type   malleus_scrape_limit, %function
malleus_scrape_limit:
    push    {r4-r11, lr}
    vmov    s0, r0
    ldm     r0, {r4-r8}
    sub     r12, r3, r2
    tst     r12, #4
    beq     1f
    ldr     r9, [r2]
    movs    r10, #0
    movs    lr, #0
    add     r4, r4, r5
    limit_argument r9, r11
    limit_both
    add     r6, r6, r7
    smmlar  r12, r12, r6, r8
    str     r12, [r2], #4
    cmp     r2, r3
    beq     2f
1:  ldr     r9, [r2]
    ldr     r10, [r2, #4]
    add     r4, r4, r5
    limit_argument r9, r11
    add     r4, r4, r5
    limit_argument r10, lr
    limit_both
    add     r6, r6, r7
    smmlar  r12, r12, r6, r8
    add     r6, r6, r7
    smmlar  r0, r0, r6, r8
    str     r12, [r2], #4
    str     r0, [r2], #4
    cmp     r2, r3
    bne     1b
2:  vmov    r0, s0
    str     r4, [r0]
    str     r6, [r0, #8]
    pop     {r4-r11, pc}
    .size   malleus_scrape_limit, . - malleus_scrape_limit

@ Limits values two by two, and takes the rise of their mean.
@ Registers as above, but s1 values to read, r2 rises, r3 their end.
    .p2align 4
    .global malleus_scrape_limit_halves
    .type   malleus_scrape_limit_halves, %function
malleus_scrape_limit_halves:
    push    {r4-r11, lr}
    vmov    s0, r0
    ldr     r12, [sp, #36]
    vmov    s1, r12
    ldm     r0, {r4-r8}
1:  vmov    r12, s1
    ldr     r9, [r12], #4
    ldr     r10, [r12], #4
    vmov    s1, r12
    add     r4, r4, r5
    limit_argument r9, r11
    limit_argument r10, lr
    limit_both
    asr     r12, r12, #1
    add     r12, r12, r0, asr #1
    add     r6, r6, r7
    smmlar  r12, r12, r6, r8
    str     r12, [r2], #4
    cmp     r2, r3
    bne     1b
    vmov    r0, s0
    str     r4, [r0]
    str     r6, [r0, #8]
    pop     {r4-r11, pc}
    .size   malleus_scrape_limit_halves, . - malleus_scrape_limit_halves

@ Four taps for four outputs. The last product of a tap for the fourth output waits for its value,
@ so that loads come four in a row, 5 cycles for 8 products.
    .macro smooth_taps
    ldr.w   r10, [r0], #4
    ldr.w   r11, [r0], #4
    ldr.w   r2, [r1], #4
    ldr.w   r3, [r1], #4
    smmlar  r7, r10, r12, r7
    smmlar  r4, r8, r2, r4
    smmlar  r5, r9, r2, r5
    smmlar  r6, r10, r2, r6
    smmlar  r7, r11, r2, r7
    smmlar  r4, r9, r3, r4
    smmlar  r5, r10, r3, r5
    smmlar  r6, r11, r3, r6
    ldr.w   r8, [r0], #4
    ldr.w   r9, [r0], #4
    ldr.w   r2, [r1], #4
    ldr.w   r12, [r1], #4
    smmlar  r7, r8, r3, r7
    smmlar  r4, r10, r2, r4
    smmlar  r5, r11, r2, r5
    smmlar  r6, r8, r2, r6
    smmlar  r7, r9, r2, r7
    smmlar  r4, r11, r12, r4
    smmlar  r5, r8, r12, r5
    smmlar  r6, r9, r12, r6
    .endm

@ Registers: r0 window, r1 taps, r2, r3 and r12 taps, r4-r7 sums, r8-r11 window of four values,
@ lr outputs; s0 the first of the taps' steps that runs, s1 taps, s2 window, s3 end of the outputs.
    .p2align 4
    .global malleus_scrape_smooth
    .type   malleus_scrape_smooth, %function
malleus_scrape_smooth:
    push    {r4-r11, lr}
    mov     lr, r2
    sub     r12, r3, r1
    add     r12, r12, r12, lsl #1
    ldr     r2, =2f + 1
    sub     r2, r2, r12, lsl #1
    vmov    s0, r2
    vmov    s1, r1
    vmov    s2, r0
    add     r2, lr, #128
    vmov    s3, r2
1:  vmov    r0, s2
    vmov    r1, s1
    vmov    r2, s0
    ldr     r8, [r0], #4
    ldr     r9, [r0], #4
    add     r3, r0, #8
    vmov    s2, r3
    movs    r4, #0
    movs    r5, #0
    movs    r6, #0
    movs    r7, #0
    mov     r12, #0
    bx      r2
    .rept   16
    smooth_taps
    .endr
2:  ldr     r10, [r0]
    vmov    r2, s3
    smmlar  r7, r10, r12, r7
    lsls    r4, r4, #1
    lsls    r5, r5, #1
    lsls    r6, r6, #1
    lsls    r7, r7, #1
    stm     lr!, {r4-r7}
    cmp     lr, r2
    bne     1b
    pop     {r4-r11, pc}
    .ltorg
    .size   malleus_scrape_smooth, . - malleus_scrape_smooth

@ The slope behind a frame, and the force before its shift, in r0.
    .macro add_frame
    ldr     r0, [r1]
    smlal   r2, r3, r3, r5
    smlal   r2, r3, r0, r4
    ssat    r3, #31, r3
    add     r8, r8, r9
    str     r3, [r10], #4
    smmul   r12, r3, r8
    add     r6, r6, r7
    eor     r11, r12, r12, asr #31
    sub     r12, r11, r12, asr #31
    smmla   r0, r0, r6, r12
    .endm

@ The force from rises.
@ Registers: r0 frame, r1 frames, r2 and r3 slope, r4 gain, r5 leak, r6 vertical gain, r7 its step,
@ r8 horizontal gain, r9 its step, r10 slopes, lr shift; s0 gains of the tick, s1 end of the frames.
    .p2align 4
    .global malleus_scrape_add_up
    .type   malleus_scrape_add_up, %function
malleus_scrape_add_up:
    push    {r4-r11, lr}
    vmov    s0, r0
    add     lr, r1, #128
    vmov    s1, lr
    mov     r10, r2
    ldr     lr, [r0, #36]
    ldm     r0, {r2-r9}
    cmp     lr, #0
    bne     3f
    vmov    lr, s0
    ldr     lr, [lr, #32]
1:  add_frame
    asr     r0, r0, lr
    str     r0, [r1], #4
    add_frame
    vmov    r12, s1
    asr     r0, r0, lr
    str     r0, [r1], #4
    cmp     r1, r12
    bne     1b
2:  vmov    r0, s0
    strd    r2, r3, [r0]
    pop     {r4-r11, pc}
3:  add_frame
    lsl     r12, r0, lr
    asr     r11, r12, lr
    cmp     r11, r0
    bne     5f
4:  str     r12, [r1], #4
    add_frame
    lsl     r12, r0, lr
    asr     r11, r12, lr
    cmp     r11, r0
    bne     7f
6:  str     r12, [r1], #4
    vmov    r12, s1
    cmp     r1, r12
    bne     3b
    b       2b
5:  asr     r12, r0, #31
    mvn     r12, r12
    eor     r12, r12, #0x80000000
    b       4b
7:  asr     r12, r0, #31
    mvn     r12, r12
    eor     r12, r12, #0x80000000
    b       6b
    .size   malleus_scrape_add_up, . - malleus_scrape_add_up
