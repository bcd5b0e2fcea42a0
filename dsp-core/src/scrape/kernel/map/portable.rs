//! The readings in Rust, with the bits of `cortex_m4.s`.

use super::super::super::walk::Walk;
use super::super::Course;
use super::{Directions, MAP_ROUNDING, TERMS_BITS, WEIGHT_BITS, cell_rounding};
use crate::fixed;
use crate::table::Map;
use crate::table::layout::{CURVATURES, GUARD};

/// Reads the curvature of a map in a direction: along its rows where the first walk goes, across
/// them where the second one does. [`MAP_ONE`](super::MAP_ONE) stands for one unit.
pub(in super::super::super) fn read_map(
    map: &Map<'_>,
    walks: [&Walk; 2],
    mut directions: Directions,
    values: &mut [i32],
) {
    let [columns, rows] = map.points();
    let [x, y] = walks.map(|walk| walk.points(values.len()));
    let (row, size) = (columns + GUARD, (columns + GUARD) * (rows + GUARD));
    if walks.map(Walk::length) != [columns, rows] {
        values.fill(0);
        return;
    }
    for ((value, x), y) in values.iter_mut().zip(x).zip(y) {
        let weights = row_weights(y.fraction);
        let mut sums = [MAP_ROUNDING; 4];
        for (map_index, direction) in directions.iter_mut().enumerate() {
            let share = direction.next();
            for (row_index, weight) in weights.iter().enumerate() {
                // At most 1 times 4 in Q26: the sums stay below 1.5 · 6 · 2^26 · 2^15 / 2^16, which
                // is 2^28.2.
                let weight = fixed::smmulr(share, *weight);
                let first = map_index * size + (y.index as usize + row_index) * row + x.index as usize;
                let four = map.coefficients().get(first..).and_then(<[_]>::first_chunk::<4>);
                for (sum, c) in sums.iter_mut().zip(four.map_or([0; 4], |four| four.map(|c| c.get()))) {
                    *sum += ((i64::from(weight) * i64::from(c)) >> 16) as i32;
                }
            }
        }
        *value = along_row(sums.map(|sum| sum >> 2), x.fraction);
    }
}

/// Weights of a spline's four coefficients at a fraction, Q28; their sum is 6.
#[inline(always)]
const fn row_weights(fraction: i32) -> [i32; 4] {
    let square = fixed::smmulr(fraction, fraction);
    let cube = fixed::smmulr(square, fraction) >> 1;
    let (t, square) = (fraction >> 3, square >> 2);
    let second = 3 * (cube - 2 * square) + (4 << 28);
    let third = 3 * (t + square - cube) + (1 << 28);
    [(6 << 28) - second - third - cube, second, third, cube]
}

/// Spline along a row, with coefficients of 27 bits.
#[inline(always)]
const fn along_row([a, b, c, d]: [i32; 4], fraction: i32) -> i32 {
    let outer = a + c;
    let cube = (d - a + 3 * (b - c)) << 1;
    let sum = fixed::smmlar(3 * (outer - 2 * b), cube, fraction);
    let sum = fixed::smmlar((3 * (c - a)) >> 1, sum, fraction);
    fixed::smmlar((outer + 4 * b) >> 2, sum, fraction) << 3
}

/// Reads the curvature of a map in one direction (c, s). `courses` are the places along the rows
/// and across them, `weights` c², c s and s², Q24.
///
/// Terms that depend on the cell alone are derived where a course comes into one.
pub(in super::super::super) fn read_cells(
    map: &Map<'_>,
    courses: [Course; 2],
    weights: [i32; CURVATURES],
    values: &mut [i32],
) {
    const { assert!(WEIGHT_BITS == 24) };
    let points = map.points();
    let mut cell = courses.map(|course| (course.place >> 32) as usize);
    if cell[0] >= points[0] || cell[1] >= points[1] {
        values.fill(0);
        return;
    }
    let mut within = courses.map(|course| (course.place as u32 ^ (1 << 31)) as i32);
    let mut speeds = courses.map(|course| course.speed);
    let mut columns = None;
    for value in values {
        for axis in 0..2 {
            speeds[axis] = speeds[axis].wrapping_add(courses[axis].step);
            let (next, is_beyond) = within[axis].overflowing_add(speeds[axis]);
            within[axis] = next;
            if is_beyond {
                let last = points[axis] - 1;
                cell[axis] = match speeds[axis] < 0 {
                    true if cell[axis] == 0 => last,
                    true => cell[axis] - 1,
                    false if cell[axis] == last => 0,
                    false => cell[axis] + 1,
                };
                columns = None;
            }
        }
        let columns = columns.get_or_insert_with(|| columns_of(map, cell, weights));
        // The spline across the rows in four columns, then along them: all sums with a way are
        // below 112·48·1.5·2^15·2^3, which is below 2^31.
        let [a, b, c, d] = columns.map(|terms| horner(terms, within[1]));
        *value = horner(
            [d + a + 23 * (b + c), 6 * (5 * (c - b) + d - a), 12 * (a + d - b - c), 8 * (d - a - 3 * (c - b))],
            within[0],
        );
    }
}

/// Cubic polynomials in t of a cell's four columns, where t goes from -1/2 to 1/2 across the rows.
/// Each column has its coefficients of 1, t, t² and t³.
fn columns_of(map: &Map<'_>, [x, y]: [usize; 2], weights: [i32; CURVATURES]) -> [[i32; 4]; 4] {
    let [columns, rows] = map.points();
    let (row, size) = (columns + GUARD, (columns + GUARD) * (rows + GUARD));
    let rounding = cell_rounding(weights);
    core::array::from_fn(|column| {
        let [a, b, c, d] = core::array::from_fn(|line| {
            // Q8, at most 1.5 · 2^15 in size.
            weights.iter().enumerate().fold(
                rounding[usize::from(line == 1 || line == 2)],
                |sum, (map_index, weight)| {
                    let first = map_index * size + (y + line) * row + x + column;
                    let coefficient = map.coefficients().get(first).map_or(0, |c| c.get());
                    sum + ((i64::from(*weight) * i64::from(coefficient)) >> 16) as i32
                },
            )
        });
        let (outer, inner, rise, far) = (a + d, b + c, c - b, d - a);
        [
            (outer + 23 * inner) >> TERMS_BITS,
            (3 * (5 * rise + far)) >> (TERMS_BITS - 1),
            (3 * (outer - inner)) >> (TERMS_BITS - 2),
            (far - 3 * rise) >> (TERMS_BITS - 3),
        ]
    })
}

/// Value of a polynomial.
#[inline(always)]
const fn horner(terms: [i32; 4], within: i32) -> i32 {
    let sum = fixed::smmlar(terms[2], terms[3], within);
    let sum = fixed::smmlar(terms[1], sum, within);
    fixed::smmlar(terms[0], sum, within)
}
