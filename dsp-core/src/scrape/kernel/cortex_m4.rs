//! The loops for a Cortex-M4F, in `cortex_m4.s`, with the bits of [`super::portable`].
#![allow(unsafe_code)] // assembly; the only place of this folder

use core::mem::offset_of;

use zerocopy::byteorder::little_endian::I16;

use super::super::ramp::Ramp;
use super::super::tanh::{ARGUMENT_BITS, PIECE_TERMS, PIECES, Piece, WITHIN_BITS};
use super::{Adding, Course, Limited, OUTPUTS, TAPS};
use crate::table::layout::GUARD;
use crate::time::TICK_FRAMES;

core::arch::global_asm!(include_str!("cortex_m4.s"), options(raw));

// Numbers that cortex_m4.s uses.
const _: () = {
    assert!(OUTPUTS == 4 && TAPS == 4 && TICK_FRAMES == 32);
    assert!(offset_of!(Limited, factor) == 0 && offset_of!(Limited, rise) == 8 && offset_of!(Limited, less) == 16);
    assert!(offset_of!(Adding, gain) == 8 && offset_of!(Adding, less) == 12 && offset_of!(Adding, vertical) == 16);
    assert!(offset_of!(Adding, horizontal) == 24 && offset_of!(Adding, right) == 32 && offset_of!(Adding, left) == 36);
    assert!(size_of::<Ramp>() == 8 && size_of::<I16>() == 2);
    assert!(ARGUMENT_BITS == 19 && WITHIN_BITS == 14 && PIECES == 512 && size_of::<Piece>() == 8 && GUARD == 3);
};

unsafe extern "C" {
    fn malleus_scrape_read(course: *const CourseInTable, values: *mut i32, values_end: *const i32);
    fn malleus_scrape_limit(limited: *mut Limited, pieces: *const Piece, values: *mut i32, values_end: *const i32);
    fn malleus_scrape_limit_halves(
        limited: *mut Limited,
        pieces: *const Piece,
        rises: *mut i32,
        rises_end: *const i32,
        values: *const i32,
    );
    fn malleus_scrape_add_up(adding: *mut Adding, frames: *mut i32, slopes: *mut i32);
    fn malleus_scrape_smooth(history: *const i32, taps: *const i32, frames: *mut i32, taps_end: *const i32);
}

/// Course in the table that `malleus_scrape_read` reads.
#[repr(C)]
struct CourseInTable {
    /// Way from the middle of the interval, Q32.
    within: i32,
    speed: i32,
    step: i32,
    /// Coefficients of the interval.
    coefficients: *const I16,
    first: *const I16,
    /// End of the points, behind which the guard begins.
    end: *const I16,
}

/// Reads a table as [`super::portable::read`] does.
///
/// Cost, counted from the code: 9 cycles a value, and 32 where an interval begins.
pub(in super::super) fn read(table: &[I16], points: usize, course: Course, values: &mut [i32]) {
    let Course { place, speed, step } = course;
    let index = (place >> 32) as usize;
    let (Some(coefficients), Some(inside), true) = (table.get(index..), table.get(..points), index < points) else {
        values.fill(0);
        return;
    };
    if values.is_empty() || table.len() < points + GUARD {
        values.fill(0);
        return;
    }
    let within = (place as u32 ^ (1 << 31)) as i32;
    let ends = inside.as_ptr_range();
    let course =
        CourseInTable { within, speed, step, coefficients: coefficients.as_ptr(), first: ends.start, end: ends.end };
    let end = values.as_ptr_range().end;
    // SAFETY: there is at least one value; each interval lies before the points' end, behind which
    // the table goes on by three coefficients.
    unsafe { malleus_scrape_read(&course, values.as_mut_ptr(), end) }
}

/// Limits curvatures as [`super::portable::limit`] does.
///
/// Cost, counted from the code: 15 cycles a frame.
pub(in super::super) fn limit(limited: &mut Limited, values: &mut [i32]) {
    let (Some(pieces), false) = (middle(), values.is_empty()) else { return };
    let end = values.as_ptr_range().end;
    // SAFETY: the loop goes over the values, at least one, and takes one of the pieces from 256
    // before the middle to 255 behind it for any argument.
    unsafe { malleus_scrape_limit(limited, pieces, values.as_mut_ptr(), end) }
}

/// Limits curvatures of two places in each frame as [`super::portable::limit_halves`] does.
///
/// Cost, counted from the code: 31 cycles a frame.
pub(in super::super) fn limit_halves(limited: &mut Limited, values: &[i32], rises: &mut [i32]) {
    let (Some(pieces), Some(_), false) = (middle(), values.get(..2 * rises.len()), rises.is_empty()) else { return };
    let end = rises.as_ptr_range().end;
    // SAFETY: the loop goes over the rises, at least one, with two values for each; pieces as in
    // `limit`.
    unsafe { malleus_scrape_limit_halves(limited, pieces, rises.as_mut_ptr(), end, values.as_ptr()) }
}

/// Piece from 0 on, with as many before it as behind it.
fn middle() -> Option<*const Piece> {
    PIECE_TERMS.get(PIECES / 2..).map(<[Piece]>::as_ptr)
}

/// Adds up forces as [`super::portable::add_up`] does.
///
/// Cost, counted from the code: 17 cycles a frame; 24 with a shift to the left.
pub(in super::super) fn add_up(adding: &mut Adding, frames: &mut [i32; TICK_FRAMES], slopes: &mut [i32; TICK_FRAMES]) {
    // SAFETY: there are 32 frames and slopes.
    unsafe { malleus_scrape_add_up(adding, frames.as_mut_ptr(), slopes.as_mut_ptr()) }
}

/// Adds up forces as [`super::portable::add_up_alone`] does.
///
/// Cost as that of [`add_up`].
pub(in super::super) fn add_up_alone(adding: &mut Adding, frames: &mut [i32; TICK_FRAMES]) {
    let frames = frames.as_mut_ptr();
    // SAFETY: there are 32 frames. The loop writes a slope behind the rise that it has read, and
    // then the force over it.
    unsafe { malleus_scrape_add_up(adding, frames, frames) }
}

/// Filters a tick as [`super::portable::filter`] does.
///
/// Cost, counted from the code: 47 cycles a frame with 24 taps. Four outputs take 26 cycles for
/// each step of four taps, and 30 beside these.
pub(in super::super) fn filter(history: &[i32], taps: &[i32], frames: &mut [i32; TICK_FRAMES]) {
    if taps.is_empty() || !taps.len().is_multiple_of(TAPS) || history.len() < TICK_FRAMES + taps.len() {
        frames.fill(0);
        return;
    }
    // SAFETY: the taps are whole steps, at least one; the last output reads up to the history's
    // value 32 - 1 + taps; there is a place for each output.
    unsafe { malleus_scrape_smooth(history.as_ptr(), taps.as_ptr(), frames.as_mut_ptr(), taps.as_ptr_range().end) }
}
