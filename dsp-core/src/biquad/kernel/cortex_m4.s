@ The hot loops of a bank of biquads for a Cortex-M4F: all pairs of sections over one run of frames.
@
@ malleus_biquads(call) -> 0; 1: a pair asks to be settled; 2: an input was too large, and nothing
@ has been done
@
@ The bits are those of portable.rs. Layouts (checked at compile time in cortex_m4.rs):
@   call    pairs 0, end 4, frames 8, input 12 (null: none), left 16, right 20, bits 24, direct 28,
@           out 32, room 36, odd 40, used 44, allowance 48
@   pair    two sections (u 0, v 4, turn 8, damp 12, gain u 16, gain v 20; 24 bytes each), scales
@           48, 52, couple 56, chain 60, low 64, span 68, kind 72, shift 73, asks 74; BQ_PAIR bytes
@   kind    bits 0-1 form, bits 2-3 wiring (single, parallel, coupled, chain), bit 4 skipped, bit 5
@           mirrored
@
@ Where things are while a loop runs:
@   sp      the mix of 32 frames at 0..127, the input at 128..255, what a pair hands on at 256..383,
@           all backward in time (frame i at 124 - 4i), as in
@           the modal bank's kernel. The reason is the same: twelve registers hold the two
@           sections, and none is left for a pointer
@   r1-r6, r7-r12 the sections; r0 a word of the buffers; lr the scale
@   s0      pair    s1 end    s2 answer    s3 frames    s4, s5 scales    s6 couple    s7 chain
@   s8      sp behind a short run    s9 sp at rest
@   s10     whether signs have been changed    s11 which loops: 0 driven, 16 free, 32 short
@   s12     sp behind a pass of a tick
@
@ Optimisation log (nominal cycles a section and frame, 64 and 16 sections, all included: cargo test
@ -p host-tests --test on_chip biquads -- --nocapture):
@   14.4   26       a section at a time; input, level and mix in Rust
@   10.7   13.0     two sections at a time, as the modal bank does; a pair shares its exponent, so
@                   that one scale stays in a register
@   10.4   12.6     signs changed in place, unrolled; what goes straight through begins the mix
    .syntax unified
    .thumb
    .fpu fpv4-sp-d16
    .section .text.malleus_biquads,"ax",%progbits

    .equ BQ_X, 128
    .equ BQ_CHAIN, 256
    .equ BQ_CALL, 384
    .equ BQ_LOCALS, 392

@ u -= e v; v += e u (form 0) or v += u << k (1: k = 1; 2 and 3: k = 2); u -= delta u, or
@ u = (1 - delta) u (form 3)
    .macro bq_step form u v turn damp
    smmlsr  \u, \turn, \v, \u
    .if \form == 0
    smmlar  \v, \turn, \u, \v
    .elseif \form == 1
    add     \v, \v, \u, lsl #1
    .else
    add     \v, \v, \u, lsl #2
    .endif
    .if \form == 3
    lsl     \u, \u, #1
    smmulr  \u, \u, \damp
    .else
    smmlsr  \u, \damp, \u, \u
    .endif
    .endm

    .macro bq_inject_two
    smmlar  r1, r5, r0, r1
    smmlar  r2, r6, r0, r2
    smmlar  r7, r11, r0, r7
    smmlar  r8, r12, r0, r8
    .endm

@ --------------------------------------------------------------------------------------------------
@ Driven, side by side: 2 load + 2 mix + 1 store + 6 step + 2 load + 4 inject = 17 cycles a frame,
@ 8.5 a section.
    .macro bq_driven_parallel_frame form at
    ldr     r0, [sp, #\at]
    smmlar  r0, r2, lr, r0
    smmlar  r0, r8, lr, r0
    str     r0, [sp, #\at]
    bq_step \form, r1, r2, r3, r4
    bq_step \form, r7, r8, r9, r10
    ldr     r0, [sp, #\at + BQ_X]
    bq_inject_two
    .endm

@ Driven, one behind the other: 18 cycles.
    .macro bq_driven_coupled_frame form at
    ldr     r0, [sp, #\at]
    smmlar  r0, r8, lr, r0
    str     r0, [sp, #\at]
    bq_step \form, r7, r8, r9, r10
    vmov    r0, s6
    smmlar  r7, r2, r0, r7
    bq_step \form, r1, r2, r3, r4
    ldr     r0, [sp, #\at + BQ_X]
    bq_inject_two
    .endm

@ Two sections of the form of low frequencies, 16 frames a pass; those of the other forms, 8 frames
@ a pass, which takes half a cycle a frame more (counted from the code) and half of the flash.
    .macro bq_driven_two wiring form
    .p2align 4
bq_driven_\wiring\()_\form:
    ldm     r0, {r1-r12}
    vmov    lr, s5
    .if \form == 0
    adds    r0, #0                      @ clears carry, which the multiplies leave alone: this is the first half
    b       1f
2:  subs.w  sp, sp, #64                 @ sets carry: this is the second half
1:  .irp    at, 124, 120, 116, 112, 108, 104, 100, 96, 92, 88, 84, 80, 76, 72, 68, 64
    bq_driven_\wiring\()_frame \form, \at
    .endr
    bcc     2b
    add     sp, #64
    .else
    sub     r0, sp, #128
    vmov    s12, r0
1:  .irp    at, 124, 120, 116, 112, 108, 104, 100, 96
    bq_driven_\wiring\()_frame \form, \at
    .endr
    vmov    r0, s12
    sub     sp, #32
    cmp     sp, r0
    bne     1b
    add     sp, #128
    .endif
    b       bq_after
    .endm

@ --------------------------------------------------------------------------------------------------
@ Driven, alone, two frames at once: 9.5 cycles a frame.
@ Registers: r1-r6 section; r7, r8 inputs; r9, r10 sums; r12 passes of eight frames; lr scale.
    .macro bq_driven_single_frames form at
    ldr     r9, [sp, #\at]
    ldr     r10, [sp, #\at - 4]
    ldr     r7, [sp, #\at + BQ_X]
    ldr     r8, [sp, #\at + BQ_X - 4]
    smmlar  r9, r2, lr, r9
    bq_step \form, r1, r2, r3, r4
    smmlar  r1, r5, r7, r1
    smmlar  r2, r6, r7, r2
    smmlar  r10, r2, lr, r10
    bq_step \form, r1, r2, r3, r4
    smmlar  r1, r5, r8, r1
    smmlar  r2, r6, r8, r2
    str     r9, [sp, #\at]
    str     r10, [sp, #\at - 4]
    .endm

    .macro bq_driven_single form
    .p2align 2
bq_driven_single_\form:
    ldm     r0, {r1-r6}
    vmov    lr, s5
    mov     r12, #4
1:  .irp    at, 124, 116, 108, 100
    bq_driven_single_frames \form, \at
    .endr
    subs    r12, #1
    sub     sp, #32
    bne     1b
    b       bq_after_single
    .endm

@ --------------------------------------------------------------------------------------------------
@ Free: nothing comes in. Two sections and two sums: 10.5 cycles a frame. Registers: r5, r6 sums;
@ r11 couple; r12 passes of eight frames; lr scale.
    .macro bq_free_parallel_frame form sum
    smmlar  \sum, r2, lr, \sum
    smmlar  \sum, r8, lr, \sum
    bq_step \form, r7, r8, r9, r10
    bq_step \form, r1, r2, r3, r4
    .endm

    .macro bq_free_coupled_frame form sum
    smmlar  \sum, r8, lr, \sum
    bq_step \form, r7, r8, r9, r10
    smmlar  r7, r2, r11, r7
    bq_step \form, r1, r2, r3, r4
    .endm

    .macro bq_free_two_frames wiring form at
    ldr     r5, [sp, #\at]
    ldr     r6, [sp, #\at - 4]
    bq_free_\wiring\()_frame \form, r5
    bq_free_\wiring\()_frame \form, r6
    str     r5, [sp, #\at]
    str     r6, [sp, #\at - 4]
    .endm

    .macro bq_free_two wiring form
    .p2align 2
bq_free_\wiring\()_\form:
    ldm     r0, {r1-r10}
    vmov    lr, s5
    vmov    r11, s6
    mov     r12, #4
1:  .irp    at, 124, 116, 108, 100
    bq_free_two_frames \wiring, \form, \at
    .endr
    subs    r12, #1
    sub     sp, #32
    bne     1b
    add     sp, #128
    b       bq_after
    .endm

@ Free, alone, four sums at once: 6.25 cycles a frame.
    .macro bq_free_single_frame form sum
    smmlar  \sum, r2, lr, \sum
    bq_step \form, r1, r2, r3, r4
    .endm

    .macro bq_free_single_frames form at
    ldr     r5, [sp, #\at]
    ldr     r6, [sp, #\at - 4]
    ldr     r7, [sp, #\at - 8]
    ldr     r8, [sp, #\at - 12]
    .irp    sum, r5, r6, r7, r8
    bq_free_single_frame \form, \sum
    .endr
    str     r5, [sp, #\at]
    str     r6, [sp, #\at - 4]
    str     r7, [sp, #\at - 8]
    str     r8, [sp, #\at - 12]
    .endm

    .macro bq_free_single form
    .p2align 2
bq_free_single_\form:
    ldm     r0, {r1-r4}
    vmov    lr, s5
    mov     r12, #4
1:  bq_free_single_frames \form, 124
    bq_free_single_frames \form, 108
    subs    r12, #1
    sub     sp, #32
    bne     1b
    b       bq_after_single
    .endm

@ --------------------------------------------------------------------------------------------------
@ Runs that an event, a block's end or a rise of the input cuts short of a tick: two side by side or
@ one alone, driven or not (the input is 0 then), a frame at
@ a time: 23 cycles a frame.
    .macro bq_short form
    .p2align 2
bq_short_\form:
    ldm     r0, {r1-r12}
    vmov    lr, s5
1:  bq_driven_parallel_frame \form, 124
    vmov    r0, s8
    sub     sp, #4
    cmp     sp, r0
    bne     1b
    vmov    r0, s9
    mov     sp, r0
    b       bq_after
    .endm

@ --------------------------------------------------------------------------------------------------
@ Any wiring, any number of frames, driven or not: 33 cycles a frame. For three or four sections
@ behind one another, and for short runs of two.
    .macro bq_any form
    .p2align 2
bq_any_\form:
    ldm     r0, {r1-r12}
1:  ldr     r0, [sp, #124]
    vmov    lr, s4
    smmlar  r0, r2, lr, r0
    vmov    lr, s5
    smmlar  r0, r8, lr, r0
    str     r0, [sp, #124]
    ldr     r0, [sp, #BQ_CHAIN + 124]
    str     r8, [sp, #BQ_CHAIN + 124]
    bq_step \form, r7, r8, r9, r10
    vmov    lr, s6
    smmlar  r7, r2, lr, r7
    bq_step \form, r1, r2, r3, r4
    vmov    lr, s7
    smmlar  r1, r0, lr, r1
    ldr     r0, [sp, #BQ_X + 124]
    bq_inject_two
    vmov    r0, s8
    sub     sp, #4
    cmp     sp, r0
    bne     1b
    vmov    r0, s9
    mov     sp, r0
    b       bq_after
    .endm

@ --------------------------------------------------------------------------------------------------
@ Changes the sign of every other word of a tick from \base on. Registers: r3-r7.
    .macro bq_flip base
    add     r3, sp, #\base
    ldr     r4, [sp, #BQ_CALL]
    ldr     r4, [r4, #40]
    add     r3, r3, r4, lsl #2          @ frame 1 is at 120, frame 31 at 0
    .irp    at, 0, 32, 64, 96
    ldr     r4, [r3, #\at]
    ldr     r5, [r3, #\at + 8]
    ldr     r6, [r3, #\at + 16]
    ldr     r7, [r3, #\at + 24]
    rsbs    r4, r4, #0
    rsbs    r5, r5, #0
    rsbs    r6, r6, #0
    rsbs    r7, r7, #0
    str     r4, [r3, #\at]
    str     r5, [r3, #\at + 8]
    str     r6, [r3, #\at + 16]
    str     r7, [r3, #\at + 24]
    .endr
    .endm

@ The input, four frames a pass: r4-r7 from the last to the first; r8 what they have or'ed, r2 their
@ words' sizes, r0 what goes straight through.
    .macro bq_four_inputs shift by
1:  ldr     r7, [r3]
    ldr     r6, [r3, #4]
    ldr     r5, [r3, #8]
    ldr     r4, [r3, #12]
    adds    r3, #16
    .irp    x, r4, r5, r6, r7
    eor     r1, \x, \x, asr #31
    orr     r8, r8, r1
    \shift  \x, \x, \by
    eor     r1, \x, \x, asr #31
    qadd    r2, r2, r1
    .endr
    stmdb   r12!, {r4-r7}
    .irp    x, r4, r5, r6, r7
    smmulr  \x, \x, r0
    .endr
    stmdb   lr!, {r4-r7}
    subs    r11, #4
    bhs     1b
    .endm

    .p2align 2
    .global malleus_biquads
    .type   malleus_biquads, %function
    .thumb_func
malleus_biquads:
    push    {r4-r11, lr}
    sub     sp, #BQ_LOCALS
    str     r0, [sp, #BQ_CALL]
    add     r12, sp, #BQ_X + 128
    add     lr, sp, #128
    mov     r5, sp
    vmov    s9, r5
    vldmia  r0, {s0, s1}
    mov     r8, #0
    vmov    s2, r8
    vmov    s10, r8
    ldr     r11, [r0, #8]
    ldr     r3, [r0, #12]
    sub     r4, r5, r11, lsl #2
    vmov    s8, r4
    cmp     r3, #0
    beq     bq_no_input
    ldr     r9, [r0, #16]
    ldr     r10, [r0, #20]
    ldr     r0, [r0, #28]
    mov     r2, #0
    subs    r11, #4
    blo     3f
    cmp     r10, #1
    bhi     2f
    beq     3f                          @ one frame a pass: a multiplier of 2^31 is none
    bq_four_inputs lsl, r9
    b       3f
2:  mov     r9, #1
    ror     r9, r9, r10                 @ 2^(32 - right): a multiplication shifts right and rounds
    bq_four_inputs smmulr, r9
    mov     r9, #0
3:  adds    r11, #4
    beq     5f
4:  ldr     r7, [r3], #4
    eor     r1, r7, r7, asr #31
    orr     r8, r8, r1
    lsl     r7, r7, r9
    adds    r7, #0                      @ clears carry, which a shift by 0 leaves alone
    asrs    r7, r7, r10
    adc     r7, r7, #0
    eor     r1, r7, r7, asr #31
    qadd    r2, r2, r1
    str     r7, [r12, #-4]!
    smmulr  r7, r7, r0
    str     r7, [lr, #-4]!
    subs    r11, #1
    bne     4b
5:  ldr     r0, [sp, #BQ_CALL]
    str     r2, [r0, #44]
    ldr     r1, [r0, #24]
    ldr     r3, [r0, #48]
    lsrs    r8, r8, r1
    bne     bq_refused
    cmp     r2, r3
    bhi     bq_refused
    movs    r4, #0
    b       bq_begin
bq_refused:
    add     sp, #BQ_LOCALS
    movs    r0, #2
    pop     {r4-r11, pc}
bq_no_input:
    str     r3, [r0, #44]
    movs    r1, #0
    movs    r2, #0
    movs    r4, #0
    movs    r5, #0
    movs    r6, #0
    movs    r7, #0
    mov     r9, #0
    .rept   8
    stmdb   r12!, {r1-r9}
    .endr
    movs    r4, #16
bq_begin:
    ldr     r1, [r0, #8]
    cmp     r1, #32
    it      ne
    movne   r4, #32
    vmov    s11, r4

@ The walk.
bq_next:
    vmov    r0, s0
    vmov    r1, s1
bq_next_at:
    cmp     r0, r1
    bhs     bq_finish
    ldrb    r2, [r0, #72]
    tst     r2, #16
    bne     bq_skip
    tst     r2, #32
    bne     bq_mirrored
bq_dispatch:
    vmov    r4, s11
    add     r3, r0, #48
    vldmia  r3, {s4-s7}
    and     r2, r2, #15
    add     r2, r2, r4
    tbh     [pc, r2, lsl #1]
9:  .irp    loop, bq_driven_single, bq_driven_parallel, bq_driven_coupled, bq_any, bq_free_single, bq_free_parallel, bq_free_coupled, bq_any, bq_short, bq_short, bq_any, bq_any
    .irp    form, 0, 1, 2, 3
    .2byte  (\loop\()_\form - 9b) / 2
    .endr
    .endr
bq_skip:
    add     r0, #BQ_PAIR
    vmov    s0, r0
    b       bq_next_at
bq_mirrored:
    vmov    r3, s10
    cmp     r3, #0
    bne     bq_dispatch
    vmov    s10, r2
    bq_flip BQ_X
    bq_flip 0
    b       bq_dispatch

bq_after_single:
    movs    r7, #0
    mov     r8, #0
    add     sp, #128
bq_after:                               @ r1, r2 and r7, r8: the states
    vmov    r0, s0
    str     r1, [r0]
    str     r2, [r0, #4]
    str     r7, [r0, #24]
    str     r8, [r0, #28]
    eor     r1, r1, r1, asr #31
    eor     r7, r7, r7, asr #31
    eor     r2, r2, r2, asr #31
    eor     r8, r8, r8, asr #31
    ldr     r4, [r0, #64]
    ldr     r5, [r0, #68]
    ldrb    r3, [r0, #73]
    orrs    r1, r7
    orr     r2, r2, r8
    lsls    r1, r3
    orrs    r2, r1
    subs    r2, r2, r4
    movs    r3, #0
    cmp     r2, r5
    bhs     bq_asks
    strb    r3, [r0, #74]
    add     r0, #BQ_PAIR
    vmov    s0, r0
    vmov    r1, s1
    b       bq_next_at
bq_asks:
    movs    r3, #1
    vmov    s2, r3
    strb    r3, [r0, #74]
    add     r0, #BQ_PAIR
    vmov    s0, r0
    b       bq_next

@ A word of the mix to the bus, saturating: lr 0x7fffffff, r10 room.
    .macro bq_saturate word
    lsl     r5, \word, r10
    asr     r6, r5, r10
    cmp     r6, \word
    itee    eq
    moveq   \word, r5
    asrne   \word, \word, #31
    eorne   \word, \word, lr
    .endm

bq_finish:
    vmov    r3, s10
    cmp     r3, #0
    bne     bq_unflip
bq_to_bus:
    ldr     r1, [sp, #BQ_CALL]
    ldr     r0, [r1, #32]
    ldr     r10, [r1, #36]
    ldr     r11, [r1, #8]
    rsb     r9, r10, #31
    add     r12, sp, #128
    mvn     lr, #0x80000000
    subs    r11, #4
    blo     4f
@ Four frames: r4 the first of them.
2:  ldmdb   r12!, {r1-r4}
    eor     r5, r1, r1, asr #31
    eor     r6, r2, r2, asr #31
    eor     r7, r3, r3, asr #31
    eor     r8, r4, r4, asr #31
    orrs    r5, r6
    orrs    r5, r7
    orr     r5, r5, r8
    lsrs    r5, r9
    bne     6f
    lsls    r1, r10
    lsls    r2, r10
    lsls    r3, r10
    lsls    r4, r10
3:  ldr     r5, [r0]
    ldr     r6, [r0, #4]
    ldr     r7, [r0, #8]
    ldr     r8, [r0, #12]
    qadd    r5, r5, r4
    qadd    r6, r6, r3
    qadd    r7, r7, r2
    qadd    r8, r8, r1
    stm     r0!, {r5-r8}
    subs    r11, #4
    bhs     2b
4:  adds    r11, #4
    beq     5f
7:  ldr     r1, [r12, #-4]!
    bq_saturate r1
    ldr     r5, [r0]
    qadd    r5, r5, r1
    str     r5, [r0], #4
    subs    r11, #1
    bne     7b
5:  add     sp, #BQ_LOCALS
    vmov    r0, s2
    pop     {r4-r11, pc}
6:  bq_saturate r1
    bq_saturate r2
    bq_saturate r3
    bq_saturate r4
    b       3b
bq_unflip:
    bq_flip 0
    b       bq_to_bus

    .irp    form, 0, 1, 2, 3            @ behind the table of their distances, which count forward
    bq_driven_two parallel, \form
    bq_driven_two coupled, \form
    bq_driven_single \form
    bq_free_two parallel, \form
    bq_free_two coupled, \form
    bq_free_single \form
    bq_short \form
    bq_any \form
    .endr
    .size   malleus_biquads, . - malleus_biquads
