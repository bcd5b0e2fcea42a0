//! Rise of the path's slope in each frame.
//!
//! A slow contact reads the curvature in the middle of the frame, or at a quarter and at three
//! quarters. A fast one takes the difference of the slope at both ends, from the octave
//! whose points lie about a frame apart.

use super::path::{POINT, Segments};
use super::plane::{Heading, Tick};
use super::surface::Surface;
use super::{TICK_FRAMES, ramp};

/// Points a frame up to which the curvature is read once, and twice.
const ONCE_POINTS: f32 = 0.49;
const TWICE_POINTS: f32 = 0.9;
/// Width of the smoothing, as a standard deviation in points of the next octave, from which on
/// that octave is read. By the same rule the first octave is read instead of the curvature.
const SMOOTHED_POINTS: f32 = 2.0;
/// Points a frame up to which a map is read once; above it is read twice at any speed.
const MAP_ONCE_POINTS: f32 = 0.25;

/// Way of reading a surface over a tick.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Reading {
    Once,
    Twice,
    Octave(usize),
}

impl Reading {
    /// Way for a tick whose largest speed is given in points a frame, on a map or a profile, with
    /// the standard deviation of its smoothing in frames.
    pub(super) fn of(points: f32, is_map: bool, deviation: f32) -> Self {
        if points <= if is_map { MAP_ONCE_POINTS } else { ONCE_POINTS } {
            Self::Once
        } else if is_map {
            Self::Twice
        } else {
            // -1 where the curvature is read.
            let octave = (points * (1.0 / TWICE_POINTS)).log2().floor() as i32;
            let is_smoothed = points * 2f32.powi(-octave - 1) * deviation >= SMOOTHED_POINTS;
            match octave + i32::from(is_smoothed) {
                ..0 => Self::Twice,
                octave => Self::Octave((octave as usize).min(6)),
            }
        }
    }

    /// Variance in square frames of the mean that the reading takes over a frame.
    pub(super) fn variance(self) -> f64 {
        match self {
            Self::Once => 0.0,
            Self::Twice => 1.0 / 16.0,
            Self::Octave(_) => 1.0 / 12.0,
        }
    }
}

/// Reader of a surface along a path.
#[derive(Clone, Debug)]
pub(super) struct Slope {
    surface: Surface,
    segments: Segments,
    place: i64,
    plane: [i64; 2],
}

impl Slope {
    pub(super) fn new(surface: Surface, seed: u32) -> Self {
        let segments = match &surface.map {
            Some(map) => Segments::in_map(map.points[0].min(map.points[1]) as u32, seed),
            None => Segments::new(surface.curvature.len() as u32, seed),
        };
        Self { surface, segments, place: 0, plane: [0; 2] }
    }

    /// Goes on over a tick, with speeds in points a frame and limits in metres at its ends.
    pub(super) fn render(
        &mut self,
        (points, heading): ([f32; 2], &Heading),
        alpha_m: [f64; 2],
        reading: Reading,
    ) -> [f64; TICK_FRAMES] {
        let mut plane = Tick::new(heading);
        let [from, to] = points.map(|points| (points * POINT as f32) as i64);
        let step = (to - from) / TICK_FRAMES as i64;
        // Each frame goes on by its mean speed.
        let mut speed = from - (step >> 1);
        let metres = self.surface.grid_step_m;
        let limits: Vec<f64> = ramp(alpha_m[0], alpha_m[1]).collect();
        // The largest rise goes in a straight line over the tick.
        let largest: Vec<f64> =
            ramp(f64::from(points[0]) * metres / alpha_m[0], f64::from(points[1]) * metres / alpha_m[1]).collect();
        let column = usize::from(0.5 * (alpha_m[0] + alpha_m[1]) > self.surface.alpha_m[1]);
        let [low, high] = [self.surface.alpha_m[column], self.surface.alpha_m[column + 1]];
        let share = |alpha_m: f64| ((1.0 / low - 1.0 / alpha_m) / (1.0 / low - 1.0 / high)).clamp(-1.0, 2.0);
        let gain = self.surface.mix_gain[column];
        let weights = alpha_m.map(share).map(|s| [(1.0 - s) * (1.0 + gain * s), s * (1.0 + gain * (1.0 - s))]);
        // One mix for the tick.
        let [own, other] = [0, 1].map(|which| 0.5 * (weights[0][which] + weights[1][which]));
        let mean = |end: usize| {
            let means = &self.surface.mean_per_m;
            let at = |column: usize| {
                let waves = self.surface.map.as_ref().map(|map| map.mean_at(column, heading.directions[end]));
                means[column] + waves.unwrap_or(0.0)
            };
            let mean = at(column) + share(alpha_m[end]) * (at(column + 1) - at(column));
            f64::from(points[end]) * metres * mean
        };
        // One for the tick.
        let mean = 0.5 * (mean(0) + mean(1));
        std::array::from_fn(|frame| {
            speed += step;
            let begin = self.place;
            self.place += speed;
            let at = self.segments.at(begin + (speed >> 1));
            let in_plane = self.plane;
            self.plane = plane.go_on(in_plane);
            // A place some quarters of the frame behind its begin, in this segment or the next.
            let limited = |next: usize, quarters: i64| {
                let curvature = match &self.surface.map {
                    Some(map) => {
                        let segment = (&self.segments, at.segment + next as i64);
                        plane.curvature(map, segment, (in_plane, quarters, frame))
                    }
                    None => {
                        let part = speed - ((speed * (4 - quarters)) >> 2);
                        self.surface.curvature_at(self.segments.in_table(begin + part + at.offsets[next]))
                    }
                };
                // The mean belongs to no wave of the surface: path and slope would drift with it.
                (limits[frame] * curvature).tanh() * largest[frame] - mean
            };
            let risen = |offset: i64, octave: usize| {
                let difference = |limit| {
                    let value = |place| self.surface.slope_at(octave, limit, self.segments.in_table(place + offset));
                    value(self.place) - value(begin)
                };
                own * difference(column) + other * difference(column + 1)
            };
            let read = |next: usize| match reading {
                Reading::Once => limited(next, 2),
                Reading::Twice => 0.5 * (limited(next, 1) + limited(next, 3)),
                Reading::Octave(octave) => risen(at.offsets[next], octave),
            };
            let here = read(0);
            at.fade.map_or(here, |weight| here * fade_curve(1.0 - weight) + read(1) * fade_curve(weight))
        })
    }
}

/// Weight of a segment that fades in by a weight from 0 to 1: two independent ones keep
/// their power within 0.3 dB.
pub fn fade_curve(weight: f64) -> f64 {
    0.5 * (3.0 * weight - weight.powi(3))
}
