//! Place of a contact on a map, and the direction in which it moves.

use super::path::{POINT, Segments};
use super::surface::Map;
use super::{TICK_FRAMES, ramp};

/// Motion over the plane at the ends of a tick.
#[derive(Clone, Copy, Debug)]
pub(super) struct Heading {
    /// Velocity along the rows, and across them, at both ends, points of the grid a frame.
    pub(super) points: [[f32; 2]; 2],
    /// Weights c², c s and s² of the direction (c, s) at the ends.
    pub(super) directions: [[f64; 3]; 2],
}

/// Weights c², c s and s² of the direction of a velocity.
pub(super) fn weights_of(velocity: [f32; 2]) -> [f64; 3] {
    let [x, y] = velocity.map(f64::from);
    let square = x * x + y * y;
    if square > 0.0 { [x * x / square, x * y / square, y * y / square] } else { [1.0, 0.0, 0.0] }
}

/// Places of a tick: speeds grow by the step each frame, then places by the speeds.
#[derive(Clone, Debug)]
pub(super) struct Tick {
    speeds: [i64; 2],
    steps: [i64; 2],
    /// Weights of the direction in each frame.
    weights: Vec<[f64; 3]>,
}

impl Tick {
    pub(super) fn new(heading: &Heading) -> Self {
        let ends = heading.points.map(|ends| ends.map(|points| (points * POINT as f32) as i64));
        let steps = ends.map(|[from, to]| (to - from) / TICK_FRAMES as i64);
        let speeds = [0, 1].map(|axis| ends[axis][0] - (steps[axis] >> 1));
        let [from, to] = heading.directions;
        let lines: Vec<Vec<f64>> = (0..3).map(|index| ramp(from[index], to[index]).collect()).collect();
        let weights = (0..TICK_FRAMES).map(|frame| [lines[0][frame], lines[1][frame], lines[2][frame]]).collect();
        Self { speeds, steps, weights }
    }

    /// Goes on by a frame from a place, and gives the place behind it.
    pub(super) fn go_on(&mut self, place: [i64; 2]) -> [i64; 2] {
        for (speed, step) in self.speeds.iter_mut().zip(self.steps) {
            *speed += step;
        }
        [place[0] + self.speeds[0], place[1] + self.speeds[1]]
    }

    /// Curvature in a frame in a segment, some quarters of the frame behind its begin.
    pub(super) fn curvature(
        &self,
        map: &Map,
        (segments, segment): (&Segments, i64),
        (begin, quarters, frame): ([i64; 2], i64, usize),
    ) -> f64 {
        let offsets = segments.offset_in_map(segment, map.points);
        let place = [0, 1].map(|axis| {
            // The rest of the frame is what is rounded, as in the instrument.
            let speed = self.speeds[axis];
            let place = begin[axis] + speed - ((speed * (4 - quarters)) >> 2) + offsets[axis];
            place.rem_euclid(map.points[axis] as i64 * POINT) as f64 / POINT as f64
        });
        map.curvature_at(place, self.weights[frame])
    }
}
