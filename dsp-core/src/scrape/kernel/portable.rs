//! The loops in Rust, with the bits of `cortex_m4.s`.

use zerocopy::byteorder::little_endian::I16;

use super::super::tanh::tanh;
use super::{Adding, Course, Limited, OUTPUTS, TAPS};
use crate::fixed;
use crate::table::layout::GUARD;
use crate::time::TICK_FRAMES;

/// Reads a table's spline along a course: a value for each place. `points` is the number of points
/// before the table goes on by its guard. [`ONE`](super::ONE) stands for 1.
pub(in super::super) fn read(table: &[I16], points: usize, course: Course, values: &mut [i32]) {
    let Course { place, mut speed, step } = course;
    let (mut index, mut within) = ((place >> 32) as usize, (place as u32 ^ (1 << 31)) as i32);
    if table.len() < points + GUARD || index >= points {
        values.fill(0);
        return;
    }
    let mut terms = terms_at(table, index);
    for value in values {
        speed = speed.wrapping_add(step);
        let (next, is_beyond) = within.overflowing_add(speed);
        within = next;
        if is_beyond {
            let last = points - 1;
            index = match speed < 0 {
                true if index == 0 => last,
                true => index - 1,
                false if index == last => 0,
                false => index + 1,
            };
            terms = terms_at(table, index);
        }
        let sum = fixed::smmlar(terms[2], terms[3], within);
        let sum = fixed::smmlar(terms[1], sum, within);
        *value = fixed::smmlar(terms[0], sum, within);
    }
}

/// Terms of 1, t, t² and t³ of the spline in the interval behind a table's point, t from -1/2 to
/// 1/2 about its middle. All sums with t are below 112·2^15·2^9, which is below 2^31.
fn terms_at(table: &[I16], index: usize) -> [i32; 4] {
    let Some(four) = table.get(index..).and_then(<[_]>::first_chunk::<4>) else { return [0; 4] };
    let [a, b, c, d] = four.map(|c| i32::from(c.get()));
    [512 * (a + 23 * (b + c) + d), 3072 * (d - a + 5 * (c - b)), 6144 * (a - b - c + d), 4096 * (d - a + 3 * (b - c))]
}

/// Limits curvatures, and turns them into rises.
pub(in super::super) fn limit(limited: &mut Limited, values: &mut [i32]) {
    for value in values {
        let limit = tanh(fixed::smmulr(*value, limited.factor.next()));
        *value = fixed::smmlar(limited.less, limit, limited.rise.next());
    }
}

/// Limits curvatures of two places in each frame, and turns their means into rises.
pub(in super::super) fn limit_halves(limited: &mut Limited, values: &[i32], rises: &mut [i32]) {
    for (rise, halves) in rises.iter_mut().zip(values.as_chunks().0) {
        let factor = limited.factor.next();
        let [first, second] = halves.map(|value| tanh(fixed::smmulr(value, factor)) >> 1);
        *rise = fixed::smmlar(limited.less, first + second, limited.rise.next());
    }
}

/// Filters a tick of frames: the first output's first tap falls on the begin of the history, which
/// must be as long as the outputs and the taps together.
///
/// Taps are Q31, whole steps of [`TAPS`], and sum up to 1; the values are below 2^30 in size, so
/// that the sums stay below 2^30. Products are rounded to nearest: what were always rounded down
/// would pile up in the path's slope.
pub(in super::super) fn filter(history: &[i32], taps: &[i32], frames: &mut [i32; TICK_FRAMES]) {
    for (index, outputs) in frames.as_chunks_mut::<OUTPUTS>().0.iter_mut().enumerate() {
        *outputs = four_outputs(history.get(OUTPUTS * index..).unwrap_or(&[]), taps);
    }
}

/// Outputs at once, so that each value of the window is read once for all of them.
#[inline(always)]
fn four_outputs(window: &[i32], taps: &[i32]) -> [i32; OUTPUTS] {
    let mut sums = [0; OUTPUTS];
    let (Some(&[mut a, mut b, mut c]), Some(rest)) = (window.first_chunk(), window.get(3..)) else { return sums };
    for (&[t, u, v, w], &[d, e, f, g]) in taps.as_chunks::<TAPS>().0.iter().zip(rest.as_chunks::<TAPS>().0) {
        sums = accumulated(sums, t, [a, b, c, d]);
        sums = accumulated(sums, u, [b, c, d, e]);
        sums = accumulated(sums, v, [c, d, e, f]);
        sums = accumulated(sums, w, [d, e, f, g]);
        (a, b, c) = (e, f, g);
    }
    sums.map(|sum| sum << 1)
}

/// Sums with one tap more.
#[inline(always)]
fn accumulated(sums: [i32; OUTPUTS], tap: i32, window: [i32; OUTPUTS]) -> [i32; OUTPUTS] {
    [0, 1, 2, 3].map(|n| fixed::smmlar(sums[n], window[n], tap))
}

/// Turns rises into force, and gives the slope in each frame: see [`Adding`]. The slope stays within
/// ±2^30 in its high word.
pub(in super::super) fn add_up(adding: &mut Adding, frames: &mut [i32; TICK_FRAMES], slopes: &mut [i32; TICK_FRAMES]) {
    let high = |slope: i64| (slope >> 32) as i32;
    for (frame, path) in frames.iter_mut().zip(slopes) {
        let rise = *frame;
        // A slope below 2^62 and a rise below 2^30 times 2^29.
        let slope = adding.slope
            + i64::from(high(adding.slope)) * i64::from(adding.less)
            + i64::from(rise) * i64::from(adding.gain);
        let clamped = high(slope).clamp(-(1 << 30), (1 << 30) - 1);
        adding.slope = (i64::from(clamped) << 32) | (slope & i64::from(u32::MAX));
        *path = clamped;
        let across = fixed::smmul(clamped, adding.horizontal.next()).abs();
        let sum = fixed::smmla(across, rise, adding.vertical.next());
        *frame = fixed::saturating_shift_left(sum >> adding.right, adding.left);
    }
}
