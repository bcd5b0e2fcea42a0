//! Examples of the cycle rules, one per function. r0 and r1 hold an address in RAM; r2, r3 and s0
//! to s3 are zero.

use core::arch::global_asm;

use crate::operations::operations;

operations! { ".operations":
    rule_alu: "adds r2, r2, #1", "smmlsr r2, r2, r3, r2", "smlal r2, r3, r2, r3", "bx lr";
    rule_mla: "mla r2, r2, r3, r2", "bx lr";
    rule_load: "ldr r2, [r0]", "bx lr";
    rule_loads: "ldr r2, [r0]", "ldr r3, [r0, #4]", "ldr r3, [r0, #8]", "bx lr";
    rule_load_of_loaded: "ldr r2, [r0]", "ldr r3, [r2]", "bx lr";
    rule_load_after_store: "str r2, [r0]", "ldr r3, [r0, #4]", "bx lr";
    rule_load_after_ldm: "ldm r0, {r2, r3}", "ldr r3, [r1]", "bx lr";
    rule_load_after_alu_address: "add r2, r0, #4", "ldr r3, [r2]", "bx lr";
    rule_load_after_alu_index: "lsl r2, r3, #2", "ldr r3, [r0, r2]", "bx lr";
    rule_load_after_other: "add r2, r0, #4", "nop", "ldr r3, [r2]", "bx lr";
    rule_loads_of_updated_base: "ldr r2, [r0], #4", "ldr r3, [r0], #4", "bx lr";
    rule_store: "str r2, [r0]", "bx lr";
    rule_store_indexed: "str r2, [r0, r3]", "bx lr";
    rule_store_indexed_after_load: "ldr r2, [r1]", "str r2, [r0, r3]", "bx lr";
    rule_ldm: "ldm r0, {r2, r3, r12}", "bx lr";
    rule_ldrd: "ldrd r2, r3, [r0]", "bx lr";
    rule_strd: "strd r2, r3, [r0]", "bx lr";
    rule_push_pop: "push {r4, r5, r6, lr}", "pop {r4, r5, r6, pc}";
    rule_vldm: "vldm r0, {s0-s4}", "bx lr";
    rule_vldr: "vldr s0, [r0]", "vldr s1, [r0, #4]", "bx lr";
    rule_vstr: "vstr s0, [r0]", "bx lr";
    rule_float_apart: "vadd.f32 s0, s1, s2", "vmul.f32 s3, s1, s2", "vsub.f32 s4, s1, s2", "bx lr";
    rule_float_used: "vmul.f32 s0, s1, s2", "vadd.f32 s3, s0, s2", "bx lr";
    rule_float_stored: "vmul.f32 s0, s1, s2", "vstr s0, [r0]", "bx lr";
    rule_float_used_later: "vmul.f32 s0, s1, s2", "nop", "vadd.f32 s3, s0, s2", "bx lr";
    rule_vmla: "vmla.f32 s0, s1, s2", "bx lr";
    rule_vfma_addend: "vmul.f32 s0, s1, s2", "vfma.f32 s0, s1, s2", "bx lr";
    rule_vdiv: "vdiv.f32 s0, s1, s2", "vsqrt.f32 s3, s1", "bx lr";
    rule_vmov: "vmov s0, r2", "vmov r3, s1", "vmov s2, s3, r2, r3", "vneg.f32 s4, s4", "vcmp.f32 s0, s1", "bx lr";
    rule_branch: "b 0f", "nop", "0: bx lr";
    rule_not_taken: "cmp r2, r2", "bne 0f", "0: bx lr";
    rule_cbz: "cbz r2, 0f", "nop", "0: bx lr";
    rule_call: "mov r12, lr", "bl nothing", "bx r12";
    rule_table: "movs r3, #0", "tbb [pc, r3]", "1: .byte (2f-1b)/2, 0", "2: bx lr";
    rule_skipped: "cmp r2, r2", "itt ne", "ldrne r3, [r0]", "vdivne.f32 s0, s1, s2", "bx lr";
    rule_special: "mrs r2, primask", "bx lr";
    rule_divide: "mov r2, #1000", "mov r3, #7", "udiv r2, r2, r3", "bx lr";
}

operations! { ".ramfunc":
    in_ram: "ldr r0, =0x12345678", "bx lr", ".pool";
}
