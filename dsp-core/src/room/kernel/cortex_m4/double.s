@ Doubling the rate. The bits are those of portable.rs.

    .syntax unified
    .thumb
    .section .text.malleus_room,"ax",%progbits

@ malleus_room_double(a, state, slow, fast, count, add): both sides (every second word) at twice
@ their rate; a side's state is x, even, odd.
@ r0 slow, r1 fast, r2 count, r3 a0, r4 a1, r5 last x, r6 even, r7 odd, r8 x, r9 free, r10, r11 sums
    .macro doubled x x1 add at
    ssat    \x, #30, \x
    sub     r9, \x, r6
    .if \add
    ldr     r10, [r1, #\at]
    ldr     r11, [r1, #\at + 8]
    .endif
    smmlar  r6, r9, r3, \x1
    sub     r9, \x, r7
    smmulr  r9, r9, r4
    add     r7, \x1, r9, lsl #1
    .if \add
    qadd    r10, r10, r6
    qadd    r11, r11, r7
    str     r10, [r1, #\at]
    str     r11, [r1, #\at + 8]
    .else
    str     r6, [r1, #\at]
    str     r7, [r1, #\at + 8]
    .endif
    .endm

    .macro doubling add
    subs    r2, #4
    blt     2f
1:  ldr     r8, [r0]
    ldr     lr, [r0, #8]
    doubled r8, r5, \add, 0
    doubled lr, r8, \add, 16
    ldr     r8, [r0, #16]
    ldr     r5, [r0, #24]
    doubled r8, lr, \add, 32
    doubled r5, r8, \add, 48
    adds    r0, #32
    adds    r1, #64
    subs    r2, #4
    bge     1b
2:  adds    r2, #4
    beq     4f
3:  ldr     r8, [r0], #8
    doubled r8, r5, \add, 0
    mov     r5, r8
    adds    r1, #32 / 2
    subs    r2, #1
    bne     3b
4:
    .endm

@ sp: state of the side, slow, fast, sides left; count and add above what is pushed.
    .global malleus_room_double
    .type malleus_room_double, %function
    .thumb_func
malleus_room_double:
    push    {r4-r11, lr}
    mov     r4, #2
    push    {r1-r4}
    ldm     r0, {r3-r4}
7:  ldr     r5, [sp]
    ldr     r0, [sp, #4]
    ldr     r1, [sp, #8]
    ldr     r2, [sp, #52]
    ldr     r8, [sp, #56]
    ldm     r5, {r5-r7}
    cmp     r8, #0
    beq     5f
    doubling 1
    b       6f
5:  doubling 0
6:  ldr     r8, [sp]
    stm     r8!, {r5-r7}
    ldr     r0, [sp, #4]
    ldr     r1, [sp, #8]
    adds    r0, #4
    adds    r1, #4
    ldr     r2, [sp, #12]
    str     r8, [sp]
    str     r0, [sp, #4]
    str     r1, [sp, #8]
    subs    r2, #1
    str     r2, [sp, #12]
    bne     7b
    add     sp, #16
    pop     {r4-r11, pc}
