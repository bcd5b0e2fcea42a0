//! The loops for a Cortex-M4F, in `cortex_m4.s`, with the bits of [`super::portable`].
#![allow(unsafe_code)] // assembly; the only place of this folder

use core::mem::offset_of;

use zerocopy::byteorder::little_endian::I16;

use super::super::ramp::Ramp;
use super::super::tanh::{ARGUMENT_BITS, PIECE_TERMS};
use super::super::walk::{Point, Walk};
use super::{Directions, Limited, MAP_ROUNDING, OUTPUTS, TAPS};
use crate::table::Map;
use crate::table::layout::{CURVATURES, GUARD};
use crate::time::TICK_FRAMES;

core::arch::global_asm!(include_str!("cortex_m4.s"), options(raw));

// Numbers that cortex_m4.s uses.
const _: () = {
    assert!(OUTPUTS == 4 && TAPS == 4 && TICK_FRAMES == 32);
    assert!(offset_of!(Limited, factor) == 0 && offset_of!(Limited, rise) == 8 && offset_of!(Limited, mean) == 16);
    assert!(size_of::<Point>() == 8 && offset_of!(Point, fraction) == 4 && size_of::<I16>() == 2);
    assert!(size_of::<Ramp>() == 8 && CURVATURES == 3 && MAP_ROUNDING == 6 && size_of::<MapPlaces>() == 20);
    assert!(ARGUMENT_BITS == 19 && size_of_val(&PIECE_TERMS) == 16 * 64 && GUARD == 3);
};

unsafe extern "C" {
    fn malleus_scrape_read(table: *const I16, places: *const Point, values: *mut i32, values_end: *const i32);
    fn malleus_scrape_read_map(
        map: *const MapPlaces,
        values: *mut i32,
        values_end: *const i32,
        directions: *const Directions,
    );
    fn malleus_scrape_limit(limited: *mut Limited, terms: *const [i32; 4], values: *mut i32, values_end: *const i32);
    fn malleus_scrape_smooth(history: *const i32, taps: *const i32, frames: *mut i32, taps_end: *const i32);
}

/// Reads a table as [`super::portable::read`] does.
///
/// Cost, counted from the code: 26 cycles a frame.
pub(in super::super) fn read(table: &[I16], walk: &Walk, values: &mut [i32]) {
    let places = walk.points(values.len());
    if values.is_empty() || places.len() < values.len() || table.len() < walk.length() + GUARD {
        values.fill(0);
        return;
    }
    let end = values.as_ptr_range().end;
    // SAFETY: there is a place for each value, at least one; each lies before the walk's length,
    // behind which the table goes on by three coefficients.
    unsafe { malleus_scrape_read(table.as_ptr(), places.as_ptr(), values.as_mut_ptr(), end) }
}

/// Map and places that `malleus_scrape_read_map` reads.
#[repr(C)]
struct MapPlaces {
    coefficients: *const I16,
    row_bytes: usize,
    /// From the row behind the four of a map to the first of the next map's.
    rest_bytes: usize,
    x: *const Point,
    y: *const Point,
}

/// Reads a map as [`super::portable::read_map`] does.
///
/// Cost by the cycle model: 220 cycles a frame on a map at 0.2 m/s, where fades between segments
/// read some places twice (`cargo test -p host-tests --test on_chip scrape:: -- --nocapture`).
pub(in super::super) fn read_map(map: &Map<'_>, walks: [&Walk; 2], directions: Directions, values: &mut [i32]) {
    let [columns, rows] = map.points();
    let [x, y] = walks.map(|walk| walk.points(values.len()));
    let (row, size) = (columns + GUARD, (columns + GUARD) * (rows + GUARD));
    let is_whole = walks.map(Walk::length) == [columns, rows] && map.coefficients().len() == CURVATURES * size;
    if values.is_empty() || x.len() < values.len() || y.len() < values.len() || !is_whole {
        values.fill(0);
        return;
    }
    let places = MapPlaces {
        coefficients: map.coefficients().as_ptr(),
        row_bytes: 2 * row,
        rest_bytes: 2 * size - 8 * row,
        x: x.as_ptr(),
        y: y.as_ptr(),
    };
    let end = values.as_ptr_range().end;
    // SAFETY: there is a place in both directions for each value, at least one; each lies before
    // the map's numbers of columns and rows, behind which its coefficients go on by three.
    unsafe { malleus_scrape_read_map(&places, values.as_mut_ptr(), end, &directions) }
}

/// Limits curvatures as [`super::portable::limit`] does.
///
/// Cost, counted from the code: 30 cycles a frame.
pub(in super::super) fn limit(limited: &mut Limited, values: &mut [i32]) {
    if values.is_empty() {
        return;
    }
    let end = values.as_ptr_range().end;
    // SAFETY: the loop goes over the values, at least one, and takes one of the 64 pieces for any
    // argument.
    unsafe { malleus_scrape_limit(limited, PIECE_TERMS.as_ptr(), values.as_mut_ptr(), end) }
}

/// Filters a tick as [`super::portable::filter`] does.
///
/// Cost, counted from the code: 7 cycles a tap and 20 for four outputs; 44 a frame with 20 taps.
pub(in super::super) fn filter(history: &[i32], taps: &[i32], frames: &mut [i32; TICK_FRAMES]) {
    if taps.is_empty() || !taps.len().is_multiple_of(TAPS) || history.len() < TICK_FRAMES + taps.len() {
        frames.fill(0);
        return;
    }
    // SAFETY: the taps are whole steps, at least one; the last output reads up to the history's
    // value 32 - 1 + taps; there is a place for each output.
    unsafe { malleus_scrape_smooth(history.as_ptr(), taps.as_ptr(), frames.as_mut_ptr(), taps.as_ptr_range().end) }
}
