//! Way of a contact along an axis over a tick.

use super::kernel::Course;
use super::kernel::slope::Strides;
use super::path::Steps;
use crate::time::TICK_FRAMES;

/// Way whose speed changes linearly: in each frame the speed grows by the step, then the place by
/// the speed, all Q32 points.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Way {
    /// Speed before the next frame.
    pub(super) speed: i64,
    /// Growth of the speed.
    pub(super) step: i64,
}

impl Way {
    /// Way between speeds at a tick's ends, points a frame. Each frame goes on by its mean speed,
    /// so that there and back end where they began.
    pub(super) fn new(ends: [f32; 2]) -> Self {
        let [from, to] = ends.map(steps_of);
        let step = (to - from) / TICK_FRAMES as i64;
        Self { speed: from - (step >> 1), step }
    }

    /// Size that no speed of a tick exceeds, of a way at the tick's begin.
    pub(super) fn largest(self) -> i64 {
        let from = self.speed + (self.step >> 1);
        // The step is rounded towards 0, so that the last speed may lie so many units further.
        let rest = TICK_FRAMES as i64;
        from.abs().max((from + self.step * rest).abs() + rest)
    }

    /// Goes on by a number of frames, and gives how far the place has come.
    pub(super) const fn go_on(&mut self, frames: usize) -> Steps {
        let frames = frames as i64;
        let far = self.speed * frames + self.step * ((frames * (frames + 1)) >> 1);
        self.speed += self.step * frames;
        far
    }

    /// Begin of the walk that is read after some quarters of each frame, as a distance behind the
    /// way's own begin, and the way of that walk.
    pub(super) const fn behind(self, quarters: i64) -> (Steps, Self) {
        let rest = 4 - quarters;
        ((self.speed * rest) >> 2, Self { speed: self.speed - ((self.step * rest) >> 2), step: self.step })
    }

    /// Course whose places lie in the middle of each frame, from a place that the way begins at.
    /// The speed must be below half a point a frame.
    pub(super) const fn middles(self, from: Steps) -> Course {
        let (behind, way) = self.behind(2);
        Course { place: from - behind, speed: way.speed as i32, step: way.step as i32 }
    }

    /// Course whose places lie at a quarter and at three quarters of each frame, from a place that
    /// the way begins at. The speed must be below a point a frame.
    pub(super) const fn quarters(self, from: Steps) -> Course {
        let first = self.speed + self.step;
        let quarter = first - ((3 * first) >> 2);
        // From a quarter to three quarters of the first frame goes half its speed; the way before
        // is a step of half a frame less.
        let (half, step) = (first >> 1, self.step >> 2);
        Course { place: from + quarter - (half - step), speed: (half - 2 * step) as i32, step: step as i32 }
    }

    /// Strides over a table of `points` points, an octave of the grid's, from a place in it.
    pub(super) fn strides(self, place: Steps, octave: usize, points: usize) -> Strides {
        let [mut speed, step] = self.ends().map(|speed| speed >> octave);
        let length = (points as i64) << 32;
        if (speed + step).abs() >= length {
            // A single frame that goes several times round, which makes no difference.
            speed = (speed + step).checked_rem(length).unwrap_or(0) - step;
        }
        Strides { place, speed, step }
    }

    /// Speeds and steps for [`Walk::go`](super::walk::Walk::go).
    pub(super) const fn ends(self) -> [i64; 2] {
        [self.speed, self.step]
    }
}

/// Number of points as Q32, rounded towards 0.
///
/// Whole points and the rest are converted one by one, which takes a few instructions where one
/// conversion to 64 bits is a call.
fn steps_of(points: f32) -> Steps {
    let size = points.abs();
    let whole = size as u32;
    let rest = ((size - whole as f32) * 4_294_967_296.0) as u32;
    let steps = (i64::from(whole) << 32) | i64::from(rest);
    if points < 0.0 { -steps } else { steps }
}
