//! A map of known waves, and the law on it: a path over the plane, followed 32 times as fine as
//! the frames.

use std::f64::consts::{PI, TAU};

use dsp_core::scrape::{Contact, Motion};
use dsp_core::time::TICK_FRAMES;
use reference::scrape::{POINT, Segments, fade_curve};

use super::RATE;
use super::law::{OVERSAMPLING, Path};

/// Number of columns and rows of the map.
const SIZE: [usize; 2] = [96, 84];
/// Distance of the heights in metres.
const STEP_M: f64 = 20e-6;
/// Shortest wave in metres.
const SHORTEST_M: f64 = 62e-6;
/// Number of waves, and rms of their curvature in 1/m.
const WAVES: usize = 120;
const CURVATURE_RMS_PER_M: f64 = 400.0;

/// Wave on the plane: cycles along the map and across it, amplitude in metres, phase.
#[derive(Clone, Copy, Debug)]
struct Wave {
    cycles: [f64; 2],
    height_m: f64,
    phase: f64,
}

/// Sum of waves that is periodic in both directions.
#[derive(Clone, Debug)]
pub struct Waves(Vec<Wave>);

impl Default for Waves {
    fn default() -> Self {
        Self::new()
    }
}

impl Waves {
    /// Waves of all directions, down to the shortest one, of curvatures of one size.
    pub fn new() -> Self {
        // Weyl's sequence: steps of an irrational number spread evenly.
        let mut number = 0.5_f64;
        let mut random = || {
            number = (number + 0.754_877_666).fract();
            number
        };
        let lengths_m = SIZE.map(|size| size as f64 * STEP_M);
        let mut waves = Vec::new();
        while waves.len() < WAVES {
            let cycles = lengths_m.map(|length_m| ((2.0 * random() - 1.0) * length_m / SHORTEST_M).round());
            let per_m = (cycles[0] / lengths_m[0]).hypot(cycles[1] / lengths_m[1]);
            if per_m > 2.0 / lengths_m[0] && per_m <= 1.0 / SHORTEST_M {
                // Mean over directions of cos⁴ is 3/8, of cos² 1/2.
                let amplitude = CURVATURE_RMS_PER_M * (2.0 / (0.375 * WAVES as f64)).sqrt();
                waves.push(Wave { cycles, height_m: amplitude / (TAU * per_m).powi(2), phase: TAU * random() });
            }
        }
        Self(waves)
    }

    /// Surface of a kit with these heights.
    pub fn surface(&self, name: &str) -> kit::Surface {
        let [columns, rows] = SIZE;
        let height = |index: usize| {
            let place = [(index % columns) as f64 / columns as f64, (index / columns) as f64 / rows as f64];
            self.0.iter().map(|wave| wave.height_m * wave.angle(place).cos()).sum::<f64>()
        };
        let heights: Vec<f64> = (0..columns * rows).map(height).collect();
        let unit_m = heights.iter().fold(0.0_f64, |most, height| most.max(height.abs())) / 32_767.0;
        kit::Surface {
            name: name.into(),
            source: "sum of waves".into(),
            licence: "BSD-2-Clause".into(),
            step_m: STEP_M as f32,
            rows,
            unit_m: unit_m as f32,
            shortest_m: SHORTEST_M as f32,
            heights: heights.iter().map(|height| (height / unit_m).round() as i16).collect(),
        }
    }

    /// Curvature at a place, in parts of the map, in a direction.
    fn curvature_per_m(&self, place: [f64; 2], [c, s]: [f64; 2]) -> f64 {
        let lengths_m = SIZE.map(|size| size as f64 * STEP_M);
        let along = |wave: &Wave| TAU * (wave.cycles[0] / lengths_m[0] * c + wave.cycles[1] / lengths_m[1] * s);
        self.0.iter().map(|wave| -wave.height_m * along(wave).powi(2) * wave.angle(place).cos()).sum()
    }
}

impl Wave {
    fn angle(&self, place: [f64; 2]) -> f64 {
        TAU * (self.cycles[0] * place[0] + self.cycles[1] * place[1]) + self.phase
    }
}

/// Number of directions over half a turn at which the mean of the limited curvature is known.
const DIRECTIONS: usize = 64;

/// Law of a contact on the map with one limit.
#[derive(Clone, Debug)]
pub struct MapLaw<'w> {
    waves: &'w Waves,
    alpha_m: f64,
    segments: Segments,
    points: [usize; 2],
    grid_step_m: f64,
    /// Means over the map in [`DIRECTIONS`], 1/m.
    means_per_m: Vec<f64>,
}

impl<'w> MapLaw<'w> {
    /// Law of a contact with one limit α in metres.
    pub fn new(contact: &Contact<'_>, waves: &'w Waves, alpha_m: f64) -> Self {
        let points = contact.surface.map().expect("a map").points();
        let segments = Segments::in_map(points[0].min(points[1]) as u32, contact.seed.wrapping_mul(0x9e37_79b9));
        let grid_step_m = f64::from(contact.surface.grid_step_m());
        let mut law = Self { waves, alpha_m, segments, points, grid_step_m, means_per_m: Vec::new() };
        let mean = |direction: usize| {
            let (s, c) = (PI * direction as f64 / DIRECTIONS as f64).sin_cos();
            let side = 48;
            let at = |n: usize| law.limited([(n % side) as f64 / side as f64, (n / side) as f64 / side as f64], [c, s]);
            (0..side * side).map(at).sum::<f64>() / (side * side) as f64
        };
        law.means_per_m = (0..DIRECTIONS).map(mean).collect();
        law
    }

    fn limited(&self, place: [f64; 2], direction: [f64; 2]) -> f64 {
        (self.alpha_m * self.waves.curvature_per_m(place, direction)).tanh() / self.alpha_m
    }

    fn mean_per_m(&self, [c, s]: [f64; 2]) -> f64 {
        let place = s.atan2(c).rem_euclid(PI) / PI * DIRECTIONS as f64;
        let at = |n: usize| self.means_per_m[n % DIRECTIONS];
        at(place as usize) + place.fract() * (at(place as usize + 1) - at(place as usize))
    }

    /// Force in newtons at [`OVERSAMPLING`] times the rate.
    pub fn force(&self, contact: &Contact<'_>, motions: &[Motion]) -> Vec<f64> {
        let fine_s = 1.0 / (RATE.hz() * OVERSAMPLING as f64);
        let steps = (TICK_FRAMES * OVERSAMPLING) as f64;
        let lengths_m = SIZE.map(|size| size as f64 * STEP_M);
        let (mut path_m, mut place_m, mut from) = (0.0, [0.0; 2], [0.0; 2]);
        let (mut curvatures, mut speeds) = (Vec::new(), Vec::new());
        for motion in motions {
            let to = motion.velocity_m_per_s.map(f64::from);
            for fine in 0..TICK_FRAMES * OVERSAMPLING {
                let share = (fine as f64 + 0.5) / steps;
                let velocity = [0, 1].map(|axis| from[axis] + share * (to[axis] - from[axis]));
                let speed = velocity[0].hypot(velocity[1]);
                let direction = if speed > 0.0 { velocity.map(|v| v / speed) } else { [1.0, 0.0] };
                // The middle of the fine frame.
                let middle = [0, 1].map(|axis| place_m[axis] + 0.5 * fine_s * velocity[axis]);
                let at = self.segments.at(((path_m + 0.5 * fine_s * speed) / self.grid_step_m * POINT as f64) as i64);
                let read = |segment: i64| {
                    let offsets = self.segments.offset_in_map(segment, self.points);
                    let place = [0, 1].map(|axis| {
                        middle[axis] / lengths_m[axis] + offsets[axis] as f64 / POINT as f64 / self.points[axis] as f64
                    });
                    self.limited(place, direction) - self.mean_per_m(direction)
                };
                let own = read(at.segment);
                curvatures.push(
                    at.fade.map_or(own, |weight| {
                        own * fade_curve(1.0 - weight) + read(at.segment + 1) * fade_curve(weight)
                    }),
                );
                speeds.push(speed);
                path_m += fine_s * speed;
                place_m = [0, 1].map(|axis| place_m[axis] + fine_s * velocity[axis]);
            }
            from = to;
        }
        Path { curvatures, speeds, alpha_m: self.alpha_m, grid_step_m: self.grid_step_m }.force(contact)
    }
}
