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

/// Turns rises into force, and gives the slope in each frame: see [`Adding`]. The slope stays
/// within ±2^30 in its high word.
pub(in super::super) fn add_up(adding: &mut Adding, frames: &mut [i32; TICK_FRAMES], slopes: &mut [i32; TICK_FRAMES]) {
    frames.iter_mut().zip(slopes).for_each(|(frame, slope)| *slope = add_frame(adding, frame));
}

/// Turns rises into force as [`add_up`] does, and keeps the slopes to itself.
pub(in super::super) fn add_up_alone(adding: &mut Adding, frames: &mut [i32; TICK_FRAMES]) {
    frames.iter_mut().for_each(|frame| _ = add_frame(adding, frame));
}

/// Turns a frame's rise into force; gives the slope.
#[inline(always)]
fn add_frame(adding: &mut Adding, frame: &mut i32) -> i32 {
    let high = |slope: i64| (slope >> 32) as i32;
    let rise = *frame;
    // A slope below 2^62 and a rise below 2^30 times 2^29.
    let slope = adding.slope
        + i64::from(high(adding.slope)) * i64::from(adding.less)
        + i64::from(rise) * i64::from(adding.gain);
    let clamped = high(slope).clamp(-(1 << 30), (1 << 30) - 1);
    adding.slope = (i64::from(clamped) << 32) | (slope & i64::from(u32::MAX));
    let across = fixed::smmul(clamped, adding.horizontal.next()).abs();
    let sum = fixed::smmla(across, rise, adding.vertical.next());
    *frame = fixed::saturating_shift_left(sum >> adding.right, adding.left);
    clamped
}

#[cfg(test)]
mod tests {
    extern crate std;

    use std::vec::Vec;

    use super::super::super::ramp::Ramp;
    use super::super::ONE;
    use super::*;

    /// Table of 16 points with its guard.
    fn table(coefficient: impl Fn(usize) -> i16) -> Vec<I16> {
        (0..16 + GUARD).map(|index| coefficient(index % 16).into()).collect()
    }

    fn exact(table: &[I16], place: f64) -> f64 {
        let place = place.rem_euclid(16.0);
        let (index, u) = (place as usize, place.fract());
        let [a, b, c, d] = [0, 1, 2, 3].map(|point| f64::from(table[index + point].get()));
        (a * (1.0 - u).powi(3)
            + b * (3.0 * u.powi(3) - 6.0 * u * u + 4.0)
            + c * (-3.0 * u.powi(3) + 3.0 * u * u + 3.0 * u + 1.0)
            + d * u.powi(3))
            / 6.0
    }

    #[test]
    fn course_reads_the_spline_there_and_back_for_any_coefficients() {
        let patterns: [fn(usize) -> i16; 5] = [
            |_| i16::MIN,
            |index| [i16::MIN, i16::MAX][index % 2],
            |index| [i16::MIN, i16::MAX, i16::MAX, i16::MIN][index % 4],
            |index| [i16::MAX, i16::MIN, i16::MIN, i16::MAX, 0][index % 5],
            |index| (index * 7919 % 65_536) as u16 as i16,
        ];
        for table in patterns.map(table) {
            for speed in [0x7fff_ffff, -0x8000_0000, 0x1234_5678, -0x0765_4321] {
                let course = Course { place: 5 << 32 | 0x9abc_def0, speed, step: 0 };
                let mut values = [0; 64];
                read(&table, 16, course, &mut values);
                for (count, value) in (1..).zip(values) {
                    let place = (course.place as f64 + f64::from(count) * f64::from(speed)) / 2f64.powi(32);
                    let error = f64::from(value) / f64::from(ONE) - exact(&table, place);
                    assert!(error.abs() < 2e-4, "{place}: {error}");
                }
            }
        }
    }

    #[test]
    fn mean_of_two_limited_values_is_that_of_two_frames() {
        let limited = |factor| Limited { factor: Ramp::new([factor; 2]), rise: Ramp::new([1 << 30; 2]), less: -77 };
        let mut halves: Vec<i32> = (0..64).map(|index| (index - 30) * 0x0200_0000).collect();
        halves[0] = i32::MIN;
        halves[1] = i32::MIN;
        halves[62] = i32::MAX;
        halves[63] = i32::MAX;
        let (mut rises, mut values) = ([0; 32], halves.clone());
        limit_halves(&mut limited((1 << 30) - 1), &halves, &mut rises);
        limit(&mut limited((1 << 30) - 1), &mut values);
        for (rise, halves) in rises.iter().zip(values.as_chunks::<2>().0) {
            assert!((rise - (halves[0] / 2 + halves[1] / 2)).abs() < 3, "{rise} of {halves:?}");
        }
    }

    #[test]
    fn slope_stays_within_its_limits_for_any_rises() {
        for rise in [i32::MIN, i32::MAX] {
            let ramp = Ramp::new([1 << 30, -(1 << 30)]);
            let (gain, less) = (1 << 29, i32::MIN);
            let mut adding = Adding { slope: 0, gain, less, vertical: ramp, horizontal: ramp, right: 0, left: 31 };
            let (mut frames, mut slopes) = ([rise; TICK_FRAMES], [0; TICK_FRAMES]);
            for _ in 0..20 {
                frames.fill(rise);
                add_up(&mut adding, &mut frames, &mut slopes);
                assert!(slopes.iter().all(|slope| (-(1 << 30)..1 << 30).contains(slope)));
            }
        }
    }
}
