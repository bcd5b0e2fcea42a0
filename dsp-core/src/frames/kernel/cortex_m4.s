@ The hot loops of frames for a Cortex-M4F.
@
@ malleus_frames_synthesize(modes, lines, line count, spectrum, end)   lines from modes; steps them
@ malleus_frames_gather(modes, lines, line count, spectrum, end)       modes from a force's lines
@ malleus_frames_unwindow(lines, out, count, numbers)                  a force's lines, no window
@
@ The bits are those of portable.rs. Layouts (checked at compile time in cortex_m4.rs):
@   mode    state 0, seven numbers 8, step 64, rest of the step 72, gain 76; 84 bytes
@   line    count 0, ringing 2; 4 bytes
@
@ Products are rounded before they are added: a VMUL and a VADD take 2 cycles, a VMLA 3.

    .syntax unified
    .thumb
    .fpu fpv4-sp-d16
    .section .text.malleus_frames,"ax",%progbits

    .equ MODE, 84

@ --------------------------------------------------------------------------------------------------
@ Lines from modes. 102 cycles a mode: 17 to load it, 56 for seven complex products and sums, 22 for
@ the step, 7 for the loop and the store. 34 a line behind another with ringing modes, 47 one alone,
@ 12 one without.
@
@ Optimisation log (nominal cycles a mode of 1025 modes, cargo test -p host-tests --test on_chip
@ frames -- --nocapture): see docs/frames.md.
@ Registers: r0 mode, r1 line, r2 end of the lines, r3 spectrum, r4 modes that ring, r8 modes of the
@ next line, r12 end of the modes, lr MODE; s0-s1 state, s2-s15 numbers, s16-s29 seven lines,
@ s30-s31 products.
    .macro line_of_mode re im sum_re sum_im x y
    vmul.f32 s30, s\re, s\x
    vmul.f32 s31, s\re, s\y
    vmul.f32 s\re, s\im, s\y
    vmul.f32 s\im, s\im, s\x
    vadd.f32 s\sum_re, s\sum_re, s30
    vadd.f32 s\sum_im, s\sum_im, s31
    vsub.f32 s\sum_re, s\sum_re, s\re
    vadd.f32 s\sum_im, s\sum_im, s\im
    .endm

@ Takes a line, unless its modes are not all there. EQ if none ring.
    .macro next_line otherwise
    ldrh    r5, [r1]
    ldrh    r4, [r1, #2]
    add     r1, r1, #4
    mla     r8, r5, lr, r0
    cmp     r4, r5
    bhi     \otherwise
    cmp     r8, r12
    bhi     \otherwise
    cmp     r4, #0
    .endm

    .p2align 4
    .global malleus_frames_synthesize
    .type   malleus_frames_synthesize, %function
malleus_frames_synthesize:
    push    {r4-r8, lr}
    vpush   {s16-s31}
    ldr     r12, [sp, #88]
    add     r2, r1, r2, lsl #2
    mov     lr, #MODE
    b       4f
1:  vldm    r3, {s16-s29}
2:  vldm    r0, {s0-s15}
    line_of_mode 2, 3, 16, 17, 0, 1
    line_of_mode 4, 5, 18, 19, 0, 1
    line_of_mode 6, 7, 20, 21, 0, 1
    line_of_mode 8, 9, 22, 23, 0, 1
    line_of_mode 10, 11, 24, 25, 0, 1
    line_of_mode 12, 13, 26, 27, 0, 1
    line_of_mode 14, 15, 28, 29, 0, 1
    vldr    s2, [r0, #64]
    vldr    s3, [r0, #68]
    ldr     r6, [r0, #72]
    lsl     r7, r6, #16
    bfc     r6, #0, #16
    vmov    s4, r6
    vmov    s5, r7
    vmul.f32 s6, s0, s2                 @ re x
    vmul.f32 s7, s1, s3                 @ im y
    vmul.f32 s8, s0, s4                 @ re rest_x
    vmul.f32 s9, s1, s5                 @ im rest_y
    vmul.f32 s10, s0, s3                @ re y
    vmul.f32 s11, s1, s2                @ im x
    vmul.f32 s12, s0, s5                @ re rest_y
    vmul.f32 s13, s1, s4                @ im rest_x
    vsub.f32 s6, s6, s7
    vsub.f32 s8, s8, s9
    vadd.f32 s10, s10, s11
    vadd.f32 s12, s12, s13
    vadd.f32 s0, s6, s8
    vadd.f32 s1, s10, s12
    subs    r4, r4, #1
    vstr    s0, [r0]
    vstr    s1, [r0, #4]
    add     r0, r0, lr
    bne     2b
    mov     r0, r8
    cmp     r1, r2
    beq     6f
    next_line 6f
    beq     7f
    vstr    s16, [r3]                   @ the next line rings too: all move up by one
    vstr    s17, [r3, #4]
    vmov.f32 s16, s18
    vmov.f32 s17, s19
    vmov.f32 s18, s20
    vmov.f32 s19, s21
    vmov.f32 s20, s22
    vmov.f32 s21, s23
    vmov.f32 s22, s24
    vmov.f32 s23, s25
    vmov.f32 s24, s26
    vmov.f32 s25, s27
    vmov.f32 s26, s28
    vmov.f32 s27, s29
    vldr    s28, [r3, #56]
    vldr    s29, [r3, #60]
    add     r3, r3, #8
    b       2b
7:  vstm    r3, {s16-s29}
    add     r3, r3, #8
3:  mov     r0, r8
    add     r3, r3, #8
4:  cmp     r1, r2
    beq     5f
    next_line 5f
    bne     1b
    b       3b
6:  vstm    r3, {s16-s29}
5:  vpop    {s16-s31}
    pop     {r4-r8, pc}
    .size   malleus_frames_synthesize, . - malleus_frames_synthesize

@ --------------------------------------------------------------------------------------------------
@ Modes from the lines of a force. 94 cycles a mode, 29 a line with modes.
@ Registers: r0 numbers of the mode, r1 line, r2 end of the lines, r3 spectrum, r4 modes left, r5
@ zero, r6 MODE, r12 end of the modes' numbers; s0-s1 sum, s2-s15 numbers, s16-s29 seven lines,
@ s30-s31 products.
    .p2align 4
    .global malleus_frames_gather
    .type   malleus_frames_gather, %function
malleus_frames_gather:
    push    {r4-r6, lr}
    vpush   {s16-s31}
    ldr     r12, [sp, #80]
    mov     r6, #MODE
    add     r12, r12, #8
    add     r2, r1, r2, lsl #2
    add     r0, r0, #8
    mov     r5, #0
    b       3f
1:  vldm    r3, {s16-s29}
2:  vldm    r0, {s2-s15}
    vmov    s0, r5
    vmov    s1, r5
    line_of_mode 2, 3, 0, 1, 16, 17
    line_of_mode 4, 5, 0, 1, 18, 19
    line_of_mode 6, 7, 0, 1, 20, 21
    line_of_mode 8, 9, 0, 1, 22, 23
    line_of_mode 10, 11, 0, 1, 24, 25
    line_of_mode 12, 13, 0, 1, 26, 27
    line_of_mode 14, 15, 0, 1, 28, 29
    vldr    s2, [r0, #68]
    vldr    s3, [r0, #72]
    vldr    s4, [r0, #-8]
    vldr    s5, [r0, #-4]
    vmul.f32 s6, s0, s2
    vmul.f32 s7, s1, s3
    vmul.f32 s8, s0, s3
    vmul.f32 s9, s1, s2
    vsub.f32 s6, s6, s7
    vadd.f32 s8, s8, s9
    subs    r4, r4, #1
    vadd.f32 s4, s4, s6
    vadd.f32 s5, s5, s8
    vstr    s4, [r0, #-8]
    vstr    s5, [r0, #-4]
    add     r0, r0, #MODE
    bne     2b
    add     r3, r3, #8
3:  cmp     r1, r2
    bhs     4f
    ldrh    r4, [r1]
    add     r1, r1, #4
    mla     lr, r4, r6, r0
    cmp     lr, r12
    bhi     4f                          @ its modes are not all there
    cmp     r4, #0
    bne     1b
    add     r3, r3, #8
    b       3b
4:  vpop    {s16-s31}
    pop     {r4-r6, pc}
    .size   malleus_frames_gather, . - malleus_frames_gather

@ --------------------------------------------------------------------------------------------------
@ Lines of a force without the window from seven with it: 28 cycles a line.
@ Registers: r0 the next line, r1 out, r2 lines left, r3 numbers; s0-s3 numbers of the lines 0 to 3,
@ s4-s17 seven lines, the first of which makes room for the next; s20-s27 sums.
    .macro unwindow_line a0 a1 b0 b1 c0 c1 d0 d1 e0 e1 f0 f1 g0 g1
    vadd.f32 s24, s\c0, s\e0
    vadd.f32 s25, s\c1, s\e1
    vadd.f32 s22, s\b0, s\f0
    vadd.f32 s23, s\b1, s\f1
    vadd.f32 s20, s\a0, s\g0
    vadd.f32 s21, s\a1, s\g1
    vmul.f32 s26, s\d0, s0
    vmul.f32 s27, s\d1, s0
    vmul.f32 s24, s24, s1
    vmul.f32 s25, s25, s1
    vmul.f32 s22, s22, s2
    vmul.f32 s23, s23, s2
    vmul.f32 s20, s20, s3
    vmul.f32 s21, s21, s3
    vadd.f32 s26, s26, s24
    vadd.f32 s27, s27, s25
    vadd.f32 s26, s26, s22
    vadd.f32 s27, s27, s23
    vadd.f32 s26, s26, s20
    vadd.f32 s27, s27, s21
    vstm    r1!, {s26, s27}
    subs    r2, r2, #1
    beq     2f
    vldm    r0!, {s\a0, s\a1}
    .endm

    .p2align 4
    .global malleus_frames_unwindow
    .type   malleus_frames_unwindow, %function
malleus_frames_unwindow:
    vpush   {s16-s27}
    vldm    r3, {s0-s3}
    vldm    r0!, {s4-s17}
1:
    unwindow_line 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16, 17
    unwindow_line 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16, 17, 4, 5
    unwindow_line 8, 9, 10, 11, 12, 13, 14, 15, 16, 17, 4, 5, 6, 7
    unwindow_line 10, 11, 12, 13, 14, 15, 16, 17, 4, 5, 6, 7, 8, 9
    unwindow_line 12, 13, 14, 15, 16, 17, 4, 5, 6, 7, 8, 9, 10, 11
    unwindow_line 14, 15, 16, 17, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13
    unwindow_line 16, 17, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15
    b       1b
2:  vpop    {s16-s27}
    bx      lr
    .size   malleus_frames_unwindow, . - malleus_frames_unwindow

@ --------------------------------------------------------------------------------------------------
@ Loads the window at frame r2 into s2. r1 is the window by the distance from the middle.
    .macro load_window
    subs    r5, r2, #128
    it      mi
    rsbmi   r5, r5, #0
    add     r5, r1, r5, lsl #2
    vldr    s2, [r5]
    .endm

@ Rounds left s0 and right s1, and adds them to the frame of the output. r9 is half as a float.
    .macro play_frame
    vmov    r4, r5, s0, s1
    and     r4, r4, #0x80000000
    and     r5, r5, #0x80000000
    orr     r4, r4, r9                  @ half with the sign of the sample
    orr     r5, r5, r9
    vmov    s2, s3, r4, r5
    vadd.f32 s0, s0, s2
    vadd.f32 s1, s1, s3
    vcvt.s32.f32 s0, s0
    vcvt.s32.f32 s1, s1
    ldrd    r6, r7, [r3]
    vmov    r4, r5, s0, s1
    qadd    r6, r6, r4
    qadd    r7, r7, r5
    strd    r6, r7, [r3], #8
    add     r2, r2, #1
    subs    r8, r8, #1
    .endm

@ --------------------------------------------------------------------------------------------------
@ Frames of a block. 45 cycles each.
@ Registers: r0 transform, r1 window, r2 frame, r3 output, r8 frames left, r9 half as a float.
    .p2align 4
    .global malleus_frames_play
    .type   malleus_frames_play, %function
malleus_frames_play:
    push    {r4-r9, lr}
    ldr     r8, [sp, #28]
    mov     r9, #0x3f000000
1:  add     r4, r2, #384                @ 2N - N/2
    rbit    r4, r4
    lsr     r4, r4, #23
    add     r4, r0, r4, lsl #3
    vldr    s0, [r4]
    vldr    s1, [r4, #4]
    load_window
    vmul.f32 s0, s0, s2
    vmul.f32 s1, s1, s2
    play_frame
    bne     1b
    pop     {r4-r9, pc}
    .size   malleus_frames_play, . - malleus_frames_play

@ --------------------------------------------------------------------------------------------------
@ Frames of a block of one bank. 48 cycles each.
@ Registers: as above, and s4, s5 the gains of left and right.
    .p2align 4
    .global malleus_frames_play_lone
    .type   malleus_frames_play_lone, %function
malleus_frames_play_lone:
    push    {r4-r9, lr}
    ldrd    r8, r4, [sp, #28]
    vldr    s4, [r4]
    vldr    s5, [r4, #4]
    mov     r9, #0x3f000000
1:  add     r4, r2, #384                @ 2N - N/2
    ubfx    r4, r4, #1, #8              @ two frames a pair
    rbit    r4, r4
    lsr     r4, r4, #24
    and     r5, r2, #1
    orr     r4, r5, r4, lsl #1
    add     r4, r0, r4, lsl #2
    vldr    s0, [r4]
    load_window
    vmul.f32 s0, s0, s2
    vmul.f32 s1, s0, s5
    vmul.f32 s0, s0, s4
    play_frame
    bne     1b
    pop     {r4-r9, pc}
    .size   malleus_frames_play_lone, . - malleus_frames_play_lone
