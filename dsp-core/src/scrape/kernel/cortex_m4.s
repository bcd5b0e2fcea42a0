@ The loops of a slow contact for a Cortex-M4F: malleus_scrape_read(table, places, values, end),
@ malleus_scrape_read_map(map, values, end, directions), malleus_scrape_limit(limited, terms,
@ values, end), and malleus_scrape_smooth(history, taps, frames, taps_end).
@
@ The bits are those of portable.rs.

    .syntax unified
    .thumb
    .fpu fpv4-sp-d16
    .section .text.malleus_scrape,"ax",%progbits

@ A value of the spline for each place: coefficients a to d, two in a word, times the weights of 1,
@ f, f^2, f^3 that spline.rs has: 256 (a + 4 b + c), 1536 (c - a), 3072 (a - 2 b + c) and
@ 2048 (d - a + 3 (b - c)).
@ Registers: r0 table, r1 places, r2 values, r3 their end, r4 256 and 1024, r5 -1536 and 1536,
@ r6 256 and 3072, r7 3072 and -6144, r8 -2048 and 6144, s0 -6144 and 2048, r9 a and b, r10 c and d,
@ r11 fraction, r12 sum, lr term.
    .p2align 4
    .global malleus_scrape_read
    .type   malleus_scrape_read, %function
malleus_scrape_read:
    push    {r4-r11, lr}
    ldr     r4, =0x04000100
    ldr     r5, =0x0600fa00
    ldr     r6, =0x0c000100
    ldr     r7, =0xe8000c00
    ldr     r8, =0x1800f800
    ldr     r12, =0x0800e800
    vmov    s0, r12
1:  ldrd    r10, r11, [r1], #8
    add     r10, r0, r10, lsl #1
    ldr     r9, [r10]
    ldr     r10, [r10, #4]
    vmov    lr, s0
    smuad   r12, r9, r8
    smlad   r12, r10, lr, r12
    smuad   lr, r9, r7
    smlabt  lr, r10, r6, lr
    smmlar  r12, r12, r11, lr
    smulbb  lr, r9, r5
    smlabt  lr, r10, r5, lr
    smmlar  r12, r12, r11, lr
    smuad   lr, r9, r4
    smlabb  lr, r10, r6, lr
    smmlar  r12, r12, r11, lr
    lsl     r12, r12, #3
    str     r12, [r2], #4
    cmp     r2, r3
    bne     1b
    pop     {r4-r11, pc}
    .ltorg
    .size   malleus_scrape_read, . - malleus_scrape_read

@ A row of a map: its four coefficients times the row's weight onto the sums of their columns.
    .macro map_row weight
    smmulr  r12, r1, \weight
    ldr     lr, [r0]
    ldr     r2, [r0, #4]
    add     r0, r0, r3
    smlawb  r4, r12, lr, r4
    smlawt  r5, r12, lr, r5
    smlawb  r6, r12, r2, r6
    smlawt  r7, r12, r2, r7
    .endm

@ The four rows of a curvature, with its weight in the direction.
    .macro map_rows value step
    vmov    r1, \value
    vmov    r2, \step
    add     r1, r1, r2
    vmov    \value, r1
    map_row r8
    map_row r9
    map_row r10
    map_row r11
    .endm

@ A value of the map for each place.
@ Registers: r0 row, r1 weight of the direction, r2 coefficients, r3 bytes of a row, r4-r7 sums of
@ columns, r8-r11 weights of rows, r12 weight of a row and direction, lr coefficients; s0 values,
@ s1 their end, s2 map, s3 bytes of a row, s4 bytes to the next map, s5 and s6 places along rows and
@ across, s8-s13 weights of the directions and their steps, s15 fraction.
    .p2align 4
    .global malleus_scrape_read_map
    .type   malleus_scrape_read_map, %function
malleus_scrape_read_map:
    push    {r4-r11, lr}
    vldmia  r0, {s2-s6}
    vldmia  r3, {s8-s13}
    vmov    s0, r1
    vmov    s1, r2
1:  vmov    r0, s6
    ldrd    r1, r2, [r0], #8
    vmov    s6, r0
    vmov    r3, s3
    vmov    r0, s2
    mla     r0, r1, r3, r0
    vmov    r1, s5
    ldrd    r12, lr, [r1], #8
    vmov    s5, r1
    add     r0, r0, r12, lsl #1
    vmov    s15, lr
    smmulr  r12, r2, r2
    smmulr  r11, r12, r2
    asr     r11, r11, #1
    asr     r12, r12, #2
    asr     r2, r2, #3
    sub     r9, r11, r12, lsl #1
    add     r9, r9, r9, lsl #1
    add     r9, r9, #0x40000000
    add     r10, r2, r12
    sub     r10, r10, r11
    add     r10, r10, r10, lsl #1
    add     r10, r10, #0x10000000
    rsb     r8, r9, #0x60000000
    sub     r8, r8, r10
    sub     r8, r8, r11
    movs    r4, #6
    movs    r5, #6
    movs    r6, #6
    movs    r7, #6
    map_rows s8, s9
    vmov    r2, s4
    add     r0, r0, r2
    map_rows s10, s11
    vmov    r2, s4
    add     r0, r0, r2
    map_rows s12, s13
    asr     r4, r4, #2
    asr     r5, r5, #2
    asr     r6, r6, #2
    asr     r7, r7, #2
    vmov    lr, s15
    add     r12, r4, r6
    sub     r2, r5, r6
    add     r2, r2, r2, lsl #1
    add     r2, r2, r7
    sub     r2, r2, r4
    lsl     r2, r2, #1
    sub     r3, r12, r5, lsl #1
    add     r3, r3, r3, lsl #1
    smmlar  r2, r2, lr, r3
    sub     r3, r6, r4
    add     r3, r3, r3, lsl #1
    asr     r3, r3, #1
    smmlar  r2, r2, lr, r3
    add     r3, r12, r5, lsl #2
    asr     r3, r3, #2
    smmlar  r2, r2, lr, r3
    lsl     r2, r2, #3
    vmov    r0, s0
    vmov    r1, s1
    str     r2, [r0], #4
    vmov    s0, r0
    cmp     r0, r1
    bne     1b
    pop     {r4-r11, pc}
    .size   malleus_scrape_read_map, . - malleus_scrape_read_map

@ Limits each value by tanh, cubics of 64 pieces in 0 to 8, and takes its rise.
@ Registers: r0 limits and rises of the tick, r1 terms, r2 values, r3 their end, r4 factor, r5 its
@ step, r6 rise, r7 its step, r8 mean, r9-r12 terms, lr value and place in the piece; s0 sign.
    .p2align 4
    .global malleus_scrape_limit
    .type   malleus_scrape_limit, %function
malleus_scrape_limit:
    push    {r4-r11, lr}
    ldm     r0, {r4-r8}
1:  ldr     lr, [r2]
    add     r4, r4, r5
    smmulr  lr, lr, r4
    asr     r9, lr, #31
    vmov    s0, r9
    eor     lr, lr, r9
    sub     lr, lr, r9
    usat    lr, #22, lr
    lsr     r9, lr, #16
    lsl     lr, lr, #16
    add     r9, r1, r9, lsl #4
    lsr     lr, lr, #1
    ldm     r9, {r9-r12}
    smmlar  r11, r12, lr, r11
    smmlar  r10, r11, lr, r10
    smmlar  r9, r10, lr, r9
    vmov    r10, s0
    eor     r9, r10, r9, lsl #3
    sub     r9, r9, r10
    add     r6, r6, r7
    smmulr  r9, r9, r6
    sub     r9, r9, r8
    str     r9, [r2], #4
    cmp     r2, r3
    bne     1b
    str     r4, [r0]
    str     r6, [r0, #8]
    pop     {r4-r11, pc}
    .size   malleus_scrape_limit, . - malleus_scrape_limit

@ A tap for four outputs: two loads in a row take 3 cycles, and four products 4.
    .macro smooth_tap a b c d
    ldr     r12, [r1], #4
    ldr     \d, [r0], #4
    smmlar  r4, \a, r12, r4
    smmlar  r5, \b, r12, r5
    smmlar  r6, \c, r12, r6
    smmlar  r7, \d, r12, r7
    .endm

@ Registers: r0 window, r1 taps, r2 outputs, r3 end of the taps, r4-r7 sums, r8-r11 window of four
@ values, r12 tap, lr end of the outputs; on the stack the begins of the window and of the taps.
    .p2align 4
    .global malleus_scrape_smooth
    .type   malleus_scrape_smooth, %function
malleus_scrape_smooth:
    push    {r4-r11, lr}
    add     lr, r2, #128
    push    {r0, r1}
1:  ldr     r8, [r0], #4
    ldr     r9, [r0], #4
    ldr     r10, [r0], #4
    movs    r4, #0
    movs    r5, #0
    movs    r6, #0
    movs    r7, #0
2:  smooth_tap r8, r9, r10, r11
    smooth_tap r9, r10, r11, r8
    smooth_tap r10, r11, r8, r9
    smooth_tap r11, r8, r9, r10
    cmp     r1, r3
    bne     2b
    lsls    r4, r4, #1
    lsls    r5, r5, #1
    lsls    r6, r6, #1
    lsls    r7, r7, #1
    stm     r2!, {r4-r7}
    ldrd    r0, r1, [sp]
    adds    r0, r0, #16
    str     r0, [sp]
    cmp     r2, lr
    bne     1b
    add     sp, sp, #8
    pop     {r4-r11, pc}
    .size   malleus_scrape_smooth, . - malleus_scrape_smooth
