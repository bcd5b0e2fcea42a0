@ The exchange with the bus. The bits are those of portable.rs.

    .syntax unified
    .thumb
    .section .text.malleus_room,"ax",%progbits

@ malleus_room_exchange(out, wet, input, count, chains, states) -> or of what the chains are given:
@ both sides of `out` go through their chains to `input`, `wet` is added to `out`. One side after
@ the other: both sides' states and coefficients do not fit the registers.
@ r0 out, r1 wet, r2 input, r3 count, r4 the or, r5 and r6 the slow state, r7 the second, r8 the
@ last, r9, r10, lr coefficients, r11 x, r12 d
    .macro exchanged right at
    ldr     r11, [r0, #\at]
    ssat    r11, #28, r11, asr #2
    orr     r4, r4, r11
    sub     r12, r11, r6
    smlal   r5, r6, r12, r9
    sub     r11, r6, r12
    sub     r12, r11, r7
    smmlar  r7, r12, r10, r7
    sub     r11, r7, r12
    sub     r12, r11, r8
    .if \right
    add     r11, r8, r12, asr #1
    smmlar  r11, r12, lr, r11
    .else
    smmlar  r11, r12, lr, r8
    .endif
    add     r8, r11, r12
    .if \right
    ldr     r12, [r2]
    add     r11, r11, r12
    ssat    r11, #28, r11
    .endif
    str     r11, [r2], #4
    ldr     r11, [r0, #\at]
    ldr     r12, [r1, #\at]
    qadd    r11, r11, r12
    str     r11, [r0, #\at]
    .endm

    .macro exchanging right
    subs    r3, #4
    blt     2f
1:  exchanged \right, 0
    exchanged \right, 8
    exchanged \right, 16
    exchanged \right, 24
    adds    r0, #32
    adds    r1, #32
    subs    r3, #4
    bge     1b
2:  adds    r3, #4
    beq     4f
3:  exchanged \right, 0
    adds    r0, #8
    adds    r1, #8
    subs    r3, #1
    bne     3b
4:
    .endm

@ A chain is two complements and the last coefficient, 12 bytes; a state is 16 bytes.
@ sp: out, wet, input, count; chains 52, states 56.
    .global malleus_room_exchange
    .type malleus_room_exchange, %function
    .thumb_func
malleus_room_exchange:
    push    {r4-r11, lr}
    push    {r0-r3}
    movs    r4, #0
    ldr     r11, [sp, #52]
    ldr     r12, [sp, #56]
    ldm     r11, {r9, r10, lr}
    ldm     r12, {r5-r8}
    exchanging 0
    ldr     r12, [sp, #56]
    stm     r12!, {r5-r8}
    str     r12, [sp, #56]
    ldr     r11, [sp, #52]
    adds    r11, #12
    ldm     r11, {r9, r10, lr}
    ldm     r12, {r5-r8}
    ldm     sp, {r0-r3}
    adds    r0, #4
    adds    r1, #4
    exchanging 1
    ldr     r12, [sp, #56]
    stm     r12, {r5-r8}
    mov     r0, r4
    add     sp, #16
    pop     {r4-r11, pc}
