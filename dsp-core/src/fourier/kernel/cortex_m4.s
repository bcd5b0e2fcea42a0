@ The loops of the transform for a Cortex-M4F.
@
@ malleus_fourier_pass(data, row, first, count, factors)   butterflies of radix 4 over blocks
@ malleus_fourier_last_pass(data, count)                   those of blocks of four points
@
@ The bits are those of portable.rs. A complex number has 8 bytes, three factors have 24.
@ Products are rounded before they are added.

    .syntax unified
    .thumb
    .fpu fpv4-sp-d16
    .section .text.malleus_fourier,"ax",%progbits

@ Sums and differences of a s0-s1, b s2-s3, c s4-s5, d s6-s7: y0 in s2-s3, y1 in s4-s5, y2 in
@ s14-s15, y3 in s0-s1.
    .macro butterfly
    vadd.f32 s14, s0, s4                @ even
    vadd.f32 s15, s1, s5
    vsub.f32 s0, s0, s4                 @ odd
    vsub.f32 s1, s1, s5
    vadd.f32 s4, s2, s6                 @ sum
    vadd.f32 s5, s3, s7
    vsub.f32 s7, s7, s3                 @ turned
    vsub.f32 s6, s2, s6
    vadd.f32 s2, s14, s4
    vadd.f32 s3, s15, s5
    vsub.f32 s14, s14, s4
    vsub.f32 s15, s15, s5
    vadd.f32 s4, s0, s7
    vadd.f32 s5, s1, s6
    vsub.f32 s0, s0, s7
    vsub.f32 s1, s1, s6
    .endm

@ --------------------------------------------------------------------------------------------------
@ Butterflies of radix 4. 66 cycles each: 9 to load points, 7 for factors, 34 for sums and products,
@ 12 to store, 4 for the loop.
@ Registers: r0-r3 points a, b, c, d, r4 factors, r5 butterflies left, r6 butterflies left in the
@ block, r7 bytes of a quarter of a block, r8 factors of a block, r9 a quarter's butterflies.
    .p2align 4
    .global malleus_fourier_pass
    .type   malleus_fourier_pass, %function
malleus_fourier_pass:
    push    {r4-r9, lr}
    ldr     r8, [sp, #28]
    mov     r5, r3
    mov     r9, r1
    lsl     r7, r1, #3
    sub     r6, r1, r2
    add     r0, r0, r2, lsl #3
    add     r4, r2, r2, lsl #1
    add     r4, r8, r4, lsl #3
1:  add     r1, r0, r7
    add     r2, r1, r7
    add     r3, r2, r7
    cmp     r6, r5
    it      hi
    movhi   r6, r5
    sub     r5, r5, r6
2:  vldr    s0, [r0]
    vldr    s1, [r0, #4]
    vldr    s2, [r1]
    vldr    s3, [r1, #4]
    vldr    s4, [r2]
    vldr    s5, [r2, #4]
    vldr    s6, [r3]
    vldr    s7, [r3, #4]
    vldm    r4!, {s8-s13}
    butterfly
    vstm    r0!, {s2-s3}
    vmul.f32 s6, s14, s10               @ y2 w2
    vmul.f32 s7, s15, s11
    vmul.f32 s2, s14, s11
    vmul.f32 s3, s15, s10
    vmul.f32 s14, s4, s8                @ y1 w1
    vmul.f32 s15, s5, s9
    vmul.f32 s4, s4, s9
    vmul.f32 s5, s5, s8
    vmul.f32 s8, s0, s12                @ y3 w3
    vmul.f32 s9, s1, s13
    vmul.f32 s0, s0, s13
    vmul.f32 s1, s1, s12
    vsub.f32 s6, s6, s7
    vadd.f32 s7, s2, s3
    vsub.f32 s14, s14, s15
    vadd.f32 s15, s4, s5
    vsub.f32 s8, s8, s9
    vadd.f32 s9, s0, s1
    subs    r6, r6, #1
    vstm    r1!, {s6-s7}
    vstm    r2!, {s14-s15}
    vstm    r3!, {s8-s9}
    bne     2b
    mov     r0, r3                      @ the next block
    mov     r4, r8
    mov     r6, r9
    cmp     r5, #0
    bne     1b
    pop     {r4-r9, pc}
    .size   malleus_fourier_pass, . - malleus_fourier_pass

@ --------------------------------------------------------------------------------------------------
@ Blocks of four points. 38 cycles each.
@ Registers: r0 points, r1 blocks left.
    .p2align 4
    .global malleus_fourier_last_pass
    .type   malleus_fourier_last_pass, %function
malleus_fourier_last_pass:
    vldm    r0, {s0-s7}
    butterfly
    vstr    s2, [r0]
    vstr    s3, [r0, #4]
    vstr    s14, [r0, #8]
    vstr    s15, [r0, #12]
    vstr    s4, [r0, #16]
    vstr    s5, [r0, #20]
    vstr    s0, [r0, #24]
    vstr    s1, [r0, #28]
    add     r0, r0, #32
    subs    r1, r1, #1
    bne     malleus_fourier_last_pass
    bx      lr
    .size   malleus_fourier_last_pass, . - malleus_fourier_last_pass
