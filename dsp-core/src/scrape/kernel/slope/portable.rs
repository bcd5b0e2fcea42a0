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

#[cfg(test)]
mod tests {
    extern crate std;

    use std::vec::Vec;

    use super::super::super::super::ramp::Ramp;
    use super::super::ONE;
    use super::*;

    #[test]
    fn rises_are_differences_of_the_spline_for_any_coefficients() {
        let table: Vec<I16> =
            (0..(16 + GUARD) * LIMITS).map(|index| [i16::MIN, i16::MAX][index / LIMITS % 16 % 2].into()).collect();
        for speed in [1_i64 << 32, -(3 << 31), 15 << 32] {
            let strides = Strides { place: 3 << 32, speed, step: 0 };
            let weights = [Ramp::new([1 << 30; 2]), Ramp::new([0; 2])];
            let mut mix = Mix { weights, largest: (1 << 30) - 1, left: 0, right: 0 };
            let mut rises = [0; 32];
            read_rises((&table, 16, 1), strides, &mut mix, &mut rises);
            for (frame, rise) in (0..).zip(rises) {
                // At whole points the spline is -1/3 or 1/3, between them 0.
                let value = |frame: i64| {
                    let halves = (3 << 1) + frame * (speed >> 31);
                    [10_923.0, 0.0, -10_923.0, 0.0][halves.rem_euclid(4) as usize]
                        + if halves % 2 == 0 { -1.0 / 3.0 } else { -0.5 }
                };
                let exact = 0.25 * f64::from(ONE) * (value(frame + 1) - value(frame));
                assert!((f64::from(rise) - exact).abs() < 0.3 * f64::from(ONE), "{frame}: {rise}, {exact}");
            }
        }
    }
}
