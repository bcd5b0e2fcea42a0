@ A network's block, on 16-bit lines. The bits are those of portable.rs.

    .syntax unified
    .thumb
    .section .text.malleus_room,"ax",%progbits

@ A network's tick, malleus_room_network(call), is three loops: prepare, pass, radiate.

@ Prepare: r0 input, r1 prepared, r2 count, r3 shift, r4 gain, r5 growth, r6 half a step, lr the
@ first values' part of the second ones, r12 half a step less that part of one: the second ones have
@ theirs already
    .macro prepared x
    lsl     \x, \x, r3
    smmlar  \x, \x, r4, r6
    smmlar  r4, r4, r5, r4
    smmlar  r11, \x, lr, r12
    pkhtb   \x, \x, r11, asr #16
    .endm

    .macro preparing
    movw    r6, #0x8000
    movw    r12, #0x8000 - 15280
    movw    lr, #0
    movt    lr, #15280 << 1
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
4:
    .endm

@ Radiate: r0 output, r1 out, r2 count, r3 gain, r4 loss
    .macro radiated add at word
    .if \add
    ldr     r6, [r1, #\at]
    ldr     r7, [r1, #\at + 4]
    .endif
    smulwb  r8, r3, \word
    smulwt  r9, r3, \word
    smmlsr  r3, r3, r4, r3
    .if \add
    qadd    r8, r6, r8
    qadd    r9, r7, r9
    .endif
    str     r8, [r1, #\at]
    str     r9, [r1, #\at + 4]
    .endm

    .macro radiating add
    subs    r2, #4
    blt     2f
1:  ldm     r0!, {r5, r10-r12}
    radiated \add, 0, r5
    radiated \add, 8, r10
    radiated \add, 16, r11
    radiated \add, 24, r12
    adds    r1, #32
    subs    r2, #4
    bge     1b
2:  adds    r2, #4
    beq     4f
3:  ldr     r5, [r0], #4
    radiated \add, 0, r5
    adds    r1, #8
    subs    r2, #1
    bne     3b
4:
    .endm

@ One frame of all lines. r0-r3 lines, r4 sound (outputs lie 512 bytes behind), r5 turning sine and
@ cosine, r6 fixed ones, r7-r10 the lines' words, r11 half a step, r12 free, lr count. The sticky
@ flag Q tells of stored values beyond 14 bits, sign included, or of those of line 1 beyond 15:
@ nothing else here sets it.
    .macro reflected word angle
    smladx  r12, \word, \angle, r11
    smlsd   \word, \word, \angle, r11
    pkhtb   \word, \word, r12, asr #16
    .endm

    .macro rotated word angle
    smlsdx  r12, \word, \angle, r11
    smlad   \word, \word, \angle, r11
    pkhtb   \word, \word, r12, asr #16
    .endm

    .macro rotated_and_swapped word angle
    smlad   r12, \word, \angle, r11
    smlsdx  \word, \word, \angle, r11
    pkhtb   \word, \word, r12, asr #16
    .endm

    .macro reflected_and_swapped word angle
    smlsd   r12, \word, \angle, r11
    smladx  \word, \word, \angle, r11
    pkhtb   \word, \word, r12, asr #16
    .endm

    .macro frame busy
    ldr     r7, [r0]
    ldr     r8, [r1]
    ldr     r9, [r2]
    ldr     r10, [r3]
    reflected r7, r5
    rotated r8, r6
    rotated_and_swapped r9, r5
    reflected_and_swapped r10, r6
    ldr     r12, [r4], #4
    qadd16  r7, r7, r12
    qadd16  r12, r7, r8
    qsub16  r7, r7, r8
    qadd16  r8, r9, r10
    qsub16  r9, r9, r10
    str     r9, [r4, #508]
    qadd16  r10, r12, r8
    qsub16  r12, r12, r8
    qadd16  r8, r7, r9
    qsub16  r7, r7, r9
    str     r10, [r1], #4
    str     r8, [r2], #4
    str     r12, [r3], #4
    str     r7, [r0], #4
    .if \busy
    ssat16  r10, #15, r10
    .else
    ssat16  r10, #14, r10
    ssat16  r12, #14, r12
    ssat16  r8, #14, r8
    ssat16  r7, #14, r7
    .endif
    .endm

@ lr frames, at least one
    .macro frames busy
    movw    r11, #0x8000
    subs    lr, #4
    blt     2f
1:  frame   \busy
    frame   \busy
    frame   \busy
    frame   \busy
    subs    lr, #4
    bge     1b
2:  adds    lr, #4
    beq     4f
3:  frame   \busy
    subs    lr, #1
    bne     3b
4:
    .endm

@ Pass: a block, cut where a line ends and where the angle changes. Layouts: call is memory 0, lines
@ 4, positions 8, sound 12, frames 16, angles 20, fixed angle 24, busy 28, input 32, shift 36, gain
@ 40, growth 44, out 48, gain 52, loss 56, what to do with `out` 60 (0 put, 1 add, 2 nothing), bits
@ of an angle's bytes of input 64; a line is where it begins and its length, halfwords in pairs; a
@ position is where it is and what is left to the line's end, alike.
@ sp: memory, lines, positions, sound, frames left, angles, fixed angle, busy; this cut's frames
@ left 32, angles less what of them the sound's address counts for 36 (sound lies on 64 bytes:
@ sixteen inputs), call 40, bits of an angle's bytes 44.
    .macro begun line word
    uxth    r\line, \word
    add     r\line, r6, r\line, lsl #2
    cmp     r9, \word, lsr #16
    it      hi
    lsrhi   r9, \word, #16
    .endm

@ r5: one further, one less left
    .macro moved line word
    mla     \word, r9, r5, \word
    lsrs    r10, \word, #16
    it      eq
    ldreq   \word, [r7, #4 * \line]
    .endm

    .global malleus_room_network
    .type malleus_room_network, %function
    .thumb_func
malleus_room_network:
    push    {r4-r11, lr}
    sub     sp, #48
    ldm     r0, {r4-r11}
    stm     sp, {r4-r11}
    str     r0, [sp, #40]
    mov     r1, r7
    mov     r2, r8
    add     r0, #32
    ldm     r0, {r0, r3-r5}
    preparing
    ldr     r6, [sp, #40]
    ldr     r4, [sp, #12]
    ldr     r5, [sp, #20]
    ldr     r6, [r6, #64]
    lsr     r4, r4, r6
    str     r6, [sp, #44]
    sub     r5, r5, r4, lsl #2
    str     r5, [sp, #36]
    movs    r4, #0
    msr     APSR_nzcvq, r4
5:  ldm     sp, {r6-r9}
    mov     r4, r9
    ldr     r9, [sp, #16]
    movw    r5, #1
    movt    r5, #0xffff
    ldm     r8, {r10-r12, lr}
    begun   0, r10
    begun   1, r11
    begun   2, r12
    begun   3, lr
    mov     r6, r10
    moved   0, r6
    moved   1, r11
    moved   2, r12
    moved   3, lr
    str     r6, [r8]
    str     r11, [r8, #4]
    str     r12, [r8, #8]
    str     lr, [r8, #12]
    ldr     r12, [sp, #16]
    sub     r12, r12, r9
    str     r12, [sp, #16]
6:  ldr     r10, [sp, #44]
    ldr     r12, [sp, #36]
    ldr     r6, [sp, #24]
    lsr     r5, r4, r10
    add     lr, r5, #1
    lsl     lr, lr, r10
    ldr     r10, [sp, #28]
    sub     lr, lr, r4
    ldr     r5, [r12, r5, lsl #2]
    lsr     lr, lr, #2
    cmp     lr, r9
    it      hi
    movhi   lr, r9
    sub     r9, r9, lr
    str     r9, [sp, #32]
    cmp     r10, #0
    bne     7f
    frames  0
    b       8f
7:  frames  1
8:  ldr     r9, [sp, #32]
    cmp     r9, #0
    bne     6b
    str     r4, [sp, #12]
    ldr     r12, [sp, #16]
    cmp     r12, #0
    bne     5b
    mrs     lr, APSR
    ldr     r10, [sp, #40]
    ldr     r0, [r10, #12]
    add     r0, #512
    ldr     r2, [r10, #16]
    add     r10, #48
    ldm     r10, {r1, r3-r5}
    cmp     r5, #1
    bhi     6f
    blt     5f
    radiating 1
    b       6f
5:  radiating 0
6:  and     r0, lr, #0x08000000
    add     sp, #48
    pop     {r4-r11, pc}
