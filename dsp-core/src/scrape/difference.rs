//! Differences of the path's slope at both ends of each frame, read from an octave of the table.

use zerocopy::byteorder::little_endian::I16;

use super::ramp::{Normal, Ramp};
use super::spline;
use super::walk::{Point, Walk, point};
use crate::fixed;
use crate::table::Surface;
use crate::table::layout::LIMITS;

/// Largest rise of a frame, Q31 of the unit: 1.375 times what the limit allows, since waves cut
/// off in an octave leave overshoots. Where two segments fade it grows by 1.38, to below 2^30.
const LARGEST: i32 = 11 << 26;

/// Weights of the two limits between which those of a tick lie.
#[derive(Clone, Debug)]
pub(super) struct Difference {
    octave: usize,
    /// First of the two limits.
    column: usize,
    weights: [Ramp; 2],
    largest: i32,
    left: u32,
    right: u32,
}

impl Difference {
    /// Prepares a tick: slopes of an octave at the limits `column` and `column + 1`, with the
    /// weights of both at the tick's ends. One unit of the result is a rise by `unit`.
    pub(super) fn new(
        surface: &Surface<'_>,
        (octave, column): (usize, usize),
        weights: [[f32; 2]; 2],
        unit: f32,
    ) -> Self {
        let slope = |column: usize| surface.slope_unit().get(column).copied().unwrap_or(0.0);
        let scaled = |which: usize| {
            let scale = slope(column + which) * (1.0 / (spline::ONE as f32 * unit));
            weights.get(which).copied().unwrap_or([0.0; 2]).map(|weight| weight * scale)
        };
        let (first, second) = (scaled(0), scaled(1));
        // Both with the fewer bits of the two.
        let most = Normal::new(first, 90).bits.min(Normal::new(second, 90).bits);
        let [first, second] = [first, second].map(|numbers| Ramp::new(Normal::new(numbers, most).values));
        // The high word has `most - 32` bits.
        let shift = 31 - (most - 32);
        Self {
            octave,
            column,
            weights: [first, second],
            largest: LARGEST >> shift.clamp(0, 30),
            left: shift.clamp(0, 30) as u32,
            right: (-shift).clamp(0, 31) as u32,
        }
    }

    /// Rises of the next frames, Q31 of the unit, from a begin and the path's walk in points of the
    /// octave.
    pub(super) fn render(&mut self, surface: &Surface<'_>, begin: i64, walk: &Walk, rises: &mut [i32]) {
        let table = surface.slopes(self.octave);
        let begin = point(begin);
        if self.column == 0 { self.at::<0>(table, begin, walk, rises) } else { self.at::<1>(table, begin, walk, rises) }
    }

    #[inline(never)]
    fn at<const COLUMN: usize>(&mut self, table: &[I16], begin: Point, walk: &Walk, rises: &mut [i32]) {
        let [mut first, mut second] = self.weights;
        let mut last = slopes::<COLUMN>(table, begin);
        let count = rises.len();
        for (out, &place) in rises.iter_mut().zip(walk.points(count)) {
            let now = slopes::<COLUMN>(table, place);
            // Each value is below 2^29.
            let sum = fixed::smmulr(now[0] - last[0], first.next()) + fixed::smmulr(now[1] - last[1], second.next());
            *out = (sum.min(self.largest).max(-self.largest) << (self.left & 31)) >> (self.right & 31);
            last = now;
        }
        self.weights = [first, second];
    }
}

/// Slopes at a point and a fraction behind it at the limits `COLUMN` and `COLUMN + 1`.
#[inline(always)]
fn slopes<const COLUMN: usize>(table: &[I16], place: Point) -> [i32; 2] {
    let Some(c) = table.get(place.index as usize * LIMITS..).and_then(<[I16]>::first_chunk::<{ 4 * LIMITS }>) else {
        return [0; 2];
    };
    let at = |point: usize, which: usize| i32::from(c[point * LIMITS + COLUMN + which].get());
    let value = |which| spline::value([at(0, which), at(1, which), at(2, which), at(3, which)], place.fraction);
    // `map` is a call of its own here: 20 cycles a frame.
    [value(0), value(1)]
}
