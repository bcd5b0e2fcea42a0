//! The readings for a Cortex-M4F, in `cortex_m4.s`, with the bits of [`super::portable`].
#![allow(unsafe_code)] // assembly; the only place of this folder

use core::mem::offset_of;

use zerocopy::byteorder::little_endian::I16;

use super::super::super::ramp::Ramp;
use super::super::super::walk::{Point, Walk};
use super::super::Course;
use super::{Directions, MAP_ROUNDING, TERMS_BITS, WEIGHT_BITS, cell_rounding};
use crate::table::Map;
use crate::table::layout::{CURVATURES, GUARD};

core::arch::global_asm!(include_str!("cortex_m4.s"), options(raw));

// Numbers that cortex_m4.s uses.
const _: () = {
    assert!(size_of::<Point>() == 8 && offset_of!(Point, fraction) == 4 && size_of::<I16>() == 2);
    assert!(size_of::<Ramp>() == 8 && CURVATURES == 3 && MAP_ROUNDING == 6 && size_of::<MapPlaces>() == 20);
    assert!(WEIGHT_BITS == 24 && TERMS_BITS == 5 && offset_of!(MapCourse, steps) == 16);
    assert!(offset_of!(MapCourse, cell) == 24 && offset_of!(MapCourse, points) == 32);
    assert!(offset_of!(MapCourse, coefficients) == 40 && offset_of!(MapCourse, row_bytes) == 44);
    assert!(offset_of!(MapCourse, rest_bytes) == 48 && offset_of!(MapCourse, weights) == 52);
    assert!(offset_of!(MapCourse, rounding) == 64 && offset_of!(MapCourse, terms) == 72);
};

unsafe extern "C" {
    fn malleus_scrape_read_map(
        map: *const MapPlaces,
        values: *mut i32,
        values_end: *const i32,
        directions: *const Directions,
    );
    fn malleus_scrape_read_cells(course: *mut MapCourse, values: *mut i32, values_end: *const i32);
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
pub(in super::super::super) fn read_map(map: &Map<'_>, walks: [&Walk; 2], directions: Directions, values: &mut [i32]) {
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

/// Course over a map that `malleus_scrape_read_cells` reads; each number along the rows, then
/// across.
#[repr(C)]
struct MapCourse {
    /// Ways from the middle of the cell, Q32, their growths, and the growths of these.
    within: [i32; 2],
    speeds: [i32; 2],
    steps: [i32; 2],
    /// Cell, and the numbers of them.
    cell: [u32; 2],
    points: [u32; 2],
    coefficients: *const I16,
    row_bytes: usize,
    /// From the row behind the four of a map to the first of the next map's.
    rest_bytes: usize,
    weights: [i32; CURVATURES],
    /// Begins of the sums over the weights, in the outer rows and in the inner ones.
    rounding: [i32; 2],
    /// Terms of the four columns of the cell.
    terms: [[i32; 4]; 4],
}

/// Reads a map as [`super::portable::read_cells`] does.
///
/// Cost, counted from the code: 68 cycles a value, and 280 where a cell begins; 180 for one behind
/// another in its row.
pub(in super::super::super) fn read_cells(
    map: &Map<'_>,
    courses: [Course; 2],
    weights: [i32; CURVATURES],
    values: &mut [i32],
) {
    let [columns, rows] = map.points();
    let (row, size) = (columns + GUARD, (columns + GUARD) * (rows + GUARD));
    let [x, y] = courses.map(|course| (course.place >> 32) as usize);
    if values.is_empty() || map.coefficients().len() != CURVATURES * size || x >= columns || y >= rows {
        values.fill(0);
        return;
    }
    let mut course = MapCourse {
        within: courses.map(|course| (course.place as u32 ^ (1 << 31)) as i32),
        speeds: courses.map(|course| course.speed),
        steps: courses.map(|course| course.step),
        cell: [x as u32, y as u32],
        points: [columns as u32, rows as u32],
        coefficients: map.coefficients().as_ptr(),
        row_bytes: 2 * row,
        rest_bytes: 2 * size - 8 * row,
        weights,
        rounding: cell_rounding(weights),
        terms: [[0; 4]; 4],
    };
    let end = values.as_ptr_range().end;
    // SAFETY: there is at least one value; each cell lies before the map's numbers of columns and
    // rows, behind which its coefficients go on by three.
    unsafe { malleus_scrape_read_cells(&mut course, values.as_mut_ptr(), end) }
}
