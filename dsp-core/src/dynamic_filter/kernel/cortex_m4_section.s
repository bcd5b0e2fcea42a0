@ The exciter's sections for a Cortex-M4F. The bits are those of section.rs.
@
@ malleus_section_{band,low,high}(section, words, frames): runs words through a section, in place.
@ Offsets in section (checked at compile time in cortex_m4.rs): c1 0, c2 4, remainders of v1 and v2
@ 8, 12, -m 16, p 20, -p 24, -n 28, input multipliers of v1 and v2 32, 36, k 40.
@
@ Optimisation log (nominal cycles a frame, first-order filter and noise with both sections):
@   155    plain Rust, both sections in one loop
@    89    assembly, one pass for each section, all states and multipliers in registers: 21.9 each,
@          the high-pass 23.9

    .syntax unified
    .thumb
    .fpu fpv4-sp-d16
    .section .text.malleus_section,"ax",%progbits

@ v = c + sum / 2^31, then c = 2 v - c. `high` is the sum's high word. `left` is its low word, and
@ becomes the remainder of the division.
    .macro section_state c left high v
    add     \v, \c, \high, lsl #1
    add     \v, \v, \left, lsr #31
    bic     \left, \left, #0x80000000
    rsb     \c, \c, \v, lsl #1
    .endm

@ r0 words, r1 c1, r2 c2, r3 and r4 remainders, r5 -m, r6 p, r7 -p, r8 -n, r11 x, lr and r12 high
@ words. r9 and r10 hold the input multipliers; for the high-pass they hold c2 - x and k.
    .macro section_frame response
    ldr     r11, [r0]
    mov     r12, #0
    mov     lr, #0
    .ifc \response, high
    sub     r9, r2, r11
    smlal   r4, r12, r8, r9
    smlal   r3, lr, r7, r9
    .else
    smlal   r4, r12, r10, r11
    smlal   r4, r12, r8, r2
    smlal   r3, lr, r9, r11
    smlal   r3, lr, r7, r2
    .endif
    smlal   r4, r12, r6, r1
    smlal   r3, lr, r5, r1
    .ifc \response, high
    section_state r2, r4, r12, r9
    section_state r1, r3, lr, r12
    smmulr  r12, r12, r10
    sub     r11, r11, r9
    sub     r11, r11, r12, lsl #2
    .else
    section_state r2, r4, r12, r11
    section_state r1, r3, lr, r12
    .endif
    .ifc \response, band
    str     r12, [r0], #4
    .else
    str     r11, [r0], #4
    .endif
    .endm

    .macro section_of response
    .p2align 2
    .global malleus_section_\response
    .type   malleus_section_\response, %function
    .thumb_func
malleus_section_\response:
    push    {r0, r4-r11, lr}
    add     r9, r1, r2, lsl #2
    vmov    s0, r9
    sub     r9, r9, #16
    vmov    s1, r9
    mov     r12, r0
    mov     r0, r1
    cmp     r0, r9
    ldm     r12, {r1-r10}
    .ifc \response, high
    ldr     r10, [r12, #40]
    .endif
    bhi     2f
1:  .rept   4
    section_frame \response
    .endr
    vmov    r11, s1
    cmp     r0, r11
    bls     1b
2:  vmov    r11, s0
    cmp     r0, r11
    bhs     4f
3:  section_frame \response
    vmov    r11, s0
    cmp     r0, r11
    blo     3b
4:  pop     {r0}
    stm     r0, {r1-r4}
    pop     {r4-r11, pc}
    .size   malleus_section_\response, . - malleus_section_\response
    .endm

    section_of band
    section_of low
    section_of high
