@ What was stored at another level, brought to today's. The bits are those of portable.rs.

    .syntax unified
    .thumb
    .section .text.malleus_room,"ax",%progbits

@ Both halves of four words halved, rounded half up; r12 has ones.
.macro halve_four
    shadd16 r4, r4, r12
    shadd16 r5, r5, r12
    shadd16 r6, r6, r12
    shadd16 r7, r7, r12
.endm

@ malleus_room_scale(words, count, rise): both halves of so many words doubled, saturated, or halved
@ as often as it says, each time rounded half up.
@ Levels mostly rise by one bit or two.
    .global malleus_room_scale
    .type malleus_room_scale, %function
    .thumb_func
malleus_room_scale:
    push    {r4-r7, lr}
    mov     r12, #0x00010001
    subs    r1, #4
    blt     5f
    adds    r3, r2, #2
    bgt     2f
    blt     4f
1:  ldm     r0, {r4-r7}
    subs    r1, #4
    halve_four
    halve_four
    stm     r0!, {r4-r7}
    bge     1b
    b       5f
2:  cmp     r2, #0
    bge     3f
9:  ldm     r0, {r4-r7}
    subs    r1, #4
    halve_four
    stm     r0!, {r4-r7}
    bge     9b
    b       5f
3:  ldm     r0, {r4-r7}
    subs    r1, #4
    qadd16  r4, r4, r4
    qadd16  r5, r5, r5
    qadd16  r6, r6, r6
    qadd16  r7, r7, r7
    stm     r0!, {r4-r7}
    bge     3b
    b       5f
4:  ldm     r0, {r4-r7}
    mov     r3, r2
8:  halve_four
    adds    r3, #1
    bne     8b
    subs    r1, #4
    stm     r0!, {r4-r7}
    bge     4b
@ What is left of four.
5:  adds    r1, #4
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
