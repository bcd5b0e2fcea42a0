//! The loops for a Cortex-M4F, in `cortex_m4.s`, with the bits of [`super::portable`].
#![allow(unsafe_code)] // assembly; the only place of this folder

use core::mem::offset_of;

use zerocopy::byteorder::little_endian::I16;

use super::{INTERVALS, Mix, STEP, STRIP, Strides, Strip};
use crate::table::layout::LIMITS;

core::arch::global_asm!(include_str!("cortex_m4.s"), options(raw));

// Numbers that cortex_m4.s uses.
const _: () = {
    assert!(LIMITS == 3 && size_of::<I16>() == 2 && size_of::<Strides>() == 24);
    assert!(INTERVALS == 32 && STRIP >= INTERVALS + 3 && STEP == 4 && STRIP.is_multiple_of(STEP));
    assert!(offset_of!(Strides, speed) == 8 && offset_of!(Strides, step) == 16);
    assert!(offset_of!(Mix, largest) == 8 && offset_of!(Mix, left) == 12);
};

unsafe extern "C" {
    fn malleus_scrape_mix_row(strip: *mut i32, strip_end: *const i32, row: *const I16, weights: *const [i32; 2]);
    fn malleus_scrape_read_strip(
        strides: *const Strides,
        mix: *const Mix,
        rises: *mut i32,
        rises_end: *const i32,
        strip: *const i32,
    );
}

/// Mixes a row as [`super::portable::mix_row`] does.
///
/// Cost, counted from the code: 21 cycles for four coefficients.
pub(in super::super::super) fn mix_row(row: &[I16], weights: [i32; 2], (strip, count): (&mut Strip, usize)) {
    let Some(strip) = strip.get_mut(..count / STEP * STEP) else { return };
    if strip.is_empty() || row.len() < LIMITS * (strip.len() - 1) + 2 {
        return;
    }
    let ends = strip.as_mut_ptr_range();
    // SAFETY: there is at least one step of coefficients, and two in the row for each of them.
    unsafe { malleus_scrape_mix_row(ends.start, ends.end, row.as_ptr(), &weights) }
}

/// Reads a strip as [`super::portable::read_strip`] does.
///
/// Cost, counted from the code: 46 cycles a frame.
pub(in super::super::super) fn read_strip(strip: &Strip, strides: Strides, mix: &Mix, rises: &mut [i32]) {
    if rises.is_empty() {
        return;
    }
    let ends = rises.as_mut_ptr_range();
    // SAFETY: there is at least one rise. Of each place the five low bits of its point count,
    // behind which the strip goes on by three.
    unsafe { malleus_scrape_read_strip(&strides, mix, ends.start, ends.end, strip.as_ptr()) }
}
