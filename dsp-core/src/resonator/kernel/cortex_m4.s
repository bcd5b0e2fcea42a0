@ The hot loops for a Cortex-M4F: all register groups of a bank over one run of frames.
@
@ malleus_kernel_free(call)     modes that ring on: step, mix
@ malleus_kernel_driven(call)   modes under a force: step, inject, mix
@
@ The bits are those of portable.rs. Layouts (checked at compile time in cortex_m4.rs):
@   call    modes 0, groups 4, groups_end 8, mix 12, force 16, frames 20, skip 24, add 28, stereo 32
@           (null: the mix is written to `mix`), left 36, right 40, shift 44, doublings 48
@   mode    u 0, v 4, delta 8, epsilon 12, gain_u 16, gain_v 20; 24 bytes
@   group   free kind 0, driven kind 1, gain shift 2, count 3, mix scale 4; 24 bytes, of which eight
@           are read
@   kind    bits 0-1 form, bit 2 gain and phase, bit 5 shed, bit 6 not full, bit 7 ringing
@
@ Where things are while a kernel runs:
@   sp      the mix of 32 frames at 0..127, the force at 128..255, both backward in time: frame i at
@           124 - 4i
@   s0, s1  the set's modes, the next group
@   s2, s3  end of the groups, place where the group's last set begins, + 1
@   s4, s5  mix scale, gain shift
@   s6, s7  sp at rest, sp behind the last frame of a short run
@   s8      sets of a group that follow its leftover modes (0 or 1)
@
@ Why the buffers are addressed off sp: three modes take twelve registers, the sum and the mix scale
@ two; no register is left for a pointer. sp only ever moves down from the buffers, so that an
@ interrupt, which pushes below sp, never touches them.
@ Why backward in time: then moving on in time is moving sp down.
@ Why the carry flag: the multiplies leave flags alone, so the flag carries "first half of the tick"
@ (clear) through 16 frames for nothing; the instruction that moves sp sets it.

    .syntax unified
    .thumb
    .fpu fpv4-sp-d16
    .section .text.malleus_kernel,"ax",%progbits

    .equ FREE, 0
    .equ DRIVEN, 1
    .equ OUT, 256
    .equ SKIP, 260
    .equ FRAMES, 264
    .equ CALL, 268
    .equ LOCALS, 272
    .equ GROUP, 24

@ u -= delta u; u -= epsilon v; v += epsilon u (form 0), v += u << form (forms 1 and 2)
    .macro step form u v delta epsilon
    smmlsr  \u, \delta, \u, \u
    smmlsr  \u, \epsilon, \v, \u
    .if \form == 0
    smmlar  \v, \epsilon, \u, \v
    .else
    add     \v, \v, \u, lsl #\form
    .endif
    .endm

@ --------------------------------------------------------------------------------------------------
@ Free, three modes in registers. Per frame 9 step + 3 mix + 2 load + 1 store = 15 cycles, 5.0 a
@ mode.
@
@ Optimisation log (nominal cycles a mode and sample of a bank of 240 modes, this file alone: cargo
@ test -p host-tests --test virtual_costs -- --nocapture; whole blocks: cargo bench -p host-tests
@ --bench run_time_vs_error):
@   18.6   plain Rust with i64: LLVM spills the rounded 64-bit sums
@    5.45  three modes in registers, all groups of a bank in one call; the next group is looked up
@          here, and only a change of form leaves the loop
@    Tried: sums in s-registers (14 cycles a frame instead of 15), but the registers are named in
@    the code, so that the loop must hold 32 frames (1.8 KB, beyond the flash cache) or halve its
@    runs, which costs more in loads than it saves.
@ Registers: r0 sum, r1-r4, r5-r8, r9-r12 three modes (u, v, delta, epsilon), lr mix scale.
    .macro load_three
    vmov    s0, r0
    ldr     r1, [r0]
    ldr     r2, [r0, #4]
    ldr     r3, [r0, #8]
    ldr     r4, [r0, #12]
    ldr     r5, [r0, #24]
    ldr     r6, [r0, #28]
    ldr     r7, [r0, #32]
    ldr     r8, [r0, #36]
    ldr     r9, [r0, #48]
    ldr     r10, [r0, #52]
    ldr     r11, [r0, #56]
    ldr     r12, [r0, #60]
    .endm

    .macro store_three
    str     r2, [r0, #4]
    str     r5, [r0, #24]
    str     r6, [r0, #28]
    str     r9, [r0, #48]
    str     r10, [r0, #52]
    str     r1, [r0], #72
    .endm

    .macro free_three_frame form at
    step    \form, r1, r2, r3, r4
    step    \form, r5, r6, r7, r8
    step    \form, r9, r10, r11, r12
    ldr     r0, [sp, #\at]
    smmlar  r0, r2, lr, r0
    smmlar  r0, r6, lr, r0
    smmlar  r0, r10, lr, r0
    str     r0, [sp, #\at]
    .endm

    .macro free_three form
    .p2align 4
    .type   free_three_\form, %function
free_three_\form:                       @ r0 modes, lr scale, s3 limit, carry clear
    load_three
    b       1f
2:  subs.w  sp, sp, #64                 @ sets carry: this is the second half
1:  .irp    at, 124, 120, 116, 112, 108, 104, 100, 96, 92, 88, 84, 80, 76, 72, 68, 64
    free_three_frame \form, \at
    .endr
    bcc     2b
    vmov    r0, s0
    add     sp, #64
    store_three
    vmov    r1, s3
    cmp     r0, r1
    bcs     3f
    load_three                          @ carry is clear: r0 < r1
    b       1b
3:  vmov    r1, s1                      @ the next group, if it is full and of this form
    vmov    r3, s2
    cmp     r1, r3
    beq     finish
    ldrb    r3, [r1]
    ldr     lr, [r1, #4]
    cmp     r3, #\form + 128
    bne     next_free
    add     r2, r0, #73
    vmov    s3, r2
    adds    r1, #GROUP                    @ clears carry
    vmov    s1, r1
    load_three
    b       1b
    .size   free_three_\form, . - free_three_\form
    .endm

@ --------------------------------------------------------------------------------------------------
@ Free, the one or two modes by which a group's count exceeds a multiple of three.
@ Two modes leave room for two sums at once (10.5 cycles a frame, 5.25 a mode), one mode for four
@ (6.25).
@ Registers: r1-r4, r5-r8 modes; sums r9, r10 or r5-r8; r12 passes of eight frames; lr mix scale.
    .macro free_two_frames form at
    ldr     r9, [sp, #\at]
    ldr     r10, [sp, #\at - 4]
    step    \form, r1, r2, r3, r4
    step    \form, r5, r6, r7, r8
    smmlar  r9, r2, lr, r9
    smmlar  r9, r6, lr, r9
    step    \form, r1, r2, r3, r4
    step    \form, r5, r6, r7, r8
    smmlar  r10, r2, lr, r10
    smmlar  r10, r6, lr, r10
    str     r9, [sp, #\at]
    str     r10, [sp, #\at - 4]
    .endm

    .macro free_two form
    .p2align 2
    .type   free_two_\form, %function
free_two_\form:
    ldr     r1, [r0]
    ldr     r2, [r0, #4]
    ldr     r3, [r0, #8]
    ldr     r4, [r0, #12]
    ldr     r5, [r0, #24]
    ldr     r6, [r0, #28]
    ldr     r7, [r0, #32]
    ldr     r8, [r0, #36]
    mov     r12, #4
1:  .irp    at, 124, 116, 108, 100
    free_two_frames \form, \at
    .endr
    subs    r12, #1
    sub     sp, #32
    bne     1b
    add     sp, #128
    str     r2, [r0, #4]
    str     r5, [r0, #24]
    str     r6, [r0, #28]
    str     r1, [r0], #48
    b       after_leftover_free
    .size   free_two_\form, . - free_two_\form
    .endm

    .macro free_one_frame form sum
    step    \form, r1, r2, r3, r4
    smmlar  \sum, r2, lr, \sum
    .endm

    .macro free_one_frames form at
    ldr     r5, [sp, #\at]
    ldr     r6, [sp, #\at - 4]
    ldr     r7, [sp, #\at - 8]
    ldr     r8, [sp, #\at - 12]
    .irp    sum, r5, r6, r7, r8
    free_one_frame \form, \sum
    .endr
    str     r5, [sp, #\at]
    str     r6, [sp, #\at - 4]
    str     r7, [sp, #\at - 8]
    str     r8, [sp, #\at - 12]
    .endm

    .macro free_one form
    .p2align 2
    .type   free_one_\form, %function
free_one_\form:
    ldm     r0, {r1-r4}
    mov     r12, #4
1:  free_one_frames \form, 124
    free_one_frames \form, 108
    subs    r12, #1
    sub     sp, #32
    bne     1b
    add     sp, #128
    str     r2, [r0, #4]
    str     r1, [r0], #24
    b       after_leftover_free
    .size   free_one_\form, . - free_one_\form
    .endm

@ Free, runs that an event or a block's end cuts short of a tick: a frame at a time, three modes or
@ one in registers.
    .macro short_free form
    .p2align 2
    .type   short_free_three_\form, %function
short_free_three_\form:
    load_three
1:  free_three_frame \form, 124
    vmov    r0, s7
    sub     sp, #4
    cmp     sp, r0
    bne     1b
    vmov    r0, s6
    mov     sp, r0
    vmov    r0, s0
    store_three
    vmov    r1, s3
    cmp     r0, r1
    bcc     short_free_three_\form
    b       next_short_free
    .size   short_free_three_\form, . - short_free_three_\form
    .type   short_free_one_\form, %function
short_free_one_\form:
    ldm     r0, {r1-r4}
    vmov    r6, s7
1:  ldr     r5, [sp, #124]
    free_one_frame \form, r5
    str     r5, [sp, #124]
    sub     sp, #4
    cmp     sp, r6
    bne     1b
    vmov    r5, s6
    mov     sp, r5
    str     r2, [r0, #4]
    str     r1, [r0], #24
    b       after_leftover_short_free
    .size   short_free_one_\form, . - short_free_one_\form
    .endm

@ --------------------------------------------------------------------------------------------------
@ Driven with one gain, two modes in registers. Per frame 6 step + 2 inject + 2 mix + 3 for two
@ loads + 1 store = 14 cycles, 7.0 a mode.
@
@ Optimisation log (nominal cycles a mode and sample, a bank of 240 modes):
@    9.2   the same loop with gain and phase, phase 0
@    7.65  the gain into v left out: the register that it frees holds the sum, whose load then pairs
@          with the force's
@ Registers: r0 force, r6 sum, r1-r5, r7-r11 two modes (u, v, delta, epsilon, gain), r12 gain shift,
@ lr mix scale.
    .macro driven_gain_frame form at
    step    \form, r1, r2, r3, r4
    step    \form, r7, r8, r9, r10
    ldr     r0, [sp, #\at + 128]
    ldr     r6, [sp, #\at]
    smmlar  r1, r5, r0, r1
    smmlar  r7, r11, r0, r7
    smmlar  r6, r2, lr, r6
    smmlar  r6, r8, lr, r6
    str     r6, [sp, #\at]
    .endm

    .macro load_two_gain
    vmov    s0, r0
    ldm     r0, {r1-r11}
    vmov    r12, s5
    asr.w   r5, r5, r12
    asr.w   r11, r11, r12
    .endm

@ --------------------------------------------------------------------------------------------------
@ Driven with gain and phase, two modes in registers. Per frame 6 step + 4 inject + 2 mix + 4 for
@ two loads + 1 store = 17 cycles, 8.5 a mode.
@
@ Optimisation log (nominal cycles a mode and sample, a bank of 240 modes):
@    9.2   twelve registers of modes; force and sum share r0, one after the other
@    Tried: force and sum apart, the mix scale from an s-register in each frame: the same 17 cycles.
@    Every word that does not stay in a core register costs one cycle a frame, wherever it is.
@    Tried: force and sums in s-registers: 15 cycles a frame, but 960 bytes for 16 frames.
@ Registers: r0 force, then sum; r1-r6, r7-r12 two modes (u, v, delta, epsilon, gain u, gain v); lr
@ gain shift while loading, then mix scale.
    .macro driven_phase_frame form at
    step    \form, r1, r2, r3, r4
    step    \form, r7, r8, r9, r10
    ldr     r0, [sp, #\at + 128]
    smmlar  r1, r5, r0, r1
    smmlar  r2, r6, r0, r2
    smmlar  r7, r11, r0, r7
    smmlar  r8, r12, r0, r8
    ldr     r0, [sp, #\at]
    smmlar  r0, r2, lr, r0
    smmlar  r0, r8, lr, r0
    str     r0, [sp, #\at]
    .endm

    .macro load_two_phase
    vmov    s0, r0
    ldm     r0, {r1-r12}
    vmov    lr, s5
    asr.w   r5, r5, lr
    asr.w   r6, r6, lr
    asr.w   r11, r11, lr
    asr.w   r12, r12, lr
    vmov    lr, s4
    .endm

    .macro store_two
    str     r2, [r0, #4]
    str     r7, [r0, #24]
    str     r8, [r0, #28]
    str     r1, [r0], #48
    .endm

    .macro driven_two name form kind
    .p2align 4
    .type   driven_\name\()_\form, %function
driven_\name\()_\form:                  @ r0 modes, lr scale, s3 limit, s4 scale, s5 gain shift, carry clear
    load_two_\name
    b       1f
2:  subs.w  sp, sp, #64                 @ sets carry: this is the second half
1:  .irp    at, 124, 120, 116, 112, 108, 104, 100, 96, 92, 88, 84, 80, 76, 72, 68, 64
    driven_\name\()_frame \form, \at
    .endr
    bcc     2b
    vmov    r0, s0
    add     sp, #64
    store_two
    vmov    r1, s3
    cmp     r0, r1
    bcs     3f
    load_two_\name                      @ carry is clear: r0 < r1
    b       1b
3:  vmov    r1, s1                      @ the next group, if it is full and of this kind
    vmov    r3, s2
    cmp     r1, r3
    beq     finish
    ldrb    r3, [r1, #1]
    ldr     lr, [r1, #4]
    ldrb    r4, [r1, #2]
    cmp     r3, #\kind + 128
    bne     next_driven
    vmov    s4, lr
    vmov    s5, r4
    add     r2, r0, #97
    vmov    s3, r2
    adds    r1, #GROUP                    @ clears carry
    vmov    s1, r1
    load_two_\name
    b       1b
    .size   driven_\name\()_\form, . - driven_\name\()_\form
    .endm

@ Driven, the one mode by which a group's count is odd; with gain and phase, which is right for
@ both. Two frames at once: 9.5 cycles.
@ Registers: r1-r6 mode; r7, r8 forces; r9, r10 sums; r12 passes of eight frames; lr mix scale.
    .macro driven_one_frame form force sum
    step    \form, r1, r2, r3, r4
    smmlar  r1, r5, \force, r1
    smmlar  r2, r6, \force, r2
    smmlar  \sum, r2, lr, \sum
    .endm

    .macro driven_one_frames form at
    ldr     r7, [sp, #\at + 128]
    ldr     r8, [sp, #\at + 124]
    ldr     r9, [sp, #\at]
    ldr     r10, [sp, #\at - 4]
    driven_one_frame \form, r7, r9
    driven_one_frame \form, r8, r10
    str     r9, [sp, #\at]
    str     r10, [sp, #\at - 4]
    .endm

    .macro load_one_driven
    ldm     r0, {r1-r6}
    vmov    r12, s5
    asr.w   r5, r5, r12
    asr.w   r6, r6, r12
    .endm

    .macro driven_one form
    .p2align 2
    .type   driven_one_\form, %function
driven_one_\form:
    load_one_driven
    mov     r12, #4
1:  .irp    at, 124, 116, 108, 100
    driven_one_frames \form, \at
    .endr
    subs    r12, #1
    sub     sp, #32
    bne     1b
    add     sp, #128
    str     r2, [r0, #4]
    str     r1, [r0], #24
    b       after_leftover_driven
    .size   driven_one_\form, . - driven_one_\form
    .endm

@ Driven, runs cut short: a frame at a time; with gain and phase, which is right for both.
    .macro short_driven form
    .p2align 2
    .type   short_driven_two_\form, %function
short_driven_two_\form:
    load_two_phase
1:  driven_phase_frame \form, 124
    vmov    r0, s7
    sub     sp, #4
    cmp     sp, r0
    bne     1b
    vmov    r0, s6
    mov     sp, r0
    vmov    r0, s0
    store_two
    vmov    r1, s3
    cmp     r0, r1
    bcc     short_driven_two_\form
    b       next_short_driven
    .size   short_driven_two_\form, . - short_driven_two_\form
    .type   short_driven_one_\form, %function
short_driven_one_\form:
    load_one_driven
    vmov    r8, s7
1:  ldr     r7, [sp, #252]
    ldr     r9, [sp, #124]
    driven_one_frame \form, r7, r9
    str     r9, [sp, #124]
    sub     sp, #4
    cmp     sp, r8
    bne     1b
    vmov    r7, s6
    mov     sp, r7
    str     r2, [r0, #4]
    str     r1, [r0], #24
    b       after_leftover_short_driven
    .size   short_driven_one_\form, . - short_driven_one_\form
    .endm

@ --------------------------------------------------------------------------------------------------
@ The walk: which kernel a group needs. r0 is the group's first mode. Leftover modes of a group go
@ first, so that a set loop ends where the group ends.
    .macro next_group name kind_byte set leftovers
    .p2align 2
    .type   next_\name, %function
next_\name:
    vmov    r1, s1
    vmov    r3, s2
    cmp     r1, r3
    beq     finish
    ldrb    r2, [r1, #\kind_byte]
    ldrb    r4, [r1, #2]
    ldrb    r3, [r1, #3]
    ldr     lr, [r1, #4]
    adds    r1, #GROUP
    vmov    s1, r1
    vmov    s4, lr
    vmov    s5, r4
    add     r4, r3, r3, lsl #1          @ three times the count
    lsls    r5, r2, #25                 @ carry: it rings
    bcs     1f
    ldr     r5, [sp, #SKIP]
    cbz     r5, 1f
    add     r0, r0, r4, lsl #3
    b       next_\name
1:  and     r2, r2, #7
    .if \set == 3
    movs    r5, #0                      @ sets of three, and leftover modes
    subs    r3, #3
    blo     2f
    mov     r5, #1                      @ keeps flags
    beq     5f                          @ exactly one set
    subs    r3, #3
    blo     2f
    movs    r5, #2
    b       5f
2:  vmov    s8, r5
    adds    r3, #3                      @ one or two left over
    b       \leftovers
    .else
    lsrs    r5, r3, #1                  @ sets of two; carry: one left over
    bcc     5f
    vmov    s8, r5
    b       \leftovers
    .endif
    .type   after_leftover_\name, %function
after_leftover_\name:
    vmov    lr, s4
    vmov    r1, s1
    ldrb    r2, [r1, #\kind_byte - GROUP]
    and     r2, r2, #7
    .ifc \leftovers, leftover_short_free
    vmov    r3, s9                      @ one mode at a time
    subs    r3, #1
    bne     leftover_short_free
    .endif
    vmov    r5, s8
    cmp     r5, #0
    beq     next_\name
5:  subs    r5, #1                      @ where the last set begins, + 1
    .if \set == 3
    movs    r4, #72
    .else
    movs    r4, #48
    .endif
    mla     r5, r5, r4, r0
    adds    r5, #1                      @ clears carry
    vmov    s3, r5
    .endm

    .macro by_kind kinds:vararg
    tbh     [pc, r2, lsl #1]
9:  .irp    kind, \kinds
    .2byte  (\kind - 9b) / 2
    .endr
    .endm

@ Saves the call's fields, makes room for the buffers, and clears the mix or takes over what the
@ caller's holds.
    .macro enter
    push    {r4-r11, lr}
    mov     r8, r0
    ldm     r0, {r0-r7}
    sub     sp, #LOCALS
    str     r8, [sp, #CALL]
    str     r5, [sp, #FRAMES]
    vmov    s0, r0
    vmov    s1, r1
    vmov    s2, r2
    str     r3, [sp, #OUT]
    str     r6, [sp, #SKIP]
    mov     r12, sp
    vmov    s6, r12
    sub     r11, r12, r5, lsl #2
    vmov    s7, r11
    cbnz    r7, 1f
    mov     r1, #0
    mov     r2, #0
    mov     r6, #0
    mov     r7, #0
    mov     r8, #0
    mov     r9, #0
    mov     r10, #0
    mov     r11, #0
    stm     r12!, {r1, r2, r6-r11}
    stm     r12!, {r1, r2, r6-r11}
    stm     r12!, {r1, r2, r6-r11}
    stm     r12!, {r1, r2, r6-r11}
    b       2f
1:  ldm     r3!, {r1, r2, r6-r11}
    stm     r12!, {r1, r2, r6-r11}
    ldm     r3!, {r1, r2, r6-r11}
    stm     r12!, {r1, r2, r6-r11}
    ldm     r3!, {r1, r2, r6-r11}
    stm     r12!, {r1, r2, r6-r11}
    ldm     r3!, {r1, r2, r6-r11}
    stm     r12!, {r1, r2, r6-r11}
2:
    .endm

@ --------------------------------------------------------------------------------------------------
    .p2align 2
    .global malleus_kernel_free
    .type   malleus_kernel_free, %function
    .thumb_func
malleus_kernel_free:
    enter
    cmp     r5, #32
    bne     next_short_free
    next_group free, FREE, 3, leftover_free
    by_kind free_three_0, free_three_1, free_three_2
leftover_free:
    cmp     r3, #1
    beq     1f
    by_kind free_two_0, free_two_1, free_two_2
1:  by_kind free_one_0, free_one_1, free_one_2

    next_group short_free, FREE, 3, leftover_short_free
    by_kind short_free_three_0, short_free_three_1, short_free_three_2
leftover_short_free:
    vmov    s9, r3
    by_kind short_free_one_0, short_free_one_1, short_free_one_2

    .irp    form, 0, 1, 2               @ behind the tables of their distances, which count forward
    free_three \form
    free_two \form
    free_one \form
    short_free \form
    .endr

@ Two frames of the mix to stereo: r7 stereo, r8 and r9 mantissas, r10 shift, lr behind the first
@ frame's slot.
    .macro pan_two is_shifted
    ldm     r7, {r0-r3}
    ldr     r5, [lr, #-4]
    ldr     r4, [lr, #-8]!
    .if \is_shifted
    lsl     r5, r5, r10
    lsl     r4, r4, r10
    .endif
    smmulr  r6, r5, r8
    smmulr  r5, r5, r9
    smmulr  r11, r4, r8
    smmulr  r4, r4, r9
    qadd    r0, r0, r6
    qadd    r1, r1, r5
    qadd    r2, r2, r11
    qadd    r3, r3, r4
    stm     r7!, {r0-r3}
    .endm

    .p2align 2
    .type   finish, %function
finish:
    ldr     r7, [sp, #CALL]
    add     r7, #32
    ldm     r7, {r7-r11}                @ stereo, left, right, shift, doublings
    cbnz    r7, 1f
    ldr     r12, [sp, #OUT]
    mov     r0, sp
    ldm     r0!, {r1-r8}
    stm     r12!, {r1-r8}
    ldm     r0!, {r1-r8}
    stm     r12!, {r1-r8}
    ldm     r0!, {r1-r8}
    stm     r12!, {r1-r8}
    ldm     r0!, {r1-r8}
    stm     r12!, {r1-r8}
    add     sp, #LOCALS
    pop     {r4-r11, pc}
1:  subs    r11, #1
    bpl     8f
9:  ldr     r12, [sp, #FRAMES]          @ left += mantissa (mix << shift), right alike: 12.5 cycles a frame
    add     lr, sp, #128
    orr     r0, r8, r9
    clz     r0, r0
    cmp     r0, r10
    bls     6f
    lsl     r8, r8, r10                 @ the usual case: mantissas that leave room take the shift, 11.5 cycles a frame
    lsl     r9, r9, r10
    mov     r10, #0
    subs    r12, #4
    blo     3f
7:  pan_two 0
    pan_two 0
    subs    r12, #4
    bhs     7b
    b       3f
6:  subs    r12, #4
    blo     3f
2:  pan_two 1
    pan_two 1
    subs    r12, #4
    bhs     2b
3:  adds    r12, #4
    beq     5f
4:  ldr     r5, [lr, #-4]!
    ldm     r7, {r0, r1}
    lsl     r5, r5, r10
    smmulr  r6, r5, r8
    smmulr  r5, r5, r9
    qadd    r0, r0, r6
    qadd    r1, r1, r5
    stm     r7!, {r0, r1}
    subs    r12, #1
    bne     4b
5:  add     sp, #LOCALS
    pop     {r4-r11, pc}
8:  mov     r12, sp                     @ a mix that may be too loud is doubled with saturation: 3.2 cycles a frame
    movs    r6, #8
2:  ldm     r12, {r0-r3}
    qadd    r0, r0, r0
    qadd    r1, r1, r1
    qadd    r2, r2, r2
    qadd    r3, r3, r3
    stm     r12!, {r0-r3}
    subs    r6, #1
    bne     2b
    b       1b
    .size   finish, . - finish

    .p2align 2
    .global malleus_kernel_driven
    .type   malleus_kernel_driven, %function
    .thumb_func
malleus_kernel_driven:
    enter
    ldm     r4!, {r1-r3, r6-r10}        @ the force, behind the mix
    stm     r12!, {r1-r3, r6-r10}
    ldm     r4!, {r1-r3, r6-r10}
    stm     r12!, {r1-r3, r6-r10}
    ldm     r4!, {r1-r3, r6-r10}
    stm     r12!, {r1-r3, r6-r10}
    ldm     r4!, {r1-r3, r6-r10}
    stm     r12!, {r1-r3, r6-r10}
    cmp     r5, #32
    bne     next_short_driven
    next_group driven, DRIVEN, 2, leftover_driven
    by_kind driven_gain_0, driven_gain_1, driven_gain_2, driven_gain_2, driven_phase_0, driven_phase_1, driven_phase_2 @ no form is 3
leftover_driven:
    and     r2, r2, #3
    by_kind driven_one_0, driven_one_1, driven_one_2

    next_group short_driven, DRIVEN, 2, leftover_short_driven
    and     r2, r2, #3
    by_kind short_driven_two_0, short_driven_two_1, short_driven_two_2
leftover_short_driven:
    and     r2, r2, #3
    by_kind short_driven_one_0, short_driven_one_1, short_driven_one_2

    .irp    form, 0, 1, 2
    driven_two gain, \form, \form
    driven_two phase, \form, \form + 4
    driven_one \form
    short_driven \form
    .endr
