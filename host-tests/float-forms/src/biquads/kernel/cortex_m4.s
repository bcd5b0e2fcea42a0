@ The hot loop of the bank of biquads in single precision for a Cortex-M4F: four sections in
@ registers over one run of frames.
@
@ malleus_float_biquads(call)
@
@ The bits are those of portable.rs. Layouts (checked at compile time in cortex_m4.rs):
@   call    quads 0, end 4, frames 8 (1 or more), input 12 (null: none), out 16, direct 20
@   quad    u 0, v 16, kept 32, turn 48, entry 64, gain 80 (four of each), awake 96; BF_QUAD bytes
@
@ Registers: s0-s3 u, s4-s7 v, s8-s11 kept, s12-s15 turn, s16-s19 entry, s20-s23 gain; s24, s30
@ inputs, s25, s31 sums, s26-s29 products.
@ r0 input, r1 quad, r2 end, r3 frames, r4 input, r5 out, r6 where what goes straight through is
@ (once), r7 out, r8 frames.
@
@ A result that the next instruction takes costs a cycle more, so that four sections go side by
@ side. VMLA would be one instruction for two, and
@ takes as many cycles; it rounds once less on no machine but this.
    .syntax unified
    .thumb
    .fpu fpv4-sp-d16
    .section .text.malleus_float_biquads,"ax",%progbits

@ 36 operations: 9 a section.
    .macro bf_driven_step x sum direct
    .if \direct
    vldr    s26, [r6]
    vmul.f32 s27, s13, s5
    vmul.f32 s26, s26, \x
    vmul.f32 s28, s14, s6
    vadd.f32 \sum, \sum, s26
    vmul.f32 s26, s12, s4
    .else
    vmul.f32 s26, s12, s4
    vmul.f32 s27, s13, s5
    vmul.f32 s28, s14, s6
    .endif
    vmul.f32 s29, s15, s7
    vsub.f32 s0, s0, s26
    vadd.f32 \sum, \sum, s4
    vsub.f32 s1, s1, s27
    vmul.f32 s26, s16, s0
    vadd.f32 \sum, \sum, s5
    vsub.f32 s2, s2, s28
    vmul.f32 s27, s17, s1
    vadd.f32 \sum, \sum, s6
    vsub.f32 s3, s3, s29
    vmul.f32 s28, s18, s2
    vadd.f32 \sum, \sum, s7
    vmul.f32 s29, s19, s3
    vmul.f32 s0, s8, s0
    vadd.f32 s4, s4, s26
    vmul.f32 s1, s9, s1
    vadd.f32 s5, s5, s27
    vmul.f32 s2, s10, s2
    vadd.f32 s6, s6, s28
    vmul.f32 s3, s11, s3
    vadd.f32 s7, s7, s29
    vmul.f32 s26, s20, \x
    vmul.f32 s27, s21, \x
    vmul.f32 s28, s22, \x
    vmul.f32 s29, s23, \x
    vadd.f32 s4, s4, s26
    vadd.f32 s5, s5, s27
    vadd.f32 s6, s6, s28
    vadd.f32 s7, s7, s29
    vadd.f32 s0, s0, \x
    vadd.f32 s1, s1, \x
    vadd.f32 s2, s2, \x
    vadd.f32 s3, s3, \x
    .endm

    .macro bf_driven_frame at direct
    vldr    s24, [r0, #\at]
    vldr    s25, [r7, #\at]
    bf_driven_step s24, s25, \direct
    vstr    s25, [r7, #\at]
    .endm

@ Two frames, their four loads in a row (5) and two stores: 39.5 cycles a frame, 9.9 a section.
    .macro bf_driven_frames at direct
    vldr    s24, [r0, #\at]
    vldr    s30, [r0, #\at + 4]
    vldr    s25, [r7, #\at]
    vldr    s31, [r7, #\at + 4]
    bf_driven_step s24, s25, \direct
    bf_driven_step s30, s31, \direct
    vstr    s25, [r7, #\at]
    vstr    s31, [r7, #\at + 4]
    .endm

@ 24 operations, a load and a store: 27 cycles, 6.75 a section.
    .macro bf_free_frame at direct
    vldr    s25, [r7, #\at]
    vmul.f32 s26, s12, s4
    vmul.f32 s27, s13, s5
    vmul.f32 s28, s14, s6
    vmul.f32 s29, s15, s7
    vsub.f32 s0, s0, s26
    vadd.f32 s25, s25, s4
    vsub.f32 s1, s1, s27
    vmul.f32 s26, s16, s0
    vadd.f32 s25, s25, s5
    vsub.f32 s2, s2, s28
    vmul.f32 s27, s17, s1
    vadd.f32 s25, s25, s6
    vsub.f32 s3, s3, s29
    vmul.f32 s28, s18, s2
    vadd.f32 s25, s25, s7
    vmul.f32 s29, s19, s3
    vmul.f32 s0, s8, s0
    vadd.f32 s4, s4, s26
    vmul.f32 s1, s9, s1
    vadd.f32 s5, s5, s27
    vmul.f32 s2, s10, s2
    vadd.f32 s6, s6, s28
    vmul.f32 s3, s11, s3
    vadd.f32 s7, s7, s29
    vstr    s25, [r7, #\at]
    .endm

    .macro bf_free_frames at direct
    bf_free_frame \at, \direct
    bf_free_frame \at + 4, \direct
    .endm

    .macro bf_loop name direct
    .p2align 2
bf_\name\()_\direct:
    subs    r8, #4
    blo     2f
1:  bf_\name\()_frames 0, \direct
    bf_\name\()_frames 8, \direct
    adds    r0, #16
    adds    r7, #16
    subs    r8, #4
    bhs     1b
2:  adds    r8, #4
    beq     bf_after
3:  bf_\name\()_frame 0, \direct
    adds    r0, #4
    adds    r7, #4
    subs    r8, #1
    bne     3b
    b       bf_after
    .endm

    .p2align 2
    .global malleus_float_biquads
    .type   malleus_float_biquads, %function
    .thumb_func
malleus_float_biquads:
    push    {r4-r8, lr}
    vpush   {s16-s31}
    add     r6, r0, #20
    ldm     r0, {r1-r5}
    ldr     r7, [r6]
    lsls    r7, #1                      @ neither 0 nor -0
    it      eq
    moveq   r6, #0
bf_next:
    cmp     r1, r2
    bhs     bf_done
    ldr     r7, [r1, #96]
    cbz     r7, bf_skip
    vldmia  r1, {s0-s23}
    mov     r0, r4
    mov     r7, r5
    mov     r8, r3
    cbz     r4, bf_free
    cbz     r6, bf_driven
    b       bf_driven_1
bf_skip:
    add     r1, #BF_QUAD
    b       bf_next
bf_free:
    b       bf_free_0
bf_driven:
    b       bf_driven_0
bf_after:
    vstmia  r1, {s0-s7}
    mov     r6, #0
    add     r1, #BF_QUAD
    b       bf_next
bf_done:
    vpop    {s16-s31}
    pop     {r4-r8, pc}

    bf_loop driven, 0
    bf_loop driven, 1
    bf_loop free, 0
    .size   malleus_float_biquads, . - malleus_float_biquads
