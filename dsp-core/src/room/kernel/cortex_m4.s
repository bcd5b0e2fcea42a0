@ The room's hot loops for a Cortex-M4F, on 16-bit lines. The bits are those of portable.rs.

    .syntax unified
    .thumb
    .section .text.malleus_room,"ax",%progbits

@ malleus_room_prepare(input, prepared, count, shift, gain, growth)
@ r0 input, r1 prepared, r2 count, r3 shift, r4 gain, r5 growth, r6 half a step
    .macro prepared x
    lsl     \x, \x, r3
    smmlar  \x, \x, r4, r6
    smmlar  r4, r4, r5, r4
    ssat    \x, #16, \x, asr #15
    pkhbt   \x, \x, \x, lsl #16
    .endm

    .global malleus_room_prepare
    .type malleus_room_prepare, %function
    .thumb_func
malleus_room_prepare:
    push    {r4-r10, lr}
    ldr     r4, [sp, #32]
    ldr     r5, [sp, #36]
    mov     r6, #0x4000
    subs    r2, #4
    blt     2f
1:  ldr     r7, [r0]
    ldr     r8, [r0, #4]
    ldr     r9, [r0, #8]
    ldr     r10, [r0, #12]
    adds    r0, #16
    prepared r7
    prepared r8
    prepared r9
    prepared r10
    str     r7, [r1]
    str     r8, [r1, #4]
    str     r9, [r1, #8]
    str     r10, [r1, #12]
    adds    r1, #16
    subs    r2, #4
    bge     1b
2:  adds    r2, #4
    beq     4f
3:  ldr     r7, [r0], #4
    prepared r7
    str     r7, [r1], #4
    subs    r2, #1
    bne     3b
4:  pop     {r4-r10, pc}

@ malleus_room_radiate(output, out, count, gain, loss) -> whether an output has 15 bits and a sign
@ r0 output, r1 out, r2 count, r3 gain, r4 loss, r12 sizes
    .macro radiated at
    ldr     r5, [r0], #4
    ldr     r6, [r1, #\at]
    ldr     r7, [r1, #\at + 4]
    smulwb  r8, r3, r5
    smulwt  r9, r3, r5
    smmlsr  r3, r3, r4, r3
    eor     r5, r5, r5, lsl #1
    qadd    r6, r6, r8
    qadd    r7, r7, r9
    orr     r12, r12, r5
    str     r6, [r1, #\at]
    str     r7, [r1, #\at + 4]
    .endm

    .global malleus_room_radiate
    .type malleus_room_radiate, %function
    .thumb_func
malleus_room_radiate:
    push    {r4-r9}
    ldr     r4, [sp, #24]
    mov     r12, #0
    subs    r2, #4
    blt     2f
1:  radiated 0
    radiated 8
    radiated 16
    radiated 24
    adds    r1, #32
    subs    r2, #4
    bge     1b
2:  adds    r2, #4
    beq     4f
3:  radiated 0
    adds    r1, #8
    subs    r2, #1
    bne     3b
4:  and     r0, r12, #0x80008000
    pop     {r4-r9}
    bx      lr

@ One frame of all lines. r0-r3 lines, r4 sound (outputs lie 128 bytes behind), r5 turning sine and cosine, r6 fixed ones, r7-r10 the lines' words, r11, r12 free,
@ lr count. The sticky flag Q tells of stored values of 14 bits and a sign: nothing else here sets it.
    .macro turned word angle
    smladx  r12, \word, \angle, r11
    smlsd   \word, \word, \angle, r11
    pkhtb   \word, \word, r12, asr #16
    .endm

    .macro turned_and_swapped word angle
    smlsd   r12, \word, \angle, r11
    smladx  \word, \word, \angle, r11
    pkhtb   \word, \word, r12, asr #16
    .endm

    .macro words
    ldr     r7, [r0]
    ldr     r8, [r1]
    ldr     r9, [r2]
    ldr     r10, [r3]
    .endm

    .macro mixed
    ldr     r11, [r4], #4
    qadd16  r7, r7, r11
    qadd16  r12, r7, r8
    qsub16  r7, r7, r8
    qadd16  r8, r9, r10
    qsub16  r9, r9, r10
    str     r9, [r4, #124]
    qadd16  r10, r12, r8
    qsub16  r12, r12, r8
    qadd16  r8, r7, r9
    qsub16  r7, r7, r9
    ssat16  r11, #14, r10
    ssat16  r11, #14, r12
    ssat16  r11, #14, r8
    ssat16  r11, #14, r7
    str     r10, [r1], #4
    str     r8, [r2], #4
    str     r12, [r3], #4
    str     r7, [r0], #4
    .endm

    .macro frame
    words
    movw    r11, #0x8000
    turned  r7, r5
    turned_and_swapped r8, r6
    turned  r9, r5
    turned_and_swapped r10, r6
    mixed
    .endm

@ malleus_room_pass(call, first): angles change after the `first` frames, and each eight from then on.
@ sp: frames left, next angle
    .global malleus_room_pass
    .type malleus_room_pass, %function
    .thumb_func
malleus_room_pass:
    push    {r4-r11, lr}
    sub     sp, #8
    mov     r12, #0
    msr     APSR_nzcvq, r12
    ldr     r11, [r0, #20]
    ldr     r12, [r0, #24]
    ldr     r6, [r0, #28]
    ldr     r4, [r0, #16]
    mov     lr, r1
    ldm     r0, {r0-r3}
1:  cmp     lr, r11
    it      hi
    movhi   lr, r11
    sub     r11, r11, lr
    ldr     r5, [r12], #4
    strd    r11, r12, [sp]
    subs    lr, #4
    blt     3f
2:  frame
    frame
    frame
    frame
    subs    lr, #4
    bge     2b
3:  adds    lr, #4
    beq     5f
4:  frame
    subs    lr, #1
    bne     4b
5:  ldrd    r11, r12, [sp]
    mov     lr, #8
    cmp     r11, #0
    bne     1b
    mrs     r0, APSR
    and     r0, r0, #0x08000000
    add     sp, #8
    pop     {r4-r11, pc}

@ malleus_room_pass_between(call, double): each line has its angle; all words are doubled where it says so. r5 angles.
    .macro frame_between
    movw    r11, #0x8000
    ldr     r6, [r5]
    turned  r7, r6
    ldr     r6, [r5, #4]
    turned_and_swapped r8, r6
    ldr     r6, [r5, #8]
    turned  r9, r6
    ldr     r6, [r5, #12]
    turned_and_swapped r10, r6
    mixed
    subs    lr, #1
    .endm

    .global malleus_room_pass_between
    .type malleus_room_pass_between, %function
    .thumb_func
malleus_room_pass_between:
    push    {r4-r11, lr}
    mov     r12, #0
    msr     APSR_nzcvq, r12
    ldr     r5, [r0, #24]
    ldr     r4, [r0, #16]
    ldr     lr, [r0, #20]
    cmp     r1, #0
    ldm     r0, {r0-r3}
    bne     2f
1:  words
    frame_between
    bne     1b
    b       3f
2:  words
    qadd16  r7, r7, r7
    qadd16  r8, r8, r8
    qadd16  r9, r9, r9
    qadd16  r10, r10, r10
    frame_between
    bne     2b
3:  mrs     r0, APSR
    and     r0, r0, #0x08000000
    pop     {r4-r11, pc}
