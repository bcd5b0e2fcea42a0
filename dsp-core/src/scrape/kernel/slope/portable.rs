//! The loops in Rust, with the bits of `cortex_m4.s`.

use zerocopy::byteorder::little_endian::I16;

use super::{INTERVALS, Mix, Strides, Strip, middle, mixed, value};
use crate::table::layout::LIMITS;

/// Mixes coefficients of a row, from its first point on.
pub(in super::super::super) fn mix_row(row: &[I16], weights: [i32; 2], (strip, count): (&mut Strip, usize)) {
    for (out, at) in strip.iter_mut().take(count).zip(row.chunks(LIMITS)) {
        *out = mixed(at, weights);
    }
}

/// Reads rises along a strip.
pub(in super::super::super) fn read_strip(strip: &Strip, strides: Strides, mix: &Mix, rises: &mut [i32]) {
    let Strides { mut place, mut speed, step } = strides;
    let slope = |place: i64| {
        let four = strip.get((place >> 32) as usize % INTERVALS..).and_then(<[_]>::first_chunk);
        value(four.copied().unwrap_or([0; 4]), middle(place))
    };
    let mut last = slope(place);
    for rise in rises {
        speed += step;
        place += speed;
        let now = slope(place);
        *rise = mix.rise(now - last);
        last = now;
    }
}
