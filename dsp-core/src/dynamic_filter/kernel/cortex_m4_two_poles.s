@ The second order's hot loops for a Cortex-M4F. The bits are those of two_poles.rs.
@
@ malleus_{conjugate,real}_{near,loud}(poles, lines, buffer, out, frames)
@ adds the buffer, filtered, to out, and leaves s in the buffer. The last argument lies on the
@ stack.
@
@ `near`: s is as large as the bus or larger. `loud`: s is smaller than the bus.
@ Offsets in poles (checked at compile time in two_poles.rs): two states 0, 8, last 16, shift 20,
@ inner 24, input_bits 28. lines holds five pairs of value and step.
@
@ Optimisation log (nominal cycles a frame, this file alone):
@   162    plain Rust
@    64.1  assembly: values and steps on the stack, everything else in registers
@    61.6  two frames in one pass (real poles 69.6; 10 more if loud)

    .syntax unified
    .thumb
    .fpu fpv4-sp-d16
    .section .text.malleus_two_poles,"ax",%progbits

@ The stack holds the lines' values and steps from sp on, then shift (to the left if loud), the
@ clip, inner and input_bits.
    .equ    two_poles_shift, 40
    .equ    two_poles_clip, 44
    .equ    two_poles_inner, 48
    .equ    two_poles_bits, 52

@ add_rest adds a signed rest to half a state, add_two_rests adds twice a signed rest. state_of
@ makes a state from half of it, with a rounded word.
    .macro add_rest low high rest
    adds    \low, \low, \rest
    adc     \high, \high, \rest, asr #31
    .endm

    .macro add_two_rests low high rest
    adds    \low, \low, \rest, lsl #1
    adc     \high, \high, \rest, asr #31
    .endm

    .macro state_of rest word low high
    adds    \rest, \low, \low
    adc     \word, \high, \high
    add     \word, \word, \rest, lsr #31
    .endm

@ Makes s from half of s, stores it at r0, and adds its sound to `out`, which was fetched from r1.
    .macro put loudness low high shift out spare
    lsl     \high, \high, #1
    orr     \high, \high, \low, lsr #31
    str     \high, [r0], #4
    .ifc \loudness, loud
    ldr     \spare, [sp, #two_poles_clip]
    lsl     \low, \low, #1
    qadd    \high, \high, \spare
    qsub    \high, \high, \spare
    qsub    \high, \high, \spare
    qadd    \high, \high, \spare
    lsl     \high, \high, \shift
    rsb     \shift, \shift, #32
    lsr     \low, \low, \shift
    orr     \high, \high, \low
    .else
    asr     \high, \high, \shift
    .endif
    qadd    \out, \out, \high
    str     \out, [r1], #4
    .endm

@ r0 buffer, r1 out, r2 and r3 rest and word of Re z, r4 and r5 rest and word of Im z, r6 e before
    .macro conjugate_frame loudness
    ldr     r12, [sp, #0]
    ldr     lr, [sp, #8]
    smull   r8, r9, r12, r3
    smull   r10, r11, r12, r5
    smlal   r10, r11, lr, r3
    rsb     r5, r5, #0
    smlal   r8, r9, lr, r5
    smmul   r3, r12, r2
    smmls   r3, lr, r4, r3
    smmul   r5, r12, r4
    smmla   r5, lr, r2, r5
    add_rest r8, r9, r3
    add_rest r10, r11, r5
    ldr     r2, [sp, #4]
    ldr     r3, [sp, #12]
    ldr     r4, [sp, #16]
    ldr     r5, [sp, #20]
    ldr     r7, [sp, #24]
    add     r12, r12, r2
    add     lr, lr, r3
    smlal   r8, r9, r4, r6
    smlal   r10, r11, r7, r6
    add     r4, r4, r5
    str     r12, [sp, #0]
    str     lr, [sp, #8]
    str     r4, [sp, #16]
    ldr     r2, [sp, #28]
    ldr     r3, [sp, #32]
    ldr     r4, [sp, #36]
    ldr     r5, [r1]
    ldr     r6, [r0]
    ldr     r12, [sp, #two_poles_shift]
    add     r7, r7, r2
    smull   r2, lr, r3, r6
    add     r3, r3, r4
    str     r7, [sp, #24]
    str     r3, [sp, #32]
    adds    r2, r2, r8
    adc     lr, lr, r9
    put     \loudness, r2, lr, r12, r5, r7
    state_of r2, r3, r8, r9
    state_of r4, r5, r10, r11
    .endm

@ r0 buffer, r1 out, r2 and r3 rest and word of z1, r4 and r5 rest and word of z2, r6 e before,
@ shifted by input_bits
    .macro real_frame loudness
    ldr     r12, [sp, #0]
    ldr     lr, [sp, #4]
    ldr     r7, [sp, #two_poles_inner]
    smull   r8, r9, r12, r3
    smmul   r10, r12, r2
    add     r12, r12, lr
    smlal   r8, r9, r7, r6
    add_rest r8, r9, r10
    str     r12, [sp, #0]
    ldr     r12, [sp, #8]
    ldr     lr, [sp, #12]
    ldr     r6, [sp, #24]
    ldr     r7, [sp, #28]
    smull   r10, r11, r12, r5
    smmul   r5, r12, r4
    add     r12, r12, lr
    add_rest r10, r11, r5
    lsl     r3, r3, #1
    smlal   r10, r11, r6, r3
    smmul   r5, r6, r2
    add     r6, r6, r7
    add_two_rests r10, r11, r5
    str     r12, [sp, #8]
    str     r6, [sp, #24]
    state_of r2, r3, r8, r9
    ldr     r12, [sp, #16]
    ldr     lr, [sp, #20]
    ldr     r4, [sp, #32]
    ldr     r5, [sp, #36]
    ldr     r6, [r0]
    smull   r7, r8, r4, r6
    add     r4, r4, r5
    lsl     r9, r3, #1
    smlal   r7, r8, r12, r9
    smmul   r9, r12, r2
    add     r12, r12, lr
    add_two_rests r7, r8, r9
    str     r4, [sp, #32]
    str     r12, [sp, #16]
    adds    r7, r7, r10
    adc     r8, r8, r11
    ldr     r5, [r1]
    ldr     r9, [sp, #two_poles_bits]
    ldr     r12, [sp, #two_poles_shift]
    lsl     r6, r6, r9
    put     \loudness, r7, r8, r12, r5, r9
    state_of r4, r5, r10, r11
    .endm

    .macro two_poles kind loudness
    .p2align 2
    .global malleus_\kind\()_\loudness
    .type   malleus_\kind\()_\loudness, %function
    .thumb_func
malleus_\kind\()_\loudness:
    push    {r0, r1, r4-r11, lr}
    ldr     r12, [sp, #44]
    sub     sp, sp, #56
    vmov    s1, r3
    add     r12, r3, r12, lsl #2
    vmov    s0, r12
    mov     r12, r2
    ldm     r1, {r2-r11}
    stm     sp, {r2-r11}
    ldm     r0, {r2-r9}
    .ifc \loudness, loud
    @ The clip keeps a word small enough to be shifted to the left: 2^31 - 2^(31 - left) is added
    @ and subtracted, then subtracted and added, saturating.
    rsb     r7, r7, #0
    mov     r10, #0x80000000
    lsr     r11, r10, r7
    sub     r11, r10, r11
    str     r11, [sp, #two_poles_clip]
    .endif
    str     r7, [sp, #two_poles_shift]
    str     r8, [sp, #two_poles_inner]
    str     r9, [sp, #two_poles_bits]
    mov     r0, r12
    vmov    r1, s1
    add     r3, r3, r2, lsr #31
    add     r5, r5, r4, lsr #31
    vmov    r7, s0
    subs    r7, r7, r1
    beq     2f
    @ If the number of frames is odd, begin with a single one.
    tst     r7, #4
    bne     3f
1:  \kind\()_frame \loudness
3:  \kind\()_frame \loudness
    vmov    r7, s0
    cmp     r1, r7
    blo     1b
2:  ldr     r0, [sp, #56]
    ldr     r1, [sp, #60]
    sub     r3, r3, r2, lsr #31
    sub     r5, r5, r4, lsr #31
    stm     r0, {r2-r6}
    .irp    line, 0, 8, 16, 24, 32
    ldr     r2, [sp, #\line]
    str     r2, [r1, #\line]
    .endr
    add     sp, sp, #64
    pop     {r4-r11, pc}
    .size   malleus_\kind\()_\loudness, . - malleus_\kind\()_\loudness
    .endm

    two_poles conjugate, near
    two_poles conjugate, loud
    two_poles real, near
    two_poles real, loud
