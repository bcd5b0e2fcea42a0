//! Walk over a periodic table: the points at which it is read, frame by frame.

use crate::time::TICK_FRAMES;

/// Places in a table, one for each frame of a block.
#[derive(Clone, Debug)]
pub(super) struct Walk {
    /// Point before each place, and the fraction behind it.
    points: [Point; TICK_FRAMES],
    /// Length of the table: all points lie before it.
    length: u32,
}

/// Place in a table.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub(super) struct Point {
    /// Point before the place.
    pub(super) index: u32,
    /// Fraction behind it, Q31.
    pub(super) fraction: i32,
}

/// Point before a place, and the fraction behind it.
#[inline(always)]
pub(super) const fn point(place: i64) -> Point {
    Point { index: (place >> 32) as u32, fraction: (place as u32 >> 1) as i32 }
}

impl Walk {
    pub(super) const fn new() -> Self {
        Self { points: [Point { index: 0, fraction: 0 }; TICK_FRAMES], length: 0 }
    }

    /// Walks from a place, 0 to below `points`, on. Each of `frames` frames the speed grows by
    /// `step`, then the place by the speed, all Q32 points. Behind the first frame the speed must
    /// stay below the table's length.
    #[inline(never)]
    pub(super) fn go(&mut self, mut place: i64, [mut speed, step]: [i64; 2], points: usize, frames: usize) {
        let length = (points as i64) << 32;
        let last = (points as u32).saturating_sub(1);
        self.length = points as u32;
        if (speed + step).abs() >= length {
            // A longer first frame goes several times round, which makes no difference.
            speed = (speed + step).checked_rem(length).unwrap_or(0) - step;
        }
        for out in self.points.iter_mut().take(frames) {
            speed += step;
            place += speed;
            // The high words are enough, for the table ends at a whole point.
            let index = (place >> 32) as i32;
            if index < 0 {
                place += length;
            } else if index >= points as i32 {
                place -= length;
            }
            let Point { index, fraction } = point(place);
            // The last one for a place that no kit and motion lead to.
            *out = Point { index: if index < last { index } else { last }, fraction };
        }
    }

    /// Places of the first frames.
    pub(super) fn points(&self, frames: usize) -> &[Point] {
        self.points.get(..frames).unwrap_or(&self.points)
    }

    /// Length of the table, before which all places of the last walk lie.
    pub(super) const fn length(&self) -> usize {
        self.length as usize
    }
}
