//! Place of a contact on a map, and the direction in which it moves.

use super::kernel::Course;
use super::kernel::map::{self, Directions};
use super::path::{Pair, Segments, Steps, in_table};
use super::ramp::{Ramp, fixed_from};
use super::walk::Walk;
use super::way::Way;
use super::work::Work;
use crate::table::layout::CURVATURES;
use crate::table::{Map, Surface};
use crate::time::TICK_FRAMES;

/// Points from one reading to the next below which cells are read.
const SLOWEST: f32 = 0.49;
/// Least change of a direction's weights over a tick, Q30: what the numbers of a straight line lose
/// is less.
const LEAST_TURN: i32 = 1 << 10;

/// Motion over the plane at one end of a tick.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct HeadingEnd {
    /// Velocity along the rows and across them, points of the grid a frame.
    pub(super) points: [f32; 2],
    /// Weights c², c s and s² of the direction (c, s).
    pub(super) directions: [f32; CURVATURES],
}

/// Weights c², c s and s² of the direction of a velocity.
pub(super) fn weights_of([x, y]: [f32; 2]) -> [f32; CURVATURES] {
    let square = x * x + y * y;
    if square > 0.0 { [x * x / square, x * y / square, y * y / square] } else { [1.0, 0.0, 0.0] }
}

/// Reader of a map along a path.
#[derive(Clone, Debug)]
pub(super) struct Plane<'k> {
    map: Map<'k>,
    points: [u32; 2],
    /// Place along the rows and across them, within the map.
    place: [Steps; 2],
    ways: [Way; 2],
    walks: [Walk; 2],
    directions: Directions,
    /// True if the direction stays over a tick, and the way from one reading to the next is below
    /// half a point.
    is_straight: bool,
}

impl<'k> Plane<'k> {
    /// Reads the map of a surface from its first point on; `None` for a profile.
    pub(super) fn new(surface: &Surface<'k>) -> Option<Self> {
        let map = surface.map()?;
        let points = map.points().map(|points| points as u32);
        let (ways, walks) = ([Way::default(); 2], [const { Walk::new() }; 2]);
        Some(Self {
            map,
            points,
            place: [0; 2],
            ways,
            walks,
            directions: [Ramp::default(); CURVATURES],
            is_straight: false,
        })
    }

    /// Number of points of the shorter side.
    pub(super) fn shorter(&self) -> u32 {
        let [columns, rows] = self.points;
        columns.min(rows)
    }

    /// Begins a tick, in which each frame is read once or twice.
    pub(super) fn begin(&mut self, [from, to]: &[HeadingEnd; 2], is_once: bool) {
        let ([from_x, from_y], [to_x, to_y]) = (from.points, to.points);
        self.ways = [[from_x, to_x], [from_y, to_y]].map(Way::new);
        let [from, to] = [from, to].map(|end| end.directions.map(|weight| fixed_from(weight, 30)));
        let slowest = if is_once { SLOWEST } else { 2.0 * SLOWEST };
        self.is_straight = [from_x, from_y, to_x, to_y].iter().all(|points| points.abs() <= slowest);
        for ((ramp, from), to) in self.directions.iter_mut().zip(from).zip(to) {
            if (to - from).abs() >= LEAST_TURN {
                self.is_straight = false;
            }
            *ramp = Ramp::new([from, to]);
        }
    }

    /// Mean of the limited curvature in a direction on top of that in all directions, 1/m, at the
    /// limit `column` of the table and at the next one.
    pub(super) fn means_per_m(&self, column: usize, directions: [f32; CURVATURES]) -> [f32; 2] {
        let waves = self.map.mean_waves_per_m();
        [column, column + 1].map(|column| waves.get(column).map_or(0.0, |waves| wave_sum(waves, directions)))
    }

    /// Goes on by a number of frames.
    pub(super) fn go_on(&mut self, frames: usize) {
        for ((place, way), points) in self.place.iter_mut().zip(&mut self.ways).zip(self.points) {
            *place = in_table(*place + way.go_on(frames), points);
        }
        self.directions.iter_mut().for_each(|direction| direction.go_on(frames));
    }

    /// Curvatures of the next frames in one of two segments, read in the middle of each frame.
    pub(super) fn read(&mut self, segment: (&Segments, &Pair, bool), work: &mut Work, values: &mut [i32]) {
        let begins = self.begins(segment);
        if !self.read_cells(begins, Way::middles, work, values) {
            work.places += values.len() as u32;
            self.walk(begins, 2, values);
        }
    }

    /// Curvatures of the next frames in one of two segments, read at a quarter and at three
    /// quarters of each frame.
    pub(super) fn read_twice(&mut self, segment: (&Segments, &Pair, bool), work: &mut Work, halves: &mut [i32]) {
        let begins = self.begins(segment);
        if self.read_cells(begins, Way::quarters, work, halves) {
            return;
        }
        work.places += halves.len() as u32;
        let (mut first, mut second) = ([0; TICK_FRAMES], [0; TICK_FRAMES]);
        let frames = halves.len() / 2;
        self.walk(begins, 1, first.get_mut(..frames).unwrap_or(&mut []));
        self.walk(begins, 3, second.get_mut(..frames).unwrap_or(&mut []));
        for ((halves, first), second) in halves.as_chunks_mut().0.iter_mut().zip(first).zip(second) {
            *halves = [first, second];
        }
    }

    /// Places in one of two segments.
    fn begins(&self, (segments, pair, is_second): (&Segments, &Pair, bool)) -> [Steps; 2] {
        let [x, y] = self.place;
        let offsets = segments.offset_in_map(pair.second - i64::from(!is_second), self.points);
        [x + offsets[0], y + offsets[1]]
    }

    /// Reads along courses, cell by cell, if the contact goes straight and slowly; gives true if it
    /// does.
    fn read_cells(
        &self,
        begins: [Steps; 2],
        course: fn(Way, Steps) -> Course,
        work: &mut Work,
        values: &mut [i32],
    ) -> bool {
        if !self.is_straight {
            return false;
        }
        let mut courses = [course(self.ways[0], begins[0]), course(self.ways[1], begins[1])];
        work.curvatures += values.len() as u32;
        for (course, points) in courses.iter_mut().zip(self.points) {
            work.add_way(course, values.len());
            course.place = in_table(course.place, points);
        }
        let weights = self.directions.map(|direction| direction.now() >> (30 - map::WEIGHT_BITS));
        map::read_cells(&self.map, courses, weights, values);
        true
    }

    /// Reads after some quarters of each frame, place by place.
    fn walk(&mut self, begins: [Steps; 2], quarters: i64, values: &mut [i32]) {
        let axes = self.walks.iter_mut().zip(self.ways).zip(begins).zip(self.points);
        for (((walk, way), begin), points) in axes {
            let (behind, way) = way.behind(quarters);
            walk.go(in_table(begin - behind, points), way.ends(), points as usize, values.len());
        }
        let [x, y] = &self.walks;
        map::read_map(&self.map, [x, y], self.directions, values);
    }
}

/// Sum of waves over the direction: cos 2θ, sin 2θ, cos 4θ, sin 4θ, cos 6θ and sin 6θ with their
/// factors.
fn wave_sum(waves: &[f32; 6], [c_square, c_s, s_square]: [f32; CURVATURES]) -> f32 {
    let [c2, s2] = [c_square - s_square, 2.0 * c_s];
    let [c4, s4] = [c2 * c2 - s2 * s2, 2.0 * c2 * s2];
    let [c6, s6] = [c4 * c2 - s4 * s2, s4 * c2 + c4 * s2];
    waves.iter().zip([c2, s2, c4, s4, c6, s6]).fold(0.0, |sum, (factor, wave)| sum + factor * wave)
}
