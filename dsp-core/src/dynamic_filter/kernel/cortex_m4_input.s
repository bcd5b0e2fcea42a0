@ The first order's hot loops with an input for a Cortex-M4F. The bits are those of portable.rs.
@
@ malleus_from_buffer_{equal,two}_{asr,lsl}(filter, buffer, out, frames)
@ adds the buffer, filtered, to out, and leaves the state in the buffer.
@
@ `equal`: b1 = b0, so that one product serves both. `two`: b1 has a product of its own.
@ `asr`: the state's high word is as large as the bus or larger. `lsl`: it is smaller.
@ Offsets in filter (checked at compile time in cortex_m4.rs): state 0, last 8, noise 12, level 16,
@ shift 20, then value and step of damping 24, b0 32, b1 40.

    .syntax unified
    .thumb
    .fpu fpv4-sp-d16
    .section .text.malleus_dynamic_filter_input,"ax",%progbits

@ r0 buffer, r1 out, r2:r3 state, r5 the word that damping multiplies, r7 shift, r8-r11 damping and
@ b0, each with its step. r4 and r12 take turns to hold the input before and this input.
    .macro buffer_equal direction before now
    ldr     \now, [r0]
    ldr     r6, [r1]
    smlal   r2, r3, r8, r5
    add     \before, \before, \now
    smlal   r2, r3, r10, \before
    add     r8, r8, r9
    lsl     r5, r3, #2
    \direction \before, r3, r7
    qadd    r6, r6, \before
    add     r10, r10, r11
    str     r5, [r0], #4
    str     r6, [r1], #4
    .endm

@ r12 b1, lr step of b1. r4 and r6 take turns to hold the input before and this input.
    .macro buffer_two direction before now
    ldr     \now, [r0]
    lsl     r5, r3, #2
    smlal   r2, r3, r8, r5
    smlal   r2, r3, r10, \now
    smlal   r2, r3, r12, \before
    add     r8, r8, r9
    lsl     r5, r3, #2
    \direction \before, r3, r7
    str     r5, [r0], #4
    ldr     r5, [r1]
    add     r10, r10, r11
    add     r12, r12, lr
    qadd    r5, r5, \before
    str     r5, [r1], #4
    .endm

    .macro from_buffer kind direction
    .p2align 2
    .global malleus_from_buffer_\kind\()_\direction
    .type   malleus_from_buffer_\kind\()_\direction, %function
    .thumb_func
malleus_from_buffer_\kind\()_\direction:
    push    {r0, r4-r11, lr}
    add     r12, r2, r3, lsl #2
    vmov    s0, r12
    sub     r12, r12, #16
    vmov    s1, r12
    mov     r4, r2
    vmov    s2, r1
    vmov    s3, r4
    ldm     r0, {r2-r12, lr}
    vmov    r0, s2
    vmov    r1, s3
    lsl     r5, r3, #2
    .ifc \direction, lsl
    rsb     r7, r7, #0
    .endif
    vmov    r6, s1
    cmp     r1, r6
    bhi     2f
1:  .rept   2
    .ifc \kind, equal
    buffer_equal \direction, r4, r12
    buffer_equal \direction, r12, r4
    .else
    buffer_two \direction, r4, r6
    buffer_two \direction, r6, r4
    .endif
    .endr
    vmov    r6, s1
    cmp     r1, r6
    bls     1b
2:  vmov    r6, s0
    cmp     r1, r6
    bhs     4f
3:  .ifc \kind, equal
    buffer_equal \direction, r4, r12
    mov     r4, r12
    .else
    buffer_two \direction, r4, r6
    mov     r4, r6
    .endif
    vmov    r6, s0
    cmp     r1, r6
    blo     3b
4:  pop     {r0}
    stm     r0, {r2-r4}
    str     r8, [r0, #24]
    str     r10, [r0, #32]
    .ifc \kind, two
    str     r12, [r0, #40]
    .endif
    pop     {r4-r11, pc}
    .size   malleus_from_buffer_\kind\()_\direction, . - malleus_from_buffer_\kind\()_\direction
    .endm

    from_buffer equal, asr
    from_buffer equal, lsl
    from_buffer two, asr
    from_buffer two, lsl

@ malleus_noise(noise, level, words, frames): fills words with noise, and returns the generator's
@ word.
    .p2align 2
    .global malleus_noise
    .type   malleus_noise, %function
    .thumb_func
malleus_noise:
    push    {r4, lr}
    movw    r12, #0x65dd
    movt    r12, #0x93d7
    subs    r3, #8
    blo     2f
1:  .irp    at, 0, 4, 8, 12, 16, 20, 24, 28
    mul     r0, r0, r12
    smmul   r4, r0, r1
    str     r4, [r2, #\at]
    .endr
    adds    r2, #32
    subs    r3, #8
    bhs     1b
2:  adds    r3, #8
    beq     4f
3:  mul     r0, r0, r12
    smmul   r4, r0, r1
    str     r4, [r2], #4
    subs    r3, #1
    bne     3b
4:  pop     {r4, pc}
    .size   malleus_noise, . - malleus_noise

@ malleus_from_sums_{equal,two}_{fine,coarse}_{near,lsl,far}(filter, sums, out, frames)
@ clips sums of noise and loops at 2.0 and adds them, filtered, to out. It leaves the state in the
@ place of the sums, and returns the sizes of the words that it leaves, or'ed.
@
@ `fine`: a step of a sum is one of the input. `coarse`: a step of a sum is 32 of the input.
@ `near`: the state's high word is the word on the bus. `lsl`: the bus is up to 4 times as large.
@ `far`: the bus is 8 times as large or more. Damping then multiplies two bits below the high word
@ too, and the words that stay are words of the bus.
@
@ r0 sums, r1 out, r2:r3 state, r5 the word that damping multiplies, r6 sound, r7 shift, r8-r11
@ damping and b0, each with its step, lr sizes. r4 and r12 take turns to hold the input before and
@ this input.
@ The macro `taken` computes the word of the state that damping multiplies.
    .macro taken direction word
    lsl     \word, r3, #2
    .ifc \direction, far
    orr     \word, \word, r2, lsr #30
    .endif
    .endm

@ The state's word on a bus that is far larger: the high word shifted left by r7 bits, with bits of
@ the low word below. It fits the line.
    .macro word_of_bus word spare
    vmov    \spare, s5
    lsr     \spare, r2, \spare
    lsl     \word, r3, r7
    orr     \word, \word, \spare
    .endm

    .macro input grain word
    .ifc \grain, coarse
    ssat    \word, #26, \word
    lsl     \word, \word, #5
    .else
    ssat    \word, #31, \word
    .endif
    .endm

    .macro sums_equal grain direction before now
    ldr     \now, [r0]
    .ifnc \direction, far
    ldr     r6, [r1]
    .endif
    smlal   r2, r3, r8, r5
    input   \grain, \now
    add     \before, \before, \now
    smlal   r2, r3, r10, \before
    add     r8, r8, r9
    add     r10, r10, r11
    .ifc \direction, far
    word_of_bus \before, r6
    ldr     r6, [r1]
    qadd    r6, r6, \before
    str     \before, [r0], #4
    str     r6, [r1], #4
    eor     \before, \before, \before, asr #31
    taken   far, r5
    .else
    taken   \direction, r5
    .ifc \direction, near
    qadd    r6, r6, r3
    .else
    lsl     \before, r3, r7
    qadd    r6, r6, \before
    .endif
    str     r5, [r0], #4
    eor     \before, r5, r5, asr #31
    str     r6, [r1], #4
    .endif
    orr     lr, lr, \before
    .endm

@ r12 b1, lr step of b1, s4 sizes. r4 and r6 take turns to hold the input before and this input.
    .macro sums_two grain direction before now
    ldr     \now, [r0]
    taken   \direction, r5
    smlal   r2, r3, r8, r5
    input   \grain, \now
    smlal   r2, r3, r10, \now
    smlal   r2, r3, r12, \before
    add     r8, r8, r9
    add     r10, r10, r11
    add     r12, r12, lr
    ldr     \before, [r1]
    .ifc \direction, far
    vmov    s6, \before
    word_of_bus r5, \before
    vmov    \before, s6
    qadd    \before, \before, r5
    .else
    .ifc \direction, near
    qadd    \before, \before, r3
    .else
    lsl     r5, r3, r7
    qadd    \before, \before, r5
    .endif
    taken   \direction, r5
    .endif
    str     \before, [r1], #4
    str     r5, [r0], #4
    eor     r5, r5, r5, asr #31
    vmov    \before, s4
    orr     \before, \before, r5
    vmov    s4, \before
    .endm

    .macro from_sums kind grain direction
    .p2align 2
    .global malleus_from_sums_\kind\()_\grain\()_\direction
    .type   malleus_from_sums_\kind\()_\grain\()_\direction, %function
    .thumb_func
malleus_from_sums_\kind\()_\grain\()_\direction:
    push    {r0, r4-r11, lr}
    add     r12, r2, r3, lsl #2
    vmov    s0, r12
    sub     r12, r12, #32
    vmov    s1, r12
    mov     lr, r0
    mov     r0, r1
    mov     r1, r2
    ldm     lr, {r2-r4}
    ldr     r7, [lr, #20]
    ldr     r8, [lr, #24]
    ldr     r9, [lr, #28]
    ldr     r10, [lr, #32]
    ldr     r11, [lr, #36]
    .ifc \kind, equal
    mov     lr, #0
    .else
    ldr     r12, [lr, #40]
    ldr     lr, [lr, #44]
    mov     r5, #0
    vmov    s4, r5
    .endif
    taken   \direction, r5
    .ifnc \direction, near
    rsb     r7, r7, #0
    .endif
    .ifc \direction, far
    rsb     r6, r7, #32
    vmov    s5, r6
    .endif
    vmov    r6, s1
    cmp     r1, r6
    bhi     2f
1:  .rept   4
    .ifc \kind, equal
    sums_equal \grain, \direction, r4, r12
    sums_equal \grain, \direction, r12, r4
    .else
    sums_two \grain, \direction, r4, r6
    sums_two \grain, \direction, r6, r4
    .endif
    .endr
    .ifc \kind, equal
    vmov    r6, s1
    cmp     r1, r6
    .else
    vmov    r5, s1
    cmp     r1, r5
    .endif
    bls     1b
2:  .ifc \kind, equal
    vmov    r6, s0
    cmp     r1, r6
    .else
    vmov    r5, s0
    cmp     r1, r5
    .endif
    bhs     4f
3:  .ifc \kind, equal
    sums_equal \grain, \direction, r4, r12
    mov     r4, r12
    .else
    sums_two \grain, \direction, r4, r6
    mov     r4, r6
    .endif
    b       2b
4:  pop     {r1}
    stm     r1, {r2-r4}
    str     r8, [r1, #24]
    str     r10, [r1, #32]
    .ifc \kind, two
    str     r12, [r1, #40]
    vmov    r0, s4
    .else
    mov     r0, lr
    .endif
    pop     {r4-r11, pc}
    .size   malleus_from_sums_\kind\()_\grain\()_\direction, . - malleus_from_sums_\kind\()_\grain\()_\direction
    .endm

    .irp grain, fine, coarse
    from_sums equal, \grain, near
    from_sums equal, \grain, lsl
    from_sums equal, \grain, far
    from_sums two, \grain, near
    from_sums two, \grain, lsl
    from_sums two, \grain, far
    .endr
