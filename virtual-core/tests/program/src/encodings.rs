//! Forms of instructions that compilers seldom write. They are listed and decoded, but not run.

use core::arch::global_asm;

use crate::operations::operations;

operations! { ".operations":
    encodings_memory:
        "ldr r0, [r1, #4]!", "ldr r0, [r1], #-4", "ldr r0, [r1, #-8]", "str r0, [r1, #4]!", "str r0, [r1], #-4",
        "ldrb r0, [r1, r2, lsl #3]", "strh r0, [r1, r2, lsl #1]", "strb r0, [r1, r2]", "ldrsh r0, [r1, r2]",
        "ldrt r0, [r1, #4]", "strt r0, [r1, #4]", "ldrbt r0, [r1]", "strht r0, [r1]",
        "ldrd r2, r3, [r1, #8]!", "ldrd r2, r3, [r1], #-8", "strd r2, r3, [r1, #-8]!", "strd r2, r3, [r1], #8",
        "ldmdb r1!, {r2, r3, r8}", "ldmdb r1, {r2, r9}", "stmdb r1!, {r2, r3, r8}", "stmia r1!, {r2, r3}",
        "ldm r1!, {r2, r3}", "ldm r1, {r1, r2}", "push {r12}", "pop {r12}", "push {r0, lr}",
        "ldrexb r0, [r1]", "strexb r2, r0, [r1]", "ldrexh r0, [r1]", "strexh r2, r0, [r1]", "clrex", "ldrex r0, [r1, #16]",
        "pld [r1, #4]", "pli [pc, #8]", "ldr r0, 0f", "ldrb r0, 0f", "ldrd r2, r3, 0f", "vldr s4, 0f", "vldr d3, 0f",
        "vldr d3, [r1, #8]", "vstr d3, [r1, #-8]", "vstr s5, [sp, #4]", "vldr s31, [r1, #-4]",
        "vldmia r1!, {s3-s9}", "vldmdb r1!, {d4-d7}", "vstmia r1, {s0-s31}", "vstmdb r1!, {d8-d15}", "vpush {d8-d15}", "vpop {d0}",
        "bx lr", ".balign 8", "0: .word 0, 0";
    encodings_flow:
        "ldr pc, [r1]", "ldr pc, [r1, r2, lsl #2]", "ldr pc, [r1], #4", "mov pc, lr", "add pc, r2", "blx r3", "bx r1", "ldm r1!, {r2, pc}",
        "tbh [r1, r2, lsl #1]", "cbnz r3, 0f", "bne.w 0f", "b.w 0f", "it eq", "bxeq lr", "ite ne", "movne r0, #1", "beq.w 0f", "0: bl 0b",
        "svc #255", "bkpt #255", "udf.w #9", "yield", "sev", "wfe", "cpsid i", "cpsie i", "cpsid f", "dmb", "isb";
    encodings_core:
        "adr r0, 0f", "adr.w r0, 0f", "addw r0, r1, #4095", "subw r0, r1, #4095", "add r0, sp, #8", "add.w r0, sp, #1024", "sub sp, #8",
        "add sp, #8", "mov sp, r1", "add sp, r2", "teq r0, r1", "tst r0, #255", "cmn r0, r1", "cmp r8, r9", "mvn r0, r1, lsr #3", "rsbs r0, r1, #0",
        "bic r0, r1, #0x00ff00ff", "movt r0, #4660", "mrs r0, msp", "msr msp, r0", "msr basepri, r1", "umaal r0, r1, r2, r3",
        "smlalbt r0, r1, r2, r3", "smlaltb r0, r1, r2, r3", "sdiv r8, r9, r10", "mls r8, r9, r10, r11", "muls r0, r1, r0", "ssat r8, #5, r9",
        "bfi r8, r9, #3, #4", "uxtab r0, r1, r2", "rev16.w r8, r9", "lsls r0, r1, #31", "rrxs r0, r1", "bx lr", ".balign 4", "0: .word 0";
    encodings_float:
        "vmov s1, s2", "vmov.f32 s31, #0.5", "vmov d1, r2, r3", "vmov r2, r3, d1", "vmov s5, s6, r2, r3", "vmov r2, r3, s5, s6", "vmov s31, r8",
        "vmov r8, s31", "vcmp.f32 s1, #0.0", "vcmpe.f32 s30, s31", "vmrs r2, fpscr", "vmsr fpscr, r2", "vcvtr.u32.f32 s0, s1",
        "vcvt.f32.u32 s9, s10", "vcvt.u16.f32 s7, s7, #3", "vcvt.f32.s16 s7, s7, #3", "vcvtt.f16.f32 s3, s4", "vsqrt.f32 s21, s22",
        "vnmla.f32 s21, s22, s23", "vfnms.f32 s1, s30, s3", "vdiv.f32 s3, s2, s1", "bx lr";
}
