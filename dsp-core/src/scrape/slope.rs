//! Rise of the path's slope in each frame, `∫ S'' dx`: the curvature of the surface, limited by
//! `S'' = tanh(α z'')/α` (scraping-rolling eq. 4 to 7).

use super::kernel::slope::{Mix, read_rises};
use super::kernel::{self, Course, Limited};
use super::path::{Pair, Segments, Steps};
use super::plane::{HeadingEnd, Plane};
use super::way::Way;
use super::work::Work;
use crate::fixed;
use crate::table::Surface;
use crate::table::layout::OCTAVES;
use crate::time::TICK_FRAMES;

/// Steps of the grid a frame up to which the curvature is read once a frame: from one place to the
/// next the way must be below half a step.
const ONCE_STEPS: f32 = 0.49;
/// Steps of the grid a frame up to which a map is read once. Read twice at an eighth of a wave a
/// frame, the largest error of a third octave is 0.75 dB instead of 1.34.
const MAP_ONCE_STEPS: f32 = 0.25;
/// Steps of the grid a frame up to which it is read twice. From there on the slope is read, from
/// the octave whose points lie 1/0.9 to 2/0.9 = 1.1 to 2.2 to two frames apart.
const TWICE_STEPS: f32 = 0.9;

/// Way of reading a surface over a tick.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Reading {
    /// Curvature in the middle of each frame, limited as it is read.
    Once,
    /// Curvature at a quarter and at three quarters of each frame.
    Twice,
    /// Slope at both ends of each frame, in an octave of the table.
    Octave(usize),
}

impl Reading {
    /// Way for a tick whose largest speed is given in steps a frame, on a map or a profile. Maps
    /// have no slopes: the slope at a place depends on the path that has led there.
    pub(super) fn of(steps: f32, is_map: bool) -> Self {
        if steps <= if is_map { MAP_ONCE_STEPS } else { ONCE_STEPS } {
            return Self::Once;
        }
        if steps <= TWICE_STEPS || is_map {
            return Self::Twice;
        }
        let octave = ((steps * (1.0 / TWICE_STEPS)).to_bits() >> 23) as usize;
        Self::Octave(octave.saturating_sub(127).min(OCTAVES - 1))
    }

    /// Variance in square frames of the mean that the reading takes over each frame.
    pub(super) const fn variance(self) -> f32 {
        match self {
            Self::Once => 0.0,
            Self::Twice => 1.0 / 16.0,
            Self::Octave(_) => 1.0 / 12.0,
        }
    }
}

/// Speeds and limits at the ends of a tick.
#[derive(Clone, Copy, Debug)]
pub(super) struct Ends {
    /// Speed along the surface, steps of the grid a frame; negative backwards.
    pub(super) steps: [f32; 2],
    /// Limit α in metres.
    pub(super) alpha_m: [f32; 2],
    /// Motion over the plane, which maps need.
    pub(super) heading: [HeadingEnd; 2],
}

/// Preparation of a tick, by its way of reading.
#[derive(Clone, Debug)]
enum Tick {
    Once(Limited),
    Twice(Limited),
    /// Octave, first of two limits, and their mix.
    Octave(usize, usize, Mix),
}

/// Reader of a surface along a path.
#[derive(Clone, Debug)]
pub(super) struct Slope<'k> {
    surface: Surface<'k>,
    segments: Segments,
    place: Steps,
    /// Place on a map.
    plane: Option<Plane<'k>>,
    between: Between,
    /// Segments of the last block.
    pair: Pair,
    /// Work of the last tick.
    work: Work,
}

impl<'k> Slope<'k> {
    /// Reader at rest; [`Slope::begin`] must follow.
    pub(super) const fn new(surface: Surface<'k>) -> Self {
        let segments = Segments::new(0, 0);
        Self { surface, segments, place: 0, plane: None, between: Between::NONE, pair: Pair::NONE, work: Work::NONE }
    }

    /// Begins to read a surface from place 0.
    pub(super) fn begin(&mut self, surface: Surface<'k>, seed: u32) {
        (self.surface, self.place, self.work) = (surface, 0, Work::NONE);
        self.between = Between::new(&surface);
        self.plane = Plane::new(&surface);
        self.segments = match &self.plane {
            Some(plane) => Segments::in_map(plane.shorter(), seed),
            None => Segments::new(surface.grid_points() as u32, seed),
        };
        self.pair = Pair::NONE;
    }

    /// Goes on over a tick.
    ///
    /// Gives the rise of the slope in each frame, Q31 of `unit`, within ±2^30.
    pub(super) fn render(&mut self, ends: Ends, reading: Reading, unit: f32, rises: &mut [i32; TICK_FRAMES]) {
        self.work = Work::NONE;
        let mut way = Way::new(ends.steps);
        let largest = way.largest();
        let block = self.segments.block(largest);
        let mut tick = self.prepared(&ends, reading, unit);
        if let Some(plane) = &mut self.plane {
            plane.begin(&ends.heading, reading == Reading::Once);
        }
        for rises in rises.chunks_mut(block) {
            self.block(&mut tick, way, largest, rises);
            self.place += way.go_on(rises.len());
            if let Some(plane) = &mut self.plane {
                plane.go_on(rises.len());
            }
        }
    }

    /// Work of the last tick.
    pub(super) const fn work(&self) -> Work {
        self.work
    }

    /// Rises of a block of frames from the place on.
    fn block(&mut self, tick: &mut Tick, way: Way, largest: i64, rises: &mut [i32]) {
        let mut behind = way;
        let end = self.place + behind.go_on(rises.len());
        let is_turning = (way.speed + way.step < 0) != (behind.speed < 0);
        let between = if rises.len() == 1 {
            // A single frame may go over several segments; it counts for that of its middle.
            [self.place + ((way.speed + way.step) >> 1); 2]
        } else if is_turning {
            let distance = largest * rises.len() as i64;
            [self.place - distance, self.place + distance]
        } else {
            [self.place.min(end), self.place.max(end)]
        };
        let pair = self.segments.nearest(between[0], &self.pair);
        self.pair = pair;
        match pair.only(between) {
            Some(only) => self.read(tick, (&pair, only == 1), way, rises),
            None => {
                self.read(&mut tick.clone(), (&pair, true), way, rises);
                let mut others = [0; TICK_FRAMES];
                others.iter_mut().zip(rises.iter()).for_each(|(other, rise)| *other = *rise);
                self.read(tick, (&pair, false), way, rises);
                self.fade(&pair, way.ends(), rises, &others);
            }
        }
    }

    /// Fades rises in one segment into those in the next.
    fn fade(&mut self, pair: &Pair, [mut speed, step]: [i64; 2], rises: &mut [i32], others: &[i32]) {
        self.work.fades += rises.len() as u32;
        let mut place = self.place;
        for (rise, other) in rises.iter_mut().zip(others) {
            speed += step;
            *rise = faded(*rise, *other, pair.weight(place + (speed >> 1)));
            place += speed;
        }
    }

    /// Rises of a block in one of two segments.
    fn read(&mut self, tick: &mut Tick, segment: (&Pair, bool), way: Way, rises: &mut [i32]) {
        let frames = rises.len() as u32;
        self.work.blocks += 1;
        match tick {
            Tick::Once(limited) => {
                match &mut self.plane {
                    Some(plane) => plane.read((&self.segments, segment.0, segment.1), &mut self.work, rises),
                    None => self.curvatures(way.middles(self.place + segment.0.offset(segment.1)), rises),
                }
                kernel::limit(limited, rises);
            }
            Tick::Twice(limited) => {
                let mut halves = [0; 2 * TICK_FRAMES];
                let Some(halves) = halves.get_mut(..2 * rises.len()) else { return };
                match &mut self.plane {
                    Some(plane) => plane.read_twice((&self.segments, segment.0, segment.1), &mut self.work, halves),
                    None => self.curvatures(way.quarters(self.place + segment.0.offset(segment.1)), halves),
                }
                kernel::limit_halves(limited, halves, rises);
            }
            Tick::Octave(octave, column, mix) => {
                self.work.slopes += frames;
                let points = self.surface.grid_points() >> *octave;
                let place = self.segments.in_table(self.place + segment.0.offset(segment.1)) >> *octave;
                let strides = way.strides(place, *octave, points);
                read_rises((self.surface.slopes(*octave), points, *column), strides, mix, rises);
            }
        }
    }

    /// Curvatures along a course on a profile.
    fn curvatures(&mut self, course: Course, values: &mut [i32]) {
        self.work.add_course(&course, values.len());
        let course = Course { place: self.segments.in_table(course.place), ..course };
        kernel::read(self.surface.curvature(), self.surface.grid_points(), course, values);
    }

    fn prepared(&self, ends: &Ends, reading: Reading, unit: f32) -> Tick {
        let inverse = ends.alpha_m.map(|alpha_m| 1.0 / alpha_m);
        let (column, shares) = self.between(ends.alpha_m, inverse);
        if let Reading::Octave(octave) = reading {
            let gain = self.surface.mix_gain().get(column).copied().unwrap_or(0.0);
            let first = shares.map(|s| (1.0 - s) * (1.0 + gain * s));
            let second = shares.map(|s| s * (1.0 + gain * (1.0 - s)));
            return Tick::Octave(octave, column, Mix::new(&self.surface, column, [first, second], unit));
        }
        let metres = self.surface.grid_step_m() / unit;
        let [from, to] = ends.steps;
        let rise = [from * metres * inverse[0], to * metres * inverse[1]];
        // The mean belongs to no wave of the surface: path and slope would drift with it.
        let means = self.surface.mean_per_m();
        let mean = |column: usize| means.get(column).copied().unwrap_or(0.0);
        let mut mean = shares.map(|share| mean(column) + share * (mean(column + 1) - mean(column)));
        if let Some(plane) = &self.plane {
            for ((mean, share), end) in mean.iter_mut().zip(shares).zip(&ends.heading) {
                let [first, second] = plane.means_per_m(column, end.directions);
                *mean += first + share * (second - first);
            }
        }
        let mean = 0.5 * metres * (from * mean[0] + to * mean[1]);
        let limited = Limited::new(&self.surface, ends.alpha_m, rise, mean);
        if reading == Reading::Twice { Tick::Twice(limited) } else { Tick::Once(limited) }
    }

    /// First of the two limits of the table between which limits lie, and the share of the second
    /// one at each: straight lines over the limits' inverses, the largest curvatures.
    fn between(&self, alpha_m: [f32; 2], inverse: [f32; 2]) -> (usize, [f32; 2]) {
        let Between { twice_m, low, scale } = self.between;
        let column = usize::from(alpha_m[0] + alpha_m[1] > twice_m);
        let (low, scale) = if column == 0 { (low[0], scale[0]) } else { (low[1], scale[1]) };
        (column, inverse.map(|inverse| ((low - inverse) * scale).clamp(-1.0, 2.0)))
    }
}

/// Numbers of a table's limits that give the share of each.
#[derive(Clone, Copy, Debug)]
struct Between {
    /// Twice the middle limit, in metres.
    twice_m: f32,
    /// Inverse of the lower of two neighbouring limits, and of the distance of their inverses.
    low: [f32; 2],
    scale: [f32; 2],
}

impl Between {
    const NONE: Self = Self { twice_m: 0.0, low: [0.0; 2], scale: [0.0; 2] };

    fn new(surface: &Surface<'_>) -> Self {
        let [least, middle, most] = surface.alpha_m().map(|alpha_m| 1.0 / alpha_m);
        let twice_m = 2.0 * surface.alpha_m()[1];
        Self { twice_m, low: [least, middle], scale: [1.0 / (least - middle), 1.0 / (middle - most)] }
    }
}

/// Mix of two independent signals that keeps the power within 0.3 dB: weights `s(1 - w)` and
/// `s(w)` with `s(w) = (3w - w³)/2`.
#[inline(always)]
fn faded(own: i32, next: i32, weight: i32) -> i32 {
    let curve = |w: i32| {
        let cube = fixed::times_q31(fixed::times_q31(w, w), w);
        // At most 1.0 as Q30.
        ((3 * (i64::from(w) >> 2)) - (i64::from(cube) >> 2)) as i32
    };
    // Each value is below 2^30, and the weights sum up to 1.38 at most.
    (fixed::smmul(own, curve(i32::MAX - weight)) + fixed::smmul(next, curve(weight))) << 2
}
