//! The kernel for a Cortex-M4F: `cortex_m4.s`, bit for bit what [`super::portable`] does.
#![allow(unsafe_code)] // assembly

use core::mem::offset_of;

use super::super::resonance::Resonance;

core::arch::global_asm!(include_str!("cortex_m4.s"), options(raw));

// What cortex_m4.s counts on.
const _: () = {
    assert!(offset_of!(Resonance, u) == 0 && offset_of!(Resonance, v) == 4 && offset_of!(Resonance, turn) == 8);
    assert!(offset_of!(Resonance, damp) == 12 && offset_of!(Resonance, gain_u) == 16);
    assert!(offset_of!(Resonance, gain_v) == 20 && offset_of!(Resonance, scale) == 24);
};

unsafe extern "C" {
    fn malleus_loop_0(band: *mut Resonance, line: *const i32, mix: *mut i32, frames: usize);
    fn malleus_loop_1(band: *mut Resonance, line: *const i32, mix: *mut i32, frames: usize);
    fn malleus_loop_2(band: *mut Resonance, line: *const i32, mix: *mut i32, frames: usize);
    fn malleus_loop_3(band: *mut Resonance, line: *const i32, mix: *mut i32, frames: usize);
}

/// As [`super::portable::run`].
#[inline(always)]
pub fn run(band: &mut Resonance, line: &[i32], mix: &mut [i32]) {
    let frames = line.len().min(mix.len());
    let kernel = match band.shift {
        0 => malleus_loop_0,
        1 => malleus_loop_1,
        2 => malleus_loop_2,
        _ => malleus_loop_3,
    };
    // SAFETY: the band and the mix are borrowed mutably, and line and mix hold at least `frames` words; the assembly keeps the procedure call
    // standard.
    unsafe { kernel(band, line.as_ptr(), mix.as_mut_ptr(), frames) }
}
