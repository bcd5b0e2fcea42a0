@ Readings of a map for a Cortex-M4F: malleus_scrape_read_map(map, values, end, directions), and
@ malleus_scrape_read_cells(course, values, end).
@
@ The bits are those of portable.rs.

    .syntax unified
    .thumb
    .fpu fpv4-sp-d16
    .section .text.malleus_scrape_map,"ax",%progbits

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

@ The sums of two columns over a map's four rows, with the map's weight.
    .macro cell_map weight
    ldr     r3, [r12, #\weight]
    .rept   4
    ldr     r2, [r0]
    add     r0, r0, r1
    .if     cell_row == 0
    smlawb  r4, r3, r2, r4
    smlawt  r8, r3, r2, r8
    .elseif cell_row == 1
    smlawb  r5, r3, r2, r5
    smlawt  r9, r3, r2, r9
    .elseif cell_row == 2
    smlawb  r6, r3, r2, r6
    smlawt  r10, r3, r2, r10
    .else
    smlawb  r7, r3, r2, r7
    smlawt  r11, r3, r2, r11
    .endif
    .set    cell_row, (cell_row + 1) & 3
    .endr
    .endm
    .set    cell_row, 0

@ The terms of a column across the rows, from its four sums.
    .macro cell_terms a, b, c, d, place
    add     r2, \b, \c
    add     r3, \a, \d
    sub     \c, \c, \b
    sub     \d, \d, \a
    add     lr, r2, r2, lsl #1
    add     lr, r3, lr, lsl #3
    sub     lr, lr, r2
    asr     \a, lr, #5
    sub     r3, r3, r2
    add     r3, r3, r3, lsl #1
    asr     r3, r3, #3
    add     r2, \c, \c, lsl #2
    add     r2, r2, \d
    add     r2, r2, r2, lsl #1
    asr     r2, r2, #4
    add     lr, \c, \c, lsl #1
    sub     lr, \d, lr
    asr     lr, lr, #2
    strd    \a, r2, [r12, #\place]
    strd    r3, lr, [r12, #\place + 8]
    .endm

@ Two columns of a cell.
    .macro cell_columns place
    ldr     r4, [r12, #64]
    ldr     r5, [r12, #68]
    mov     r6, r5
    mov     r7, r4
    mov     r8, r4
    mov     r9, r5
    mov     r10, r5
    mov     r11, r4
    cell_map 52
    ldr     lr, [r12, #48]
    add     r0, r0, lr
    cell_map 56
    ldr     lr, [r12, #48]
    add     r0, r0, lr
    cell_map 60
    cell_terms r4, r5, r6, r7, \place
    cell_terms r8, r9, r10, r11, (\place + 16)
    .endm

@ The next cell of an axis, by the sign of its way; the map goes round.
    .macro cell_next way, index, count
    asr     r4, \way, #31
    ldr     r5, [r12, #\index]
    ldr     r6, [r12, #\count]
    add     r5, r5, r4, lsl #1
    adds    r5, r5, #1
    it      mi
    addmi   r5, r5, r6
    cmp     r5, r6
    it      hs
    movhs   r5, #0
    str     r5, [r12, #\index]
    .endm

@ Registers that a new cell needs.
    .macro cell_keep
    vmov    s1, r0
    vmov    s2, r1
    vmov    s3, r2
    vmov    s4, r3
    vmov    s5, lr
    .endm

@ Address of a cell's coefficients into r0, and the bytes of a row into r1.
    .macro cell_place
    ldr     r4, [r12, #28]
    ldr     r1, [r12, #44]
    ldr     r6, [r12, #40]
    ldr     r7, [r12, #24]
    mla     r0, r4, r1, r6
    add     r0, r0, r7, lsl #1
    .endm

@ The value of a column across the rows.
    .macro cell_value column
    ldm     r4!, {r5-r8}
    smmlar  r8, r8, r1, r7
    smmlar  r8, r8, r1, r6
    smmlar  \column, r8, r1, r5
    .endm

@ Values of a map along a course: see MapCourse for what lies where.
@ Registers: r0 and r1 ways from the middle of the cell along rows and across, r2 and r3 speeds,
@ r4-r11 sums and terms, r12 course, lr values; s0 their end. A new cell keeps r0 to r3 and lr in s1
@ to s5, and its first column in s6; s7 is 1 if only the first two columns are new.
    .p2align 4
    .global malleus_scrape_read_cells
    .type   malleus_scrape_read_cells, %function
malleus_scrape_read_cells:
    push    {r4-r11, lr}
    mov     r12, r0
    mov     lr, r1
    vmov    s0, r2
    ldm     r12, {r0-r3}
    ldrd    r4, r5, [r12, #16]
    add     r2, r2, r4
    add     r3, r3, r5
    adds    r0, r0, r2
    bvc     1f
    cell_next r2, 24, 32
1:  adds    r1, r1, r3
    bvc     6f
    cell_next r3, 28, 36
    b       6f
2:  ldrd    r4, r5, [r12, #16]
    add     r2, r2, r4
    add     r3, r3, r5
    adds    r0, r0, r2
    bvs     4f
    adds    r1, r1, r3
    bvs     5f
3:  add     r4, r12, #72
    cell_value r9
    cell_value r10
    cell_value r11
    cell_value r8
    add     r5, r10, r11
    add     r6, r9, r8
    sub     r7, r11, r10
    sub     r8, r8, r9
    add     r9, r7, r7, lsl #1
    sub     r9, r8, r9
    lsl     r9, r9, #3
    sub     r10, r6, r5
    add     r10, r10, r10, lsl #1
    lsl     r10, r10, #2
    add     r7, r7, r7, lsl #2
    add     r7, r7, r8
    add     r7, r7, r7, lsl #1
    lsl     r7, r7, #1
    add     r8, r5, r5, lsl #1
    add     r6, r6, r8, lsl #3
    sub     r6, r6, r5
    smmlar  r9, r9, r0, r10
    smmlar  r9, r9, r0, r7
    smmlar  r9, r9, r0, r6
    str     r9, [lr], #4
    vmov    r4, s0
    cmp     lr, r4
    bne     2b
    pop     {r4-r11, pc}
@ Along the rows three columns stay, of which one is computed anew with its new neighbour.
4:  cell_next r2, 24, 32
    adds    r1, r1, r3
    bvs     5f
    cell_keep
    cmp     r2, #0
    add     r4, r12, #88
    ldm     r4, {r5-r11, lr}
    blt     7f
    subs    r4, #16
    stm     r4, {r5-r11, lr}
    cell_place
    adds    r0, #4
    b       9f
7:  adds    r4, #16
    stm     r4, {r5-r11, lr}
    movs    r4, #1
    vmov    s7, r4
    cell_place
    b       8f
5:  cell_next r3, 28, 36
6:  cell_keep
    movs    r4, #0
    vmov    s7, r4
    cell_place
    vmov    s6, r0
8:  cell_columns 72
    vmov    r4, s7
    cmp     r4, #0
    bne     10f
    vmov    r0, s6
    adds    r0, #4
9:  cell_columns 104
10: vmov    r0, s1
    vmov    r1, s2
    vmov    r2, s3
    vmov    r3, s4
    vmov    lr, s5
    b       3b
    .size   malleus_scrape_read_cells, . - malleus_scrape_read_cells
