//! Work of a contact in a tick, by which its cost is known.

use super::kernel::Course;

/// Work of a tick.
#[derive(Clone, Copy, Debug)]
pub(super) struct Work {
    /// Blocks that were read, those of two segments twice.
    pub(super) blocks: u32,
    /// Values of limited curvature, read along a course or, on maps, place by place.
    pub(super) curvatures: u32,
    pub(super) places: u32,
    /// Way of the courses along both directions, sixteenths of a point: intervals and cells begin.
    pub(super) sixteenths: u32,
    /// Frames of slope.
    pub(super) slopes: u32,
    /// Frames that were faded between two segments.
    pub(super) fades: u32,
}

impl Work {
    /// No work.
    pub(super) const NONE: Self = Self { blocks: 0, curvatures: 0, places: 0, sixteenths: 0, slopes: 0, fades: 0 };
}

impl Work {
    /// Adds a course of so many values in one direction; those in a second direction are no more
    /// values.
    pub(super) fn add_course(&mut self, course: &Course, values: usize) {
        self.curvatures += values as u32;
        self.add_way(course, values);
    }

    /// Adds the way of a course alone: half the speeds at its ends times the values.
    pub(super) fn add_way(&mut self, course: &Course, values: usize) {
        let Course { speed, step, .. } = *course;
        let middle = speed.wrapping_add(step.wrapping_mul(1 + values as i32 / 2));
        self.sixteenths += ((middle.unsigned_abs() >> 16) * values as u32) >> 12;
    }
}
