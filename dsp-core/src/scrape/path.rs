//! Place of a contact on a surface.
//!
//! A table is short: drawn over again and again, it would be heard as a pitch. So the path is cut
//! into segments of [`SEGMENT_STEPS`], each of which plays the table from a place of its own. The
//! place follows from the segment's number alone: who comes back, comes over the same surface.
//! Towards its end a segment is faded into the next one.

use crate::time::TICK_FRAMES;

/// Longest segment in steps of the table's grid.
pub const SEGMENT_STEPS: u32 = 1024;
/// Part of a segment over which it is faded into the next one, as a power of two.
const FADE_SHIFT: u32 = 4;

/// Place along a surface, Q31.32 steps of the grid; may be negative.
pub(super) type Steps = i64;

/// Segments of a path over a table.
#[derive(Clone, Copy, Debug)]
pub(super) struct Segments {
    /// Length of a segment: a power of two of steps, as its exponent.
    bits: u32,
    /// Number of points of the table.
    points: u32,
    seed: u32,
}

/// Two neighbouring segments, and how the first fades into the second.
#[derive(Clone, Copy, Debug)]
pub(super) struct Pair {
    /// From a place on the path to that in the table, in both segments.
    offsets: [Steps; 2],
    /// Number of the second segment.
    pub(super) second: i64,
    /// Place at which the second segment begins, and length of the fade before it.
    boundary: Steps,
    fade: Steps,
    /// Shift of the fade's length to 1.0 in Q31.
    shift: u32,
}

impl Segments {
    /// Cuts a path over a table of `points` points into segments: at most a third of the table, so
    /// that two of them seldom overlap.
    pub(super) const fn new(points: u32, seed: u32) -> Self {
        Self { points: if points == 0 { 1 } else { points }, ..Self::up_to(points / 3, seed) }
    }

    /// Cuts a path over a map into segments, at most as long as its shorter side of `points`
    /// points: on a straight line no segment comes over the same place twice.
    pub(super) const fn in_map(points: u32, seed: u32) -> Self {
        Self::up_to(points, seed)
    }

    const fn up_to(longest: u32, seed: u32) -> Self {
        let longest = if longest < 32 { 5 } else { longest.ilog2() };
        let bits = if longest < SEGMENT_STEPS.ilog2() { longest } else { SEGMENT_STEPS.ilog2() };
        Self { bits, points: 1, seed }
    }

    /// Number of frames, a power of two, in which a path goes on by less than a quarter of a
    /// segment at a speed in steps a frame; at least 1.
    pub(super) fn block(&self, speed: Steps) -> usize {
        let mut frames = TICK_FRAMES;
        if speed >> (self.bits + 30 - TICK_FRAMES.ilog2()) == 0 {
            return frames;
        }
        while frames > 1 && speed.saturating_mul(frames as i64) >= 1 << (30 + self.bits) {
            frames /= 2;
        }
        frames
    }

    /// Goes from a pair of a path to the two segments between which the boundary nearest to a place
    /// lies.
    pub(super) fn go_nearest(&self, place: Steps, pair: &mut Pair) {
        // Half a segment is at least 2^32.
        let second = i64::from(((place >> 32) as i32).wrapping_add(1 << (self.bits - 1)) >> self.bits);
        if second == pair.second {
            return;
        }
        let bits = 32 + self.bits;
        *pair = Pair {
            offsets: [self.offset(second - 1), self.offset(second)],
            second,
            boundary: second << bits,
            fade: 1 << (bits - FADE_SHIFT),
            shift: self.bits + 1 - FADE_SHIFT,
        };
    }

    /// Offset from a place on the path to a segment's place in the table.
    fn offset(&self, segment: i64) -> Steps {
        point_of(spread((segment as u32).wrapping_add(self.seed)), self.points) - (segment << (32 + self.bits))
    }

    /// Offset from a place in the plane to a segment's place in a map with a number of columns and
    /// rows.
    pub(super) fn offset_in_map(&self, segment: i64, points: [u32; 2]) -> [Steps; 2] {
        let x = spread((segment as u32).wrapping_add(self.seed));
        [point_of(x, points[0]), point_of(spread(x), points[1])]
    }

    /// Place in the table, from 0 to its length.
    pub(super) fn in_table(&self, place: Steps) -> Steps {
        in_table(place, self.points)
    }
}

/// Number whose bits are spread by the finalizer of MurmurHash3 (Appleby, public domain).
const fn spread(mut x: u32) -> u32 {
    x = (x ^ (x >> 16)).wrapping_mul(0x85eb_ca6b);
    x = (x ^ (x >> 13)).wrapping_mul(0xc2b2_ae35);
    x ^ (x >> 16)
}

/// Point of a table for a random number.
const fn point_of(x: u32, points: u32) -> Steps {
    (((x as u64 * points as u64) >> 32) as i64) << 32
}

/// Place in a periodic table of `points` points, from 0 to its length.
pub(super) const fn in_table(place: Steps, points: u32) -> Steps {
    let length = (points as i64) << 32;
    // Places of a segment lie within a table's length of its begin, but for a contact that goes
    // several times over a small map in a frame.
    let is_far = place >= 4 * length || place < -4 * length;
    let mut place = if is_far { remainder(place, length) } else { place };
    while place >= length {
        place -= length;
    }
    while place < 0 {
        place += length;
    }
    place
}

/// Rest of a division without a way to panic.
const fn remainder(place: Steps, length: Steps) -> Steps {
    match place.checked_rem(length) {
        Some(rest) => rest,
        None => 0,
    }
}

impl Pair {
    /// Pair of no path.
    pub(super) const NONE: Self = Self { offsets: [0; 2], second: Steps::MAX, boundary: 0, fade: 0, shift: 0 };

    /// Offset of the second segment or of the first.
    pub(super) const fn offset(&self, is_second: bool) -> Steps {
        let [first, second] = self.offsets;
        if is_second { second } else { first }
    }

    /// Weight of the second segment at a place, Q31 from 0 to 1.
    #[inline(always)]
    pub(super) fn weight(&self, place: Steps) -> i32 {
        let within = place - self.boundary + self.fade;
        if within <= 0 {
            0
        } else if within >= self.fade {
            i32::MAX
        } else {
            (within >> self.shift) as i32
        }
    }

    /// The one segment that places between two lie in, 0 or 1; `None` if both.
    pub(super) const fn only(&self, [low, high]: [Steps; 2]) -> Option<usize> {
        if low >= self.boundary {
            Some(1)
        } else if high < self.boundary - self.fade {
            Some(0)
        } else {
            None
        }
    }
}
