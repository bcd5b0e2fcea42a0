@ The room's hot loops for a Cortex-M4F, on 16-bit lines. The bits are those of portable.rs.

    .syntax unified
    .thumb
    .section .text.malleus_room,"ax",%progbits

@ malleus_room_take(line, gain, work, count): work = gain · line / 2^16. 3.9 cycles a sample in eights.
    .global malleus_room_take
    .type malleus_room_take, %function
    .thumb_func
malleus_room_take:
    push    {r4-r11}
    subs    r3, #8
    blt     2f
1:  ldrsh   r4, [r0]
    ldrsh   r5, [r0, #2]
    ldrsh   r6, [r0, #4]
    ldrsh   r7, [r0, #6]
    ldrsh   r8, [r0, #8]
    ldrsh   r9, [r0, #10]
    ldrsh   r10, [r0, #12]
    ldrsh   r11, [r0, #14]
    adds    r0, #16
    smulwb  r4, r1, r4
    smulwb  r5, r1, r5
    smulwb  r6, r1, r6
    smulwb  r7, r1, r7
    smulwb  r8, r1, r8
    smulwb  r9, r1, r9
    smulwb  r10, r1, r10
    smulwb  r11, r1, r11
    subs    r3, #8
    stmia   r2!, {r4-r11}
    bge     1b
2:  adds    r3, #8
    beq     4f
3:  ldrsh   r4, [r0], #2
    subs    r3, #1
    smulwb  r4, r1, r4
    str     r4, [r2], #4
    bne     3b
4:  pop     {r4-r11}
    bx      lr

@ malleus_room_put(work, line, count): line = work >> 12; gives all of line ^ line << 1, or'd, in both halves. 4.3 cycles a sample in eights.
    .macro two a b at
    asrs    \a, \a, #12
    pkhbt   \a, \a, \b, lsl #4
    str     \a, [r1, #\at]
    eor     \b, \a, \a, lsl #1
    orr     r3, r3, \b
    .endm

    .global malleus_room_put
    .type malleus_room_put, %function
    .thumb_func
malleus_room_put:
    push    {r4-r11}
    movs    r3, #0
    subs    r2, #8
    blt     2f
1:  ldmia   r0!, {r4-r11}
    two     r4, r5, 0
    two     r6, r7, 4
    two     r8, r9, 8
    two     r10, r11, 12
    adds    r1, #16
    subs    r2, #8
    bge     1b
2:  adds    r2, #8
    beq     4f
3:  ldr     r4, [r0], #4
    asrs    r4, r4, #12
    strh    r4, [r1], #2
    eor     r4, r4, r4, lsl #1
    orr     r3, r3, r4
    subs    r2, #1
    bne     3b
4:  mov     r0, r3
    pop     {r4-r11}
    bx      lr

@ malleus_room_mix(work, sound, count, sine, cosine): one sample of all eight lines at a time.
@ Registers: r0 work (a line is 128 bytes), r1 sound, r3 sine, lr cosine, all others the lines and one or two free ones.
    .macro rotate a b
    smmulr  r2, r3, \b
    smmulr  \b, lr, \b
    smmlsr  \b, r3, \a, \b
    smmlar  \a, lr, \a, r2
    .endm

@ sum goes to a free register, the difference stays in a
    .macro butterfly sum a b
    add     \sum, \a, \b
    sub     \a, \a, \b
    .endm

    .macro sample
    ldr     r4, [r0]
    ldr     r5, [r0, #128]
    ldr     r6, [r0, #256]
    ldr     r7, [r0, #384]
    ldr     r8, [r0, #512]
    ldr     r9, [r0, #640]
    ldr     r10, [r0, #768]
    ldr     r11, [r0, #896]
    rotate  r4, r5
    rotate  r6, r7
    add     r4, r4, #0x800
    add     r5, r5, #0x800
    butterfly r2, r8, r9                @ a4 r2, a5 r8
    butterfly r9, r10, r11              @ a6 r9, a7 r10
    butterfly r11, r4, r6               @ b0 r11, b2 r4
    butterfly r6, r5, r7                @ b1 r6, b3 r5
    butterfly r7, r2, r9                @ b4 r7, b6 r2
    butterfly r9, r8, r10               @ b5 r9, b7 r8
    butterfly r10, r11, r7              @ c0 r10, c4 r11
    butterfly r7, r6, r9                @ c1 r7, c5 r6
    butterfly r9, r4, r2                @ c2 r9, c6 r4
    butterfly r2, r5, r8                @ c3 r2, c7 r5
    ldr     r12, [r1]
    sub     r8, r2, #0x800
    str     r8, [r1, #4]
    sub     r8, r10, #0x800
    str     r8, [r1], #8
    add     r10, r10, r12
    sub     r7, r7, r12
    add     r9, r9, r12
    add     r2, r2, r12
    sub     r11, r11, r12
    sub     r4, r4, r12
    add     r5, r5, r12
    add     r6, r6, r12
    str     r10, [r0, #384]
    str     r7, [r0, #512]
    str     r9, [r0, #640]
    str     r2, [r0, #768]
    str     r11, [r0, #896]
    str     r4, [r0, #128]
    str     r5, [r0, #256]
    str     r6, [r0], #4
    .endm

    .global malleus_room_mix
    .type malleus_room_mix, %function
    .thumb_func
malleus_room_mix:
    push    {r2, r4-r11, lr}
    ldr     lr, [sp, #40]
    lsls    r12, r2, #31
    bne     2f
1:  sample
    sample
    ldr     r2, [sp]
    subs    r2, #2
    str     r2, [sp]
    bne     1b
    pop     {r2, r4-r11, pc}
2:  sample
    ldr     r2, [sp]
    subs    r2, #1
    str     r2, [sp]
    bne     2b
    pop     {r2, r4-r11, pc}
