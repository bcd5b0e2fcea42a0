@ What was stored at another level, brought to today's. The bits are those of portable.rs.

    .syntax unified
    .thumb
    .section .text.malleus_room,"ax",%progbits

@ malleus_room_scale(words, count, rise): both halves of so many words doubled, saturated, or halved as often as it says, each time rounded half up.
    .global malleus_room_scale
    .type malleus_room_scale, %function
    .thumb_func
malleus_room_scale:
    push    {r4-r7, lr}
    mov     r12, #0x00010001
    subs    r1, #4
    blt     3f
    adds    r3, r2, #1
    bne     1f
9:  ldm     r0, {r4-r7}
    subs    r1, #4
    shadd16 r4, r4, r12
    shadd16 r5, r5, r12
    shadd16 r6, r6, r12
    shadd16 r7, r7, r12
    stm     r0!, {r4-r7}
    bge     9b
    b       3f
1:  ldm     r0, {r4-r7}
    mov     r3, r2
    cmp     r3, #0
    blt     2f
    qadd16  r4, r4, r4
    qadd16  r5, r5, r5
    qadd16  r6, r6, r6
    qadd16  r7, r7, r7
    b       4f
2:  shadd16 r4, r4, r12
    shadd16 r5, r5, r12
    shadd16 r6, r6, r12
    shadd16 r7, r7, r12
    adds    r3, #1
    bne     2b
4:  subs    r1, #4
    stm     r0!, {r4-r7}
    bge     1b
3:  adds    r1, #4
    beq     8f
5:  ldr     r4, [r0]
    mov     r3, r2
    cmp     r3, #0
    blt     6f
    qadd16  r4, r4, r4
    b       7f
6:  shadd16 r4, r4, r12
    adds    r3, #1
    bne     6b
7:  str     r4, [r0], #4
    subs    r1, #1
    bne     5b
8:  pop     {r4-r7, pc}
