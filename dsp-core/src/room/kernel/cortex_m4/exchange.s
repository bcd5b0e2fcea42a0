@ The exchange with the bus. The bits are those of portable.rs.

    .syntax unified
    .thumb
    .section .text.malleus_room,"ax",%progbits

@ malleus_room_exchange(out, wet, input, count) -> or of the input: half the middle of `out` goes to `input`, `wet` is added to `out`.
    .macro exchanged at
    ldr     r5, [r0, #\at]
    ldr     r6, [r0, #\at + 4]
    ldr     r7, [r1, #\at]
    ldr     r8, [r1, #\at + 4]
    qadd    r9, r5, r6
    ssat    r9, #28, r9, asr #2
    qadd    r5, r5, r7
    qadd    r6, r6, r8
    orr     r4, r4, r9
    str     r9, [r2], #4
    str     r5, [r0, #\at]
    str     r6, [r0, #\at + 4]
    .endm

    .global malleus_room_exchange
    .type malleus_room_exchange, %function
    .thumb_func
malleus_room_exchange:
    push    {r4-r9}
    movs    r4, #0
    subs    r3, #4
    blt     2f
1:  exchanged 0
    exchanged 8
    exchanged 16
    exchanged 24
    adds    r0, #32
    adds    r1, #32
    subs    r3, #4
    bge     1b
2:  adds    r3, #4
    beq     4f
3:  exchanged 0
    adds    r0, #8
    adds    r1, #8
    subs    r3, #1
    bne     3b
4:  mov     r0, r4
    pop     {r4-r9}
    bx      lr
