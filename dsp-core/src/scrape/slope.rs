//! Rise of the path's slope in each frame, `∫ S'' dx`: the curvature of the surface, limited by
//! `S'' = tanh(α z'')/α` (scraping-rolling eq. 4 to 7).

use super::kernel::slope::{self, Mix};
use super::kernel::{self, Course, Limited};
use super::path::{Pair, Segments, Steps};
use super::plane::{HeadingEnd, Plane};
use super::ramp::{exponent, power_of_two};
use super::way::Way;
use super::work::Work;
use crate::fixed;
use crate::table::Surface;
use crate::table::layout::{LIMITS, OCTAVES};
use crate::time::TICK_FRAMES;

/// Steps of the grid a frame up to which the curvature is read once a frame: from one place to the
/// next the way must be below half a step.
const ONCE_STEPS: f32 = 0.49;
/// Steps of the grid a frame up to which a map is read once. Read twice at an eighth of a wave a
/// frame, the largest error of a third octave is 0.75 dB instead of 1.34.
const MAP_ONCE_STEPS: f32 = 0.25;
/// Steps of the grid a frame up to which it is read twice. From there on the slope is read, from
/// the octave of which a frame goes over 0.9 to 1.8 points.
const TWICE_STEPS: f32 = 0.9;
/// Width of the smoothing, as a standard deviation in points of the next octave, from which on
/// that octave is read. It lacks waves of less than two points, which such a smoothing removes.
/// By the same rule the first octave is read instead of the curvature.
///
/// Read from 1.3 points on, a third of an octave was 8 dB off, from 1.9 points on 1.3 dB.
const SMOOTHED_POINTS: f32 = 2.0;

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
    /// Way for a tick whose largest speed is given in steps a frame, on a map or a profile, with
    /// the standard deviation of its smoothing in frames. Maps have no slopes: the slope at a place
    /// depends on the path that has led there.
    pub(super) fn of(steps: f32, is_map: bool, deviation: f32) -> Self {
        if steps <= if is_map { MAP_ONCE_STEPS } else { ONCE_STEPS } {
            return Self::Once;
        }
        if is_map {
            return Self::Twice;
        }
        // -1 where the curvature is read.
        let octave = exponent(steps * (1.0 / TWICE_STEPS));
        let is_smoothed = steps * power_of_two(-octave - 1) * deviation >= SMOOTHED_POINTS;
        match octave + i32::from(is_smoothed) {
            ..0 => Self::Twice,
            octave => Self::Octave((octave as usize).min(OCTAVES - 1)),
        }
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
#[derive(Clone, Debug)]
pub(super) struct Ends {
    /// Speed along the surface, steps of the grid a frame; negative backwards.
    pub(super) steps: [f32; 2],
    /// Limit α in metres.
    pub(super) alpha_m: [f32; 2],
    /// Motion over the plane, which maps need.
    pub(super) heading: Option<[HeadingEnd; 2]>,
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
    numbers: Numbers,
    /// Limit in metres at the end of the last tick, and its inverse.
    last: [f32; 2],
    /// Segments of the last block.
    pair: Pair,
    /// Work of the last tick.
    work: Work,
}

impl<'k> Slope<'k> {
    /// Reader at rest; [`Slope::begin`] must follow.
    pub(super) const fn new(surface: Surface<'k>) -> Self {
        let segments = Segments::new(0, 0);
        Self {
            surface,
            segments,
            place: 0,
            plane: None,
            numbers: Numbers::NONE,
            last: [0.0; 2],
            pair: Pair::NONE,
            work: Work::NONE,
        }
    }

    /// Begins to read a surface from place 0.
    pub(super) fn begin(&mut self, surface: Surface<'k>, seed: u32) {
        (self.surface, self.place, self.work) = (surface, 0, Work::NONE);
        (self.numbers, self.last) = (Numbers::new(&surface), [0.0; 2]);
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
    pub(super) fn render(&mut self, ends: &Ends, reading: Reading, unit: f32, rises: &mut [i32; TICK_FRAMES]) {
        self.work = Work::NONE;
        let mut way = Way::new(ends.steps);
        let largest = way.largest();
        let block = self.segments.block(largest);
        let mut tick = self.prepared(ends, reading, unit);
        if let (Some(plane), Some(heading)) = (&mut self.plane, &ends.heading) {
            plane.begin(heading, reading == Reading::Once);
        }
        for rises in rises.chunks_mut(block) {
            self.place = self.block(&mut tick, &mut way, largest, rises);
            if let Some(plane) = &mut self.plane {
                plane.go_on(rises.len());
            }
        }
    }

    /// Work of the last tick.
    pub(super) const fn work(&self) -> Work {
        self.work
    }

    /// Rises of a block of frames from the place on; gives the place behind it.
    fn block(&mut self, tick: &mut Tick, behind: &mut Way, largest: i64, rises: &mut [i32]) -> Steps {
        let way = *behind;
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
        self.segments.go_nearest(between[0], &mut self.pair);
        match self.pair.only(between) {
            Some(only) => self.read(tick, only == 1, way, rises),
            None => self.read_both(tick, way, rises),
        }
        end
    }

    /// Rises of a block in which one segment fades into the next.
    #[inline(never)] // its buffer must not weigh on other blocks
    fn read_both(&mut self, tick: &mut Tick, way: Way, rises: &mut [i32]) {
        let mut others = [0; TICK_FRAMES];
        let Some(others) = others.get_mut(..rises.len()) else { return };
        self.read(&mut tick.clone(), true, way, others);
        self.read(tick, false, way, rises);
        self.fade(way.ends(), rises, others);
    }

    /// Fades rises in one segment into those in the next.
    fn fade(&mut self, [mut speed, step]: [i64; 2], rises: &mut [i32], others: &[i32]) {
        self.work.fades += rises.len() as u32;
        let (mut place, pair) = (self.place, self.pair);
        for (rise, other) in rises.iter_mut().zip(others) {
            speed += step;
            *rise = faded(*rise, *other, pair.weight(place + (speed >> 1)));
            place += speed;
        }
    }

    /// Rises of a block in the second of two segments, or in the first.
    fn read(&mut self, tick: &mut Tick, is_second: bool, way: Way, rises: &mut [i32]) {
        let frames = rises.len() as u32;
        self.work.blocks += 1;
        match tick {
            Tick::Once(limited) => {
                match &mut self.plane {
                    Some(plane) => plane.read((&self.segments, &self.pair, is_second), &mut self.work, rises),
                    None => self.curvatures(way.middles(self.place + self.pair.offset(is_second)), rises),
                }
                kernel::limit(limited, rises);
            }
            Tick::Twice(limited) => {
                let mut halves = [0; 2 * TICK_FRAMES];
                let Some(halves) = halves.get_mut(..2 * rises.len()) else { return };
                match &mut self.plane {
                    Some(plane) => plane.read_twice((&self.segments, &self.pair, is_second), &mut self.work, halves),
                    None => self.curvatures(way.quarters(self.place + self.pair.offset(is_second)), halves),
                }
                kernel::limit_halves(limited, halves, rises);
            }
            Tick::Octave(octave, column, mix) => {
                self.work.slopes += frames;
                let (table, points) = (self.surface.slopes(*octave), self.surface.grid_points() >> *octave);
                let place = self.segments.in_table(self.place + self.pair.offset(is_second)) >> *octave;
                let strides = way.strides(place, *octave, points);
                slope::read_rises(slope::Octave { table, points, column: *column }, strides, mix, rises);
            }
        }
    }

    /// Curvatures along a course on a profile.
    fn curvatures(&mut self, course: Course, values: &mut [i32]) {
        self.work.add_course(&course, values.len());
        let course = Course { place: self.segments.in_table(course.place), ..course };
        kernel::read(self.surface.curvature(), self.surface.grid_points(), course, values);
    }

    fn prepared(&mut self, ends: &Ends, reading: Reading, unit: f32) -> Tick {
        let [from_m, to_m] = ends.alpha_m;
        let [last_m, last_inverse] = self.last;
        // Most ticks begin where the one before has ended.
        let inverse = [if from_m == last_m { last_inverse } else { 1.0 / from_m }, 1.0 / to_m];
        self.last = [to_m, inverse[1]];
        let numbers = &self.numbers;
        let column = usize::from(from_m + to_m > numbers.twice_m);
        let Some(between) = numbers.between.get(column) else { return Tick::Octave(0, 0, Mix::NONE) };
        // Straight lines over the limits' inverses, the largest curvatures.
        let shares = inverse.map(|inverse| ((between.low - inverse) * between.scale).clamp(-1.0, 2.0));
        if let Reading::Octave(octave) = reading {
            let gain = between.gain;
            // One mix for the tick.
            let first = shares.map(|s| (1.0 - s) * (1.0 + gain * s));
            let second = shares.map(|s| s * (1.0 + gain * (1.0 - s)));
            let weights = [first, second].map(|[from, to]| 0.5 * (from + to));
            return Tick::Octave(octave, column, Mix::new(between.slope_units, weights, unit));
        }
        let metres = numbers.step_m / unit;
        let [from, to] = ends.steps;
        let rise = [from * metres * inverse[0], to * metres * inverse[1]];
        // The mean belongs to no wave of the surface: path and slope would drift with it.
        let mut mean = shares.map(|share| between.mean + share * between.mean_rise);
        if let (Some(plane), Some(heading)) = (&self.plane, &ends.heading) {
            for ((mean, share), end) in mean.iter_mut().zip(shares).zip(heading) {
                let [first, second] = plane.means_per_m(column, end.directions);
                *mean += first + share * (second - first);
            }
        }
        let mean = 0.5 * metres * (from * mean[0] + to * mean[1]);
        let limited = Limited::new(numbers.curvature_unit, ends.alpha_m, rise, mean);
        if reading == Reading::Twice { Tick::Twice(limited) } else { Tick::Once(limited) }
    }
}

/// Numbers of a surface that each tick needs.
#[derive(Clone, Copy, Debug)]
struct Numbers {
    /// Distance of the grid's points in metres.
    step_m: f32,
    /// Curvature of one in a spline's value, 1/m.
    curvature_unit: f32,
    /// Twice the middle limit, in metres.
    twice_m: f32,
    between: [Between; LIMITS - 1],
}

/// Numbers of two neighbouring limits of a table.
#[derive(Clone, Copy, Debug)]
struct Between {
    /// Inverse of the lower limit, and one over the distance of both inverses.
    low: f32,
    scale: f32,
    /// Mean curvature at the lower limit, 1/m, and what that at the higher one is above it.
    mean: f32,
    mean_rise: f32,
    /// Gain by which a mix of the slopes falls short.
    gain: f32,
    /// Slope of one in a spline's value at both limits.
    slope_units: [f32; 2],
}

impl Numbers {
    const NONE: Self = Self { step_m: 0.0, curvature_unit: 0.0, twice_m: 0.0, between: [Between::NONE; LIMITS - 1] };

    fn new(surface: &Surface<'_>) -> Self {
        let (alpha_m, means, gains) = (surface.alpha_m(), surface.mean_per_m(), surface.mix_gain());
        let units = surface.slope_unit().map(|unit| unit * (1.0 / slope::ONE as f32));
        let [low, middle, high] = alpha_m.map(|alpha_m| 1.0 / alpha_m);
        let between = |low: f32, high: f32, means: [f32; 2], gain: f32, slope_units: [f32; 2]| Between {
            low,
            scale: 1.0 / (low - high),
            mean: means[0],
            mean_rise: means[1] - means[0],
            gain,
            slope_units,
        };
        let one = if surface.rows() > 1 { kernel::map::MAP_ONE } else { kernel::ONE };
        Self {
            step_m: surface.grid_step_m(),
            curvature_unit: surface.curvature_unit_per_m() * (1.0 / one as f32),
            twice_m: 2.0 * alpha_m[1],
            between: [
                between(low, middle, [means[0], means[1]], gains[0], [units[0], units[1]]),
                between(middle, high, [means[1], means[2]], gains[1], [units[1], units[2]]),
            ],
        }
    }
}

impl Between {
    const NONE: Self = Self { low: 0.0, scale: 0.0, mean: 0.0, mean_rise: 0.0, gain: 0.0, slope_units: [0.0; 2] };
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
