//! The readings in Rust, with the bits of `cortex_m4.s`.

use zerocopy::byteorder::little_endian::I16;

use super::{Mix, Strides};
use crate::fixed;
use crate::table::layout::{GUARD, LIMITS};

/// Reads the slopes at two neighbouring limits, `column` and the next one, at both ends of each
/// frame, and mixes their rises. `points` is the number of points before the table goes on by its
/// guard; in a frame a place goes by less than all of them.
pub(in super::super::super) fn read_rises(
    (table, points, column): (&[I16], usize, usize),
    strides: Strides,
    mix: &mut Mix,
    rises: &mut [i32],
) {
    let is_inside = ((strides.place >> 32) as usize) < points && strides.stay_within(points, rises.len());
    if table.len() < (points + GUARD) * LIMITS || !is_inside {
        rises.fill(0);
        return;
    }
    let Strides { mut place, mut speed, step } = strides;
    let length = (points as i64) << 32;
    let mut last = slopes(table, column, place);
    for rise in rises {
        speed += step;
        place += speed;
        if place < 0 {
            place += length;
        } else if place >= length {
            place -= length;
        }
        let now = slopes(table, column, place);
        let [first, second] = [mix.weights[0].next(), mix.weights[1].next()];
        // Each value is below 2^29.
        let sum = fixed::smmlar(fixed::smmulr(now[0] - last[0], first), now[1] - last[1], second);
        *rise = (sum.min(mix.largest).max(-mix.largest) << mix.left) >> mix.right;
        last = now;
    }
}

/// Slopes at a place at the limits `column` and `column + 1`: coefficients times the spline's
/// weights, Q24, at the way t from the interval's middle, -1/2 to 1/2.
#[inline(always)]
fn slopes(table: &[I16], column: usize, place: i64) -> [i32; 2] {
    let within = (place as u32 ^ (1 << 31)) as i32;
    let square = fixed::smmulr(within, within);
    let cube = fixed::smmulr(square, within) >> 5;
    let (line, square) = (3 * (within >> 7), 3 * (square >> 6));
    let (outer, inner) = ((1 << 24) + square, (23 << 24) - square);
    let (outer_odd, inner_odd) = (line + cube, 5 * line - 3 * cube);
    let weights = [outer - outer_odd, inner - inner_odd, inner + inner_odd, outer + outer_odd];
    let first = (place >> 32) as usize * LIMITS + column;
    [0, 1].map(|which| {
        weights.iter().enumerate().fold(0, |sum: i32, (point, weight)| {
            let c = table.get(first + which + point * LIMITS).map_or(0, |c| c.get());
            sum + ((i64::from(*weight) * i64::from(c)) >> 16) as i32
        })
    })
}
