@ The room's hot loops for a Cortex-M4F, on 16-bit lines. The bits are those of portable.rs.

    .syntax unified
    .thumb
    .section .text.malleus_room,"ax",%progbits

@ A network's tick, malleus_room_network(call), is three loops: prepare, pass, radiate.

@ Prepare: r0 input, r1 prepared, r2 count, r3 shift, r4 gain, r5 growth, r6 half a step
    .macro prepared x
    lsl     \x, \x, r3
    smmlar  \x, \x, r4, r6
    smmlar  r4, r4, r5, r4
    pkhtb   \x, \x, \x, asr #16
    .endm

    .macro preparing
    movw    r6, #0x8000
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

@ One frame of all lines. r0-r3 lines, r4 sound (outputs lie 512 bytes behind), r5 turning sine and cosine, r6 fixed ones, r7-r10 the lines' words, r11 half a step, r12 free,
@ lr count. The sticky flag Q tells of stored values of 14 bits and a sign, or of outputs of 15: nothing else here sets it.
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
    ssat16  r9, #15, r9
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

@ Pass: a tick, cut where a line ends and where the angle changes, each sixteen frames.
@ Layouts: call is memory 0, lines 4, positions 8, sound 12, frames 16, angles 20, fixed angle 24, busy 28, input 32, shift 36, gain 40, growth 44, out 48,
@ gain 52, loss 56, what to do with `out` 60 (0 put, 1 add, 2 nothing); a line is where it begins and its length, halfwords in pairs; a position is
@ where it is and what is left to the line's end, alike.
@ sp: memory, lines, positions, sound, frames left, angles, fixed angle, busy; this cut's frames left 32, angles less a sixteenth of
@ the sound's address 36 (sound lies on 64 bytes: sixteen inputs), call 40.
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
    sub     sp, #44
    ldm     r0, {r4-r11}
    stm     sp, {r4-r11}
    str     r0, [sp, #40]
    mov     r1, r7
    mov     r2, r8
    add     r0, #32
    ldm     r0, {r0, r3-r5}
    preparing
    ldr     r4, [sp, #12]
    ldr     r5, [sp, #20]
    lsr     r4, r4, #6
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
6:  ubfx    lr, r4, #2, #4
    rsb     lr, lr, #16
    cmp     lr, r9
    it      hi
    movhi   lr, r9
    lsr     r5, r4, #6
    sub     r9, r9, lr
    ldr     r12, [sp, #36]
    ldr     r6, [sp, #24]
    ldr     r10, [sp, #28]
    ldr     r5, [r12, r5, lsl #2]
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
    add     sp, #44
    pop     {r4-r11, pc}

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

@ malleus_room_split(split, state, low, high, count, thin) -> or of the sizes in high: portable.rs, split.
@ Layouts: split is α, then c1/2 and c2/2 of two sections; state is x1, y1, rest, then x1, x2, y1, y2, rest of two sections.
@ sp: split, state, low, high; count and thin above what is pushed.

@ One sample of a second-order section: r7, r8 new inputs, r9 rest, r10, r11 free, r12 c1/2, lr c2/2. y takes the place of y2.
    .macro second_order x x1 x2 y1 y2 at
    sub     r11, \x, \y2
    mov     r10, #0
    smlal   r9, r10, r11, lr
    sub     r11, \x1, \y1
    smlal   r9, r10, r11, r12
    add     \y2, \x2, r10, lsl #2
    str     \y2, [r0, #\at]
    .endm

@ A section over a block: where its pointer is on the stack, where its coefficients and its state are.
    .macro section block coefficients state
    ldr     r11, [sp]
    ldr     r12, [r11, #\coefficients]
    ldr     lr, [r11, #\coefficients + 4]
    ldr     r11, [sp, #4]
    add     r11, #\state
    ldm     r11, {r3-r6, r9}
    ldr     r0, [sp, #\block]
    ldr     r1, [sp, #52]
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
    add     r11, #\state
    stm     r11, {r3-r6, r9}
    .endm

    .macro first_order x x1
    sub     r8, \x, r5
    mov     r7, #0
    smlal   r6, r7, r8, r3
    sub     r5, \x1, r7, lsl #1
    str     r5, [r1], #4
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
    push    {r0-r11, lr}
    mov     r12, r1
    ldr     r3, [r0]
    ldm     r12, {r4-r6}
    ldr     r0, [sp, #8]
    ldr     r1, [sp, #12]
    ldr     r2, [sp, #52]
    subs    r2, #4
    blt     2f
1:  ldr     r9, [r0]
    ldr     r10, [r0, #4]
    first_order r9, r4
    first_order r10, r9
    ldr     r9, [r0, #8]
    ldr     r4, [r0, #12]
    adds    r0, #16
    first_order r9, r10
    first_order r4, r9
    subs    r2, #4
    bge     1b
2:  adds    r2, #4
    beq     4f
3:  ldr     r9, [r0], #4
    first_order r9, r4
    mov     r4, r9
    subs    r2, #1
    bne     3b
4:  stm     r12, {r4-r6}
    section 12, 12, 32
    section 8, 4, 12
    ldr     r0, [sp, #8]
    mov     r12, r0
    ldr     r1, [sp, #12]
    ldr     r2, [sp, #52]
    movs    r3, #0
    ldr     r4, [sp, #56]
    cmp     r4, #0
    beq     5f
    parting 1
    b       6f
5:  parting 0
6:  mov     r0, r3
    add     sp, #16
    pop     {r4-r11, pc}

@ malleus_room_double(a, state, slow, fast, count, add): both sides (every second word) at twice their rate; a side's state is x, even, odd.
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

@ malleus_room_exchange(out, wet, input, count) -> or of the input: half the middle of `out` goes to `input`, `wet` is added to `out`.
    .macro exchanged at
    ldr     r5, [r0, #\at]
    ldr     r6, [r0, #\at + 4]
    ldr     r7, [r1, #\at]
    ldr     r8, [r1, #\at + 4]
    asr     r9, r5, #1
    add     r9, r9, r6, asr #1
    ssat    r9, #28, r9, asr #1
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
