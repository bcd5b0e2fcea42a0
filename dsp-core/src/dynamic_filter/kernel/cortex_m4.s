@ The first order's hot loops of noise for a Cortex-M4F. The bits are those of portable.rs.
@
@ malleus_from_noise_{equal,two}_{near,loud,far}(filter, out, frames)
@ draws noise and adds it, filtered, to out.
@
@ `equal`: b1 = b0, so that one product serves both. `two`: b1 has a product of its own.
@ `near`: the state's high word is the word on the bus. `loud`: the bus is 4 times as large.
@ `far`: the bus is 8 times as large or more.
@ Offsets in filter (checked at compile time in cortex_m4.rs): state 0, last 8, noise 12, level 16,
@ shift 20, then value and step of damping 24, b0 32, b1 40.
@
@ Optimisation log (nominal cycles a frame, this file alone):
@   104    plain Rust, noise from SFC32, state in 64 bits
@    18.1  noise as packed halves of SFC32 in a buffer of its own (4.1), filter (14): too many loads
@          and stores
@    17.1  both in one loop, SFC32: three registers too many, steps fetched from s-registers
@    13.6  a multiplicative generator needs one register and a cycle
@    11.8  a state in the bus' own format needs no shift and no register for it, so that two frames
@          of the output are fetched at once

    .syntax unified
    .thumb
    .fpu fpv4-sp-d16
    .section .text.malleus_dynamic_filter,"ax",%progbits

@ Two frames. r0 multiplier of the generator, r1 out, r2:r3 state, r5 noise, r6 level, r8 damping,
@ r9 step of damping, r10 b0, r11 step of b0. r4, r12 and lr take turns to hold the e before, this e
@ and the next e. The register of the e before then holds the sum of two, and then the sound.
    .macro noise_equal_near before now next
    mul     r5, r5, r0
    lsl     r7, r3, #2
    smlal   r2, r3, r8, r7
    smmul   \now, r5, r6
    add     \before, \before, \now
    smlal   r2, r3, r10, \before
    add     r8, r8, r9
    add     r10, r10, r11
    ldr     \before, [r1]
    ldr     r7, [r1, #4]
    qadd    \before, \before, r3
    mul     r5, r5, r0
    lsl     \next, r3, #2
    smlal   r2, r3, r8, \next
    smmul   \next, r5, r6
    add     \now, \now, \next
    smlal   r2, r3, r10, \now
    add     r8, r8, r9
    qadd    r7, r7, r3
    add     r10, r10, r11
    str     r7, [r1, #4]
    str     \before, [r1], #8
    .endm

    .macro noise_equal_one_near before now
    mul     r5, r5, r0
    lsl     lr, r3, #2
    smlal   r2, r3, r8, lr
    smmul   \now, r5, r6
    add     \before, \before, \now
    smlal   r2, r3, r10, \before
    ldr     lr, [r1]
    add     r8, r8, r9
    add     r10, r10, r11
    qadd    lr, lr, r3
    str     lr, [r1], #4
    .endm

@ r7 holds four times the state's high word: this frame's sound, which damping multiplies next.
    .macro noise_equal_one_loud before now
    mul     r5, r5, r0
    smlal   r2, r3, r8, r7
    smmul   \now, r5, r6
    add     \before, \before, \now
    smlal   r2, r3, r10, \before
    ldr     lr, [r1]
    add     r8, r8, r9
    lsl     r7, r3, #2
    add     r10, r10, r11
    qadd    lr, lr, r7
    str     lr, [r1], #4
    .endm

@ r0 b1, r6 step of b1, r7 multiplier of the generator, s2 level. The other registers are those of
@ noise_equal_near.
    .macro noise_two_one_near before now
    mul     r5, r5, r7
    lsl     lr, r3, #2
    smlal   r2, r3, r8, lr
    vmov    lr, s2
    smmul   \now, r5, lr
    smlal   r2, r3, r10, \now
    smlal   r2, r3, r0, \before
    ldr     lr, [r1]
    add     r8, r8, r9
    add     r10, r10, r11
    qadd    lr, lr, r3
    add     r0, r0, r6
    str     lr, [r1], #4
    .endm

    .macro noise_two_one_loud before now
    mul     r5, r5, r7
    lsl     lr, r3, #2
    smlal   r2, r3, r8, lr
    vmov    lr, s2
    smmul   \now, r5, lr
    smlal   r2, r3, r10, \now
    smlal   r2, r3, r0, \before
    ldr     lr, [r1]
    lsl     \before, r3, #2
    add     r8, r8, r9
    add     r10, r10, r11
    qadd    lr, lr, \before
    add     r0, r0, r6
    str     lr, [r1], #4
    .endm

    .macro from_noise kind loudness
    .p2align 2
    .global malleus_from_noise_\kind\()_\loudness
    .type   malleus_from_noise_\kind\()_\loudness, %function
    .thumb_func
malleus_from_noise_\kind\()_\loudness:
    push    {r0, r4-r11, lr}
    add     r12, r1, r2, lsl #2
    vmov    s0, r12
    sub     r12, r12, #64
    vmov    s1, r12
    cmp     r1, r12
    .ifc \kind, two
    ldr     r12, [r0, #40]
    ldr     lr, [r0, #44]
    .endif
    ldm     r0, {r2-r11}
    .ifc \kind, two
    vmov    s2, r6
    mov     r0, r12
    mov     r6, lr
    movw    r7, #0x65dd
    movt    r7, #0x93d7
    .else
    movw    r0, #0x65dd
    movt    r0, #0x93d7
    lsl     r7, r3, #2
    .endif
    bhi     2f
1:  .ifc \kind\()_\loudness, equal_near
    .rept   4
    noise_equal_near r4, r12, lr
    noise_equal_near lr, r12, r4
    .endr
    .else
    .rept   8
    noise_\kind\()_one_\loudness r4, r12
    noise_\kind\()_one_\loudness r12, r4
    .endr
    .endif
    vmov    lr, s1
    cmp     r1, lr
    bls     1b
2:  vmov    lr, s0
    cmp     r1, lr
    blo     3f
4:  .ifc \kind, two
    mov     r12, r0
    .endif
    pop     {r0}
    stm     r0, {r2-r5}
    str     r8, [r0, #24]
    str     r10, [r0, #32]
    .ifc \kind, two
    str     r12, [r0, #40]
    .endif
    pop     {r4-r11, pc}
3:  noise_\kind\()_one_\loudness r4, r12
    mov     r4, r12
    b       2b
    .size   malleus_from_noise_\kind\()_\loudness, . - malleus_from_noise_\kind\()_\loudness
    .endm

@ The bus is 8 times the high word or more. Damping multiplies a word with two bits of the low word,
@ and that word is also the sound of the frame before. So a frame begins by adding that sound.
    .macro far_sound now
    lsl     lr, r3, #2
    orr     lr, lr, r2, lsr #30
    ldr     \now, [r1]
    smlal   r2, r3, r8, lr
    lsl     lr, lr, r7
    qadd    \now, \now, lr
    str     \now, [r1], #4
    .endm

    .macro far_input_equal before now
    mul     r5, r5, r0
    smmul   \now, r5, r6
    add     \before, \before, \now
    smlal   r2, r3, r10, \before
    add     r8, r8, r9
    add     r10, r10, r11
    .endm

    .macro far_input_two before now
    vmov    lr, s3
    mul     r5, r5, lr
    vmov    lr, s2
    smmul   \now, r5, lr
    smlal   r2, r3, r10, \now
    smlal   r2, r3, r0, \before
    add     r8, r8, r9
    add     r10, r10, r11
    add     r0, r0, r6
    .endm

    .macro from_noise_far kind
    .p2align 2
    .global malleus_from_noise_\kind\()_far
    .type   malleus_from_noise_\kind\()_far, %function
    .thumb_func
malleus_from_noise_\kind\()_far:
    push    {r0, r4-r11, lr}
    add     r12, r1, r2, lsl #2
    sub     r12, r12, #4
    vmov    s0, r12
    sub     r12, r12, #32
    vmov    s1, r12
    .ifc \kind, two
    ldr     r12, [r0, #40]
    ldr     lr, [r0, #44]
    .endif
    ldm     r0, {r2-r11}
    movw    r0, #0x65dd
    movt    r0, #0x93d7
    .ifc \kind, two
    vmov    s2, r6
    vmov    s3, r0
    mov     r0, r12
    mov     r6, lr
    .endif
    rsb     r7, r7, #0
    sub     r7, r7, #2
    lsl     lr, r3, #2
    orr     lr, lr, r2, lsr #30
    smlal   r2, r3, r8, lr
    far_input_\kind r4, r12
    vmov    lr, s1
    cmp     r1, lr
    bhi     2f
1:  .rept   4
    far_sound r4
    far_input_\kind r12, r4
    far_sound r12
    far_input_\kind r4, r12
    .endr
    vmov    lr, s1
    cmp     r1, lr
    bls     1b
2:  vmov    lr, s0
    cmp     r1, lr
    bhs     4f
3:  far_sound r4
    far_input_\kind r12, r4
    mov     r12, r4
    vmov    lr, s0
    cmp     r1, lr
    blo     3b
4:  mov     r4, r12
    lsl     lr, r3, #2
    orr     lr, lr, r2, lsr #30
    lsl     lr, lr, r7
    ldr     r12, [r1]
    qadd    r12, r12, lr
    str     r12, [r1]
    .ifc \kind, two
    mov     r12, r0
    .endif
    pop     {r0}
    stm     r0, {r2-r5}
    str     r8, [r0, #24]
    str     r10, [r0, #32]
    .ifc \kind, two
    str     r12, [r0, #40]
    .endif
    pop     {r4-r11, pc}
    .size   malleus_from_noise_\kind\()_far, . - malleus_from_noise_\kind\()_far
    .endm

    from_noise_far equal
    from_noise_far two

    .irp loudness, near, loud
    from_noise equal, \loudness
    from_noise two, \loudness
    .endr
