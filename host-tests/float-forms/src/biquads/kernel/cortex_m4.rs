//! The kernel for a Cortex-M4F: `cortex_m4.s`, bit for bit what [`super::portable`] does.
#![allow(unsafe_code)] // assembly

use core::mem::offset_of;

use super::super::quad::Quad;

core::arch::global_asm!(".equ BF_QUAD, {quad}", quad = const size_of::<Quad>());
core::arch::global_asm!(include_str!("cortex_m4.s"), options(raw));

/// Arguments of the assembly.
#[repr(C)]
struct Call {
    quads: *mut Quad,
    end: *mut Quad,
    frames: u32,
    input: *const f32,
    out: *mut f32,
    direct: f32,
}

// The offsets that cortex_m4.s uses.
const _: () = {
    assert!(offset_of!(Quad, u) == 0 && offset_of!(Quad, v) == 16 && offset_of!(Quad, kept) == 32);
    assert!(offset_of!(Quad, turn) == 48 && offset_of!(Quad, entry) == 64 && offset_of!(Quad, gain) == 80);
    assert!(offset_of!(Quad, awake) == 96 && offset_of!(Call, direct) == 20);
};

unsafe extern "C" {
    fn malleus_float_biquads(call: *const Call);
}

/// Adds the sound of all quads to `out`, with the bits of [`super::portable::run`].
pub fn run(quads: &mut [Quad], input: Option<&[f32]>, direct: f32, out: &mut [f32]) {
    if out.is_empty() || input.is_some_and(|input| input.len() != out.len()) {
        return;
    }
    if quads.iter().all(|quad| quad.awake == 0) {
        return super::portable::run(&mut [], input, direct, out);
    }
    let ends = quads.as_mut_ptr_range();
    let call = Call {
        quads: ends.start,
        end: ends.end,
        frames: out.len() as u32,
        input: input.map_or(core::ptr::null(), <[f32]>::as_ptr),
        out: out.as_mut_ptr(),
        direct,
    };
    // SAFETY: the quads and `out` are borrowed mutably for the call, the input, as long as `out`,
    // is borrowed; the assembly keeps the procedure call standard and uses 100 bytes of stack.
    unsafe { malleus_float_biquads(&raw const call) };
}
