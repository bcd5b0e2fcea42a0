//! The readings for a Cortex-M4F, in `cortex_m4.s`, with the bits of [`super::portable`].
#![allow(unsafe_code)] // assembly; the only place of this folder

use core::mem::offset_of;

use zerocopy::byteorder::little_endian::I16;

use super::{Mix, Strides};
use crate::table::layout::{GUARD, LIMITS};

core::arch::global_asm!(include_str!("cortex_m4.s"), options(raw));

// Numbers that cortex_m4.s uses.
const _: () = {
    assert!(LIMITS == 3 && GUARD == 3 && size_of::<I16>() == 2 && size_of::<Strides>() == 24);
    assert!(offset_of!(Strides, speed) == 8 && offset_of!(Strides, step) == 16 && offset_of!(Mix, largest) == 16);
    assert!(offset_of!(Mix, left) == 20 && offset_of!(Mix, right) == 24);
};

/// Octave that `malleus_scrape_read_rises` reads.
#[repr(C)]
struct Octave {
    points: usize,
    /// Coefficients of the first of the two limits.
    coefficients: *const I16,
}

unsafe extern "C" {
    fn malleus_scrape_read_rises(
        strides: *const Strides,
        mix: *mut Mix,
        rises: *mut i32,
        rises_end: *const i32,
        octave: *const Octave,
    );
}

/// Reads rises as [`super::portable::read_rises`] does.
///
/// Cost, counted from the code: 77 cycles a frame.
pub(in super::super::super) fn read_rises(
    (table, points, column): (&[I16], usize, usize),
    strides: Strides,
    mix: &mut Mix,
    rises: &mut [i32],
) {
    let first = (strides.place >> 32) as usize;
    let (Some(from), false) = (table.get(column..), rises.is_empty()) else { return };
    let is_inside = first < points && column + 2 <= LIMITS && strides.stay_within(points, rises.len());
    if table.len() < (points + GUARD) * LIMITS || !is_inside {
        rises.fill(0);
        return;
    }
    let octave = Octave { points, coefficients: from.as_ptr() };
    let end = rises.as_ptr_range().end;
    // SAFETY: there is at least one rise. Each place lies before the number of points, since the
    // first one does and no way is longer than the table; behind it the table goes on by three.
    unsafe { malleus_scrape_read_rises(&strides, mix, rises.as_mut_ptr(), end, &octave) }
}
