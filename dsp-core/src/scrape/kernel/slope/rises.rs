//! Rises of frames by strips: as far as one goes, and frame by frame beyond.

use super::{INTERVALS, Mix, Octave, STEP, STRIP, Strides, Strip, middle, mix_row, mixed, read_strip, value};
use crate::table::layout::{GUARD, LIMITS};

use super::super::super::path::{Steps, in_table};

/// Reads the slope at both ends of each frame, and gives its rises.
pub(in super::super::super) fn read_rises(octave: Octave<'_>, mut strides: Strides, mix: &Mix, rises: &mut [i32]) {
    let ends = strides.ends(rises.len());
    // Half as many frames go half as far, or a little more.
    let bits = ((ends[1] - ends[0]) >> 32).checked_ilog2().unwrap_or(0);
    if bits < INTERVALS.ilog2() {
        return read_block(octave, strides, ends, mix, rises);
    }
    let halvings = bits + 1 - INTERVALS.ilog2();
    for rises in rises.chunks_mut((rises.len() >> halvings.min(31)).max(1)) {
        read_block(octave, strides, strides.ends(rises.len()), mix, rises);
        strides = strides.behind(rises.len(), octave.points);
    }
}

/// Reads the rises of frames between two places, about as far as a strip.
fn read_block(octave: Octave<'_>, strides: Strides, ends: [Steps; 2], mix: &Mix, rises: &mut [i32]) {
    let [low, high] = ends.map(|place| place >> 32);
    let is_step_small = strides.step == i64::from(strides.step as i32);
    if high - low >= INTERVALS as i64 || !is_step_small {
        return read_far(octave, strides, mix, rises);
    }
    let first = (in_table(low << 32, octave.points as u32) >> 32) as usize;
    let mut strip = [0; STRIP];
    mix_strip(octave, first, mix.weights, (&mut strip, (high - low) as usize + 4));
    let place = strides.place - (low << 32);
    read_strip(&strip, Strides { place, ..strides }, mix, rises);
}

/// Reads frames that go over many points each one by one.
#[inline(never)] // rare
fn read_far(octave: Octave<'_>, strides: Strides, mix: &Mix, rises: &mut [i32]) {
    let Strides { mut place, mut speed, step } = strides;
    let slope = |place: Steps| {
        let mut strip = [0; STRIP];
        mix_strip(octave, (place >> 32) as usize, mix.weights, (&mut strip, 4));
        let [a, b, c, d, ..] = strip;
        value([a, b, c, d], middle(place))
    };
    let mut last = slope(place);
    for rise in rises {
        speed += step;
        place = in_table(place + speed, octave.points as u32);
        let now = slope(place);
        *rise = mix.rise(now - last);
        last = now;
    }
}

/// Mixes a number of coefficients of an octave, from a point on, to a strip; more may follow.
fn mix_strip(octave: Octave<'_>, first: usize, weights: [i32; 2], (strip, count): (&mut Strip, usize)) {
    let Octave { table, points, column } = octave;
    let count = count.next_multiple_of(STEP).min(STRIP);
    let row = table.get(LIMITS * first..LIMITS * (first + count)).and_then(|row| row.get(column..));
    if let (Some(row), true) = (row, first + count <= points + GUARD) {
        return mix_row(row, weights, (strip, count));
    }
    // The table goes round.
    let mut index = first;
    for out in strip.iter_mut().take(count) {
        *out = table.get(LIMITS * index + column..).map_or(0, |at| mixed(at, weights));
        index = if index + 1 < points { index + 1 } else { 0 };
    }
}

impl Strides {
    /// Strides behind a number of frames over a table of `points` points.
    fn behind(self, frames: usize, points: usize) -> Self {
        let frames = frames as i64;
        let way = self.speed * frames + self.step * ((frames * (frames + 1)) >> 1);
        let (place, speed) = (in_table(self.place + way, points as u32), self.speed + self.step * frames);
        Self { place, speed, ..self }
    }

    /// Least and largest place of a block, its begin included.
    fn ends(&self, frames: usize) -> [Steps; 2] {
        let Self { place, speed, step } = *self;
        let (frames, last) = (frames as i64, speed + step * frames as i64);
        let end = place + speed * frames + step * ((frames * (frames + 1)) >> 1);
        let (mut low, mut high) = if place < end { (place, end) } else { (end, place) };
        if (speed + step < 0) != (last < 0) {
            let (mut place, mut speed) = (place, speed);
            for _ in 0..frames {
                speed += step;
                place += speed;
                (low, high) = (low.min(place), high.max(place));
            }
        }
        [low, high]
    }
}

#[cfg(test)]
mod tests {
    extern crate std;

    use std::vec::Vec;

    use zerocopy::byteorder::little_endian::I16;

    use super::super::ONE;
    use super::*;

    #[test]
    fn rises_are_differences_of_the_spline_for_any_coefficients() {
        let table: Vec<I16> =
            (0..(16 + GUARD) * LIMITS).map(|index| [i16::MIN, i16::MAX][index / LIMITS % 16 % 2].into()).collect();
        let octave = Octave { table: &table, points: 16, column: 1 };
        for speed in [1_i64 << 31, -(1 << 31), 1 << 32, -(3 << 31), 15 << 32] {
            let strides = Strides { place: 3 << 32, speed, step: 0 };
            let mix = Mix { weights: [1 << 24, 0], largest: i32::MAX, left: 0 };
            let mut rises = [0; 32];
            read_rises(octave, strides, &mix, &mut rises);
            for (frame, rise) in (0..).zip(rises) {
                // At whole points the spline is -1/3 or 1/3, between them 0.
                let value = |frame: i64| {
                    let halves = (3 << 1) + frame * (speed >> 31);
                    [10_922.5, 0.0, -10_922.5, 0.0][halves.rem_euclid(4) as usize] - 0.5
                };
                let exact = 256.0 * f64::from(ONE) * (value(frame + 1) - value(frame));
                assert!((f64::from(rise) - exact).abs() < 100.0 * f64::from(ONE), "{frame}: {rise}, {exact}");
            }
        }
    }

    #[test]
    fn strip_and_single_frames_read_the_same_rises() {
        let table: Vec<I16> =
            (0..(60 + GUARD) * LIMITS).map(|index| ((index / LIMITS % 60 * 7919 + index % 3) as i16).into()).collect();
        for (speed, step) in [(0xc000_0000, -0x0200_0000), (-0xd000_0000, 0x0900_0000), (0x1000_0000, 7), (0, -9)] {
            let octave = Octave { table: &table, points: 60, column: 0 };
            let strides = Strides { place: 57 << 32 | 77, speed, step };
            let mix = Mix { weights: [1 << 24, -(1 << 23)], largest: i32::MAX >> 3, left: 2 };
            let (mut near, mut far) = ([0; 32], [0; 32]);
            read_rises(octave, strides, &mix, &mut near);
            read_far(octave, strides, &mix, &mut far);
            assert_eq!(near, far);
        }
    }
}
