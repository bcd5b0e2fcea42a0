@ The loops' band-passes for a Cortex-M4F. The bits are those of portable.rs.
@
@ malleus_loops(bands, count, line, line_end, sums, frames)
@ adds each band's output to the sums. A band reads the line as many frames before the sums as its
@ delay has. Behind the line's end it goes on at the start. Returns 1 if a state is to be scaled
@ anew, else 0. The last two arguments lie on the stack.
@
@ malleus_loops_on_noise(..., noise, level)
@ draws noise into the sums, and adds each band's output to it. The first band's k must be 0.
@ Returns the generator's word too, in r1. noise and level lie on the stack too.
@
@ Offsets in a band (checked at compile time in cortex_m4.rs): u 0, v 4, turn 8, damp 12, gain_u 16,
@ gain_v 20, scale 24, shift k 28, delay 32, least and most zeros 36, 40; 88 bytes in all.
@
@ Optimisation log (nominal cycles a frame and band, this file alone):
@   167    plain Rust, a bank of its own
@    11.1  assembly, a call a band, the sum saturating
@     9.9  the sum has room for all bands, so that the multiplication adds to it
@    14.5  the first band with the noise that it adds to, instead of 16.6 for both, including the
@          beginning and the end of a call

    .syntax unified
    .thumb
    .fpu fpv4-sp-d16
    .section .text.malleus_loop,"ax",%progbits

@ A frame of a band. r1 line, r2 sums, r3 bytes left, r4 u, r5 v, r6 turn, r7 damp, r8 gain_u,
@ r9 gain_v, r10 scale.
    .macro loop_frame k x sum
    smmlsr  r4, r7, r4, r4
    smmlsr  r4, r6, r5, r4
    .if \k == 0
    smmlar  r5, r6, r4, r5
    .else
    add     r5, r5, r4, lsl #\k
    .endif
    smmlar  r4, r8, \x, r4
    smmlar  r5, r9, \x, r5
    smmlar  \sum, r5, r10, \sum
    .endm

    .macro loop_size k
    eor     r6, r5, r5, asr #31
    eor     r7, r4, r4, asr #31
    orr     r6, r6, r7, lsl #\k
    .endm

    .macro loop_of k
1:  subs    r3, #64
    blo     3f
    .p2align 2
2:  .rept   8
    ldr     r12, [r1, #4]
    ldr     r11, [r1], #8
    ldr.w   r0, [r2, #4]
    ldr     lr, [r2]
    loop_frame \k, r11, lr
    loop_frame \k, r12, r0
    str.w   r0, [r2, #4]
    str     lr, [r2], #8
    .endr
    subs    r3, #64
    bhs     2b
3:  adds    r3, #64
    beq     5f
    tst     r3, #4
    beq     4f
    ldr     r11, [r1], #4
    ldr     lr, [r2]
    loop_frame \k, r11, lr
    str     lr, [r2], #4
    subs    r3, #4
    beq     5f
    @ Fewer than 8 pairs of frames are left. The code of a pair has 72 bytes: jump to the pair from
    @ which the right number follows.
4:  rsb     r0, r3, #64
    adr     r12, 2b
    add     r0, r0, r0, lsl #3
    add     r0, r0, r12
    orr     r0, r0, #1
    movs    r3, #0
    bx      r0
5:  vmov    r3, s6
    vmov    r0, s0
    cbz     r3, 6f
    @ The band reads on at the line's start.
    vmov    r1, s2
    mov     r12, #0
    vmov    s6, r12
    b       1b
6:  loop_size \k
    .endm

    .macro loops_begin
    push    {r4-r11, lr}
    ldr     r4, [sp, #36]
    ldr     r5, [sp, #40]
    mov     r6, #0
    vmov    s1, r1
    vmov    s6, r6
    vmov    s7, r6
    vmov    s2, r2
    vmov    s3, r3
    lsl     r5, r5, #2
    vmov    s4, r4
    vmov    s5, r5
    .endm

@ Loads the band at r0, and finds the address that it reads (r1), the sums (r2), and the number of
@ bytes that it can read from there (r3). s6 holds the number of bytes to read at the line's start.
    .macro loop_begin
    ldr     r1, [r0, #32]
    ldm     r0, {r4-r11}
    vmov    s0, r0
    vmov    r2, s4
    vmov    r3, s5
    vmov    r12, s2
    sub     r1, r2, r1, lsl #2
    cmp     r1, r12
    bhs     6f
    @ The address is before the line's start, so the band reads near the line's end. Fewer words may
    @ be left there than it needs. (In all other cases it reads only words before the sums.)
    vmov    r0, s3
    sub     r12, r0, r12
    add     r1, r1, r12
    sub     r12, r0, r1
    sub     r0, r3, r12
    bic     r0, r0, r0, asr #31
    sub     r3, r3, r0
    vmov    s6, r0
6:
    .endm

@ A frame of noise and the first band. r0 the generator's word, r3 multiplier of the generator,
@ lr level, r11 word of the line, r12 sum.
    .macro noise_frame
    ldr     r11, [r1], #4
    mul     r0, r0, r3
    smmul   r12, r0, lr
    loop_frame 0, r11, r12
    str     r12, [r2], #4
    .endm

    .p2align 2
    .global malleus_loops_on_noise
    .type   malleus_loops_on_noise, %function
    .thumb_func
malleus_loops_on_noise:
    loops_begin
    loop_begin
    add     r12, r1, r3
    ldr     r0, [sp, #44]
    ldr     lr, [sp, #48]
    movw    r3, #0x65dd
    movt    r3, #0x93d7
1:  vmov    s9, r12
    sub     r12, r12, #64
    vmov    s10, r12
    cmp     r1, r12
    bhi     3f
2:  .rept   16
    noise_frame
    .endr
    vmov    r12, s10
    cmp     r1, r12
    bls     2b
3:  vmov    r12, s9
    cmp     r1, r12
    beq     5f
4:  noise_frame
    vmov    r12, s9
    cmp     r1, r12
    bne     4b
5:  vmov    r12, s6
    cmp     r12, #0
    beq     6f
    @ The band reads on at the line's start.
    vmov    r1, s2
    add     r12, r12, r1
    mov     r11, #0
    vmov    s6, r11
    b       1b
6:  vmov    s8, r0
    vmov    r0, s0
    loop_size 0
    b       .Lmalleus_loops_end
    .size   malleus_loops_on_noise, . - malleus_loops_on_noise

    .p2align 2
    .global malleus_loops
    .type   malleus_loops, %function
    .thumb_func
malleus_loops:
    loops_begin
7:  loop_begin
    cmp     r11, #1
    beq     .Lmalleus_loops_1
    bhi     .Lmalleus_loops_2
    loop_of 0
8:
.Lmalleus_loops_end:
    clz     r6, r6
    ldrd    r7, r8, [r0, #36]
    vmov    r9, s7
    strd    r4, r5, [r0], #88
    sub     r7, r6, r7
    sub     r8, r8, r6
    orr     r7, r7, r8
    orr     r9, r9, r7
    vmov    s7, r9
    vmov    r1, s1
    subs    r1, #1
    vmov    s1, r1
    bne     7b
    lsr     r0, r9, #31
    vmov    r1, s8
    pop     {r4-r11, pc}
.Lmalleus_loops_1:
    loop_of 1
8:  b       .Lmalleus_loops_end
.Lmalleus_loops_2:
    cmp     r11, #2
    bhi     .Lmalleus_loops_3
    loop_of 2
8:  b       .Lmalleus_loops_end
.Lmalleus_loops_3:
    loop_of 3
8:  b       .Lmalleus_loops_end
    .size   malleus_loops, . - malleus_loops
