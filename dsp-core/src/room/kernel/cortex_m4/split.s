@ Splits. The bits are those of portable.rs.

    .syntax unified
    .thumb
    .section .text.malleus_room,"ax",%progbits

@ malleus_room_split(split, state, low, high, count, thin) -> or of the sizes in high: portable.rs,
@ split.
@ Layouts: split is α, the number of sections, then c1/2 and c2/2 of each; state is x1, y1, rest,
@ then x1, x2, y1, y2, rest of each section.
@ sp: coefficients and state of the next section, low, high; split 16, count 56, thin 60.

@ One sample of a second-order section: r7, r8 new inputs, r9 rest, r10, r11 free, r12 c1/2, lr
@ c2/2. y takes the place of y2.
    .macro second_order x x1 x2 y1 y2 at
    sub     r11, \x, \y2
    mov     r10, #0
    smlal   r9, r10, r11, lr
    sub     r11, \x1, \y1
    smlal   r9, r10, r11, r12
    add     \y2, \x2, r10, lsl #2
    str     \y2, [r0, #\at]
    .endm

    .macro first_order x x1 shaped
    sub     r8, \x, r5
    .if \shaped
    mov     r7, #0
    smlal   r6, r7, r8, r3
    .else
    smmulr  r7, r8, r3
    .endif
    sub     r5, \x1, r7, lsl #1
    str     r5, [r1], #4
    .endm

@ The first-order section over a block: r0 from, r1 to, r2 count, r3 α, r4-r6 state.
    .macro first_orders shaped
    subs    r2, #4
    blt     2f
1:  ldr     r9, [r0]
    ldr     r10, [r0, #4]
    first_order r9, r4, \shaped
    first_order r10, r9, \shaped
    ldr     r9, [r0, #8]
    ldr     r4, [r0, #12]
    adds    r0, #16
    first_order r9, r10, \shaped
    first_order r4, r9, \shaped
    subs    r2, #4
    bge     1b
2:  adds    r2, #4
    beq     4f
3:  ldr     r9, [r0], #4
    first_order r9, r4, \shaped
    mov     r4, r9
    subs    r2, #1
    bne     3b
4:
    .endm

    .macro parted low high at whole
    .if \whole
    add     r8, \low, \high
    .endif
    sub     \low, \low, \high
    .if \whole
    ssat    r8, #28, r8, asr #1
    .endif
    eor     r9, \low, \low, asr #31
    .if \whole
    str     r8, [r0], #4
    .endif
    orr     r3, r3, r9
    str     \low, [r1, #\at]
    .endm

@ r0 what is kept of low, r1 high, r2 count, r12 low
    .macro parting thin
    subs    r2, #4
    blt     2f
1:  ldr     r4, [r12]
    ldr     r5, [r12, #4]
    ldr     r6, [r1]
    ldr     r7, [r1, #4]
    ldr     r10, [r12, #8]
    ldr     r11, [r1, #8]
    parted  r4, r6, 0, 1
    parted  r5, r7, 4, 1 - \thin
    ldr     r5, [r12, #12]
    ldr     r7, [r1, #12]
    add     r12, #16
    parted  r10, r11, 8, 1
    parted  r5, r7, 12, 1 - \thin
    adds    r1, #16
    subs    r2, #4
    bge     1b
2:  adds    r2, #4
    beq     4f
@ one, two or three are left: of these every second is kept where it is to be thin
3:  ldr     r4, [r12], #4
    ldr     r6, [r1]
    parted  r4, r6, 0, 1
    adds    r1, #4
    subs    r2, #1
    beq     4f
    ldr     r4, [r12], #4
    ldr     r6, [r1]
    parted  r4, r6, 0, 1 - \thin
    adds    r1, #4
    subs    r2, #1
    bne     3b
4:
    .endm

    .global malleus_room_split
    .type malleus_room_split, %function
    .thumb_func
malleus_room_split:
    push    {r0, r4-r11, lr}
    sub     sp, #16
    add     r4, r0, #8
    add     r5, r1, #12
    str     r4, [sp]
    str     r5, [sp, #4]
    str     r2, [sp, #8]
    str     r3, [sp, #12]
    mov     r12, r1
    mov     r1, r3
    ldr     r3, [r0]
    mov     r0, r2
    ldm     r12, {r4-r6}
    ldr     r2, [sp, #56]
    cmp     r3, #0x68000000
    bgt     5f
    first_orders 0
    b       6f
5:  first_orders 1
6:  stm     r12, {r4-r6}
@ Sections, by turns of low and of high; r2 counts them.
    movs    r2, #0
7:  ldr     r10, [sp]
    ldr     r11, [sp, #4]
    add     r3, sp, #8
    and     r4, r2, #1
    ldr     r1, [sp, #56]
    ldr     r0, [r3, r4, lsl #2]
    ldm     r10!, {r12, lr}
    str     r10, [sp]
    ldm     r11, {r3-r6, r9}
    subs    r1, #4
    blt     2f
1:  ldr     r7, [r0]
    ldr     r8, [r0, #4]
    second_order r7, r3, r4, r5, r6, 0
    second_order r8, r7, r3, r6, r5, 4
    ldr     r4, [r0, #8]
    ldr     r3, [r0, #12]
    second_order r4, r8, r7, r5, r6, 8
    second_order r3, r4, r8, r6, r5, 12
    adds    r0, #16
    subs    r1, #4
    bge     1b
2:  adds    r1, #4
    beq     4f
3:  ldr     r7, [r0]
    second_order r7, r3, r4, r5, r6, 0
    adds    r0, #4
    mov     r4, r3
    mov     r3, r7
    mov     r7, r5
    mov     r5, r6
    mov     r6, r7
    subs    r1, #1
    bne     3b
4:  ldr     r11, [sp, #4]
    ldr     r10, [sp, #16]
    adds    r2, #1
    ldr     r10, [r10, #4]
    stm     r11!, {r3-r6, r9}
    str     r11, [sp, #4]
    cmp     r2, r10
    blo     7b
    ldr     r0, [sp, #8]
    mov     r12, r0
    ldr     r1, [sp, #12]
    ldr     r2, [sp, #56]
    movs    r3, #0
    ldr     r4, [sp, #60]
    cmp     r4, #0
    beq     5f
    parting 1
    b       6f
5:  parting 0
6:  mov     r0, r3
    add     sp, #20
    pop     {r4-r11, pc}
