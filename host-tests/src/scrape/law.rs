//! The law itself: a path over the surface's heights, followed 32 times as fine as the frames, and
//! beside it the way in which ThreeDWorld reads a profile.
//!
//! Heights are a sum of sines, whose curvature is exact. It is limited by `tanh` 64 times between
//! heights. Limits must be constant.

use dsp_core::scrape::{Contact, Motion};
use dsp_core::time::TICK_FRAMES;
use fourier::Complex;
use reference::scrape::{LEAK_POINTS, POINT, Segments, fade_curve};

use super::RATE;

/// Fine frames in a frame.
pub const OVERSAMPLING: usize = 32;
/// Fine points between two heights.
const FINE: usize = 64;

/// Limited curvature `S''` of a surface on a fine grid, 1/m.
#[derive(Clone, Debug)]
pub struct Law {
    limited: Vec<f64>,
    alpha_m: f64,
    length_m: f64,
    segments: Segments,
    grid_step_m: f64,
}

impl Law {
    /// Law of a contact with one limit α in metres.
    pub fn new(contact: &Contact<'_>, alpha_m: f64) -> Self {
        let surface = contact.surface;
        let unit_m = f64::from(surface.unit_m());
        let heights: Vec<f64> = surface.heights().iter().map(|height| f64::from(height.get()) * unit_m).collect();
        let length_m = heights.len() as f64 * f64::from(surface.step_m());
        let mut limited: Vec<f64> =
            curvature(heights, length_m).into_iter().map(|z| (alpha_m * z).tanh() / alpha_m).collect();
        // The mean belongs to no wave.
        let mean = limited.iter().sum::<f64>() / limited.len() as f64;
        limited.iter_mut().for_each(|limited| *limited -= mean);
        let points = surface.grid_points();
        let segments = Segments::new(points as u32, contact.seed.wrapping_mul(0x9e37_79b9));
        Self { limited, alpha_m, length_m, segments, grid_step_m: length_m / points as f64 }
    }

    /// `S''` at a place in metres, by straight lines of the fine grid.
    fn at(&self, place_m: f64) -> f64 {
        let place = place_m / self.length_m * self.limited.len() as f64;
        let (index, within) = (place.floor(), place - place.floor());
        let value = |offset: usize| self.limited[(index as usize + offset) % self.limited.len()];
        value(0) + within * (value(1) - value(0))
    }

    /// Force in newtons at [`OVERSAMPLING`] times the rate: `m S'' v² + β1 |v S'|^β2`, smoothed as
    /// the contact says.
    pub fn force(&self, contact: &Contact<'_>, motions: &[Motion]) -> Vec<f64> {
        let mut curvatures = Vec::with_capacity(motions.len() * TICK_FRAMES * OVERSAMPLING);
        let mut speeds = Vec::with_capacity(curvatures.capacity());
        let mut place = 0.0;
        for speed in speeds_of(motions) {
            for fine in 0..OVERSAMPLING {
                let steps = speed / RATE.hz() / self.grid_step_m;
                let now = place + steps * (fine as f64 + 0.5) / OVERSAMPLING as f64;
                curvatures.push(self.faded(now));
                speeds.push(speed);
            }
            place += speed / RATE.hz() / self.grid_step_m;
        }
        Path { curvatures, speeds, alpha_m: self.alpha_m, grid_step_m: self.grid_step_m }.force(contact)
    }

    /// `S''` at a place of the path in points of the grid.
    fn faded(&self, points: f64) -> f64 {
        let place = (points * POINT as f64) as i64;
        let at = self.segments.at(place);
        let read = |offset| self.at(self.segments.in_table(place + offset) * self.grid_step_m);
        let own = read(at.offsets[0]);
        at.fade.map_or(own, |weight| own * fade_curve(1.0 - weight) + read(at.offsets[1]) * fade_curve(weight))
    }

    /// Vertical force as ThreeDWorld would read this surface at a constant speed: the heights'
    /// second differences by straight lines at the frames, then `tanh`, then the smoothing.
    pub fn by_straight_lines(&self, contact: &Contact<'_>, motions: &[Motion]) -> Vec<f64> {
        let surface = contact.surface;
        let (unit_m, step_m) = (f64::from(surface.unit_m()), f64::from(surface.step_m()));
        let heights: Vec<f64> = surface.heights().iter().map(|height| f64::from(height.get()) * unit_m).collect();
        let points = heights.len();
        let difference = |n: usize| heights[(n + 1) % points] - 2.0 * heights[n] + heights[(n + points - 1) % points];
        let second: Vec<f64> = (0..points).map(|n| difference(n) / (step_m * step_m)).collect();
        let mut place_m = 0.0;
        let mut rises = Vec::new();
        let speeds: Vec<f64> = speeds_of(motions).collect();
        for speed in &speeds {
            place_m += speed / RATE.hz();
            let place = (place_m / step_m).rem_euclid(points as f64);
            let (index, within) = (place as usize % points, place.fract());
            let curvature = second[index] + within * (second[(index + 1) % points] - second[index]);
            rises.push((self.alpha_m * curvature).tanh() / self.alpha_m * speed);
        }
        smooth(&mut rises, f64::from(contact.smoothing_s) * RATE.hz() * self.alpha_m / mean_alpha_m(contact));
        rises.iter().zip(&speeds).map(|(rise, speed)| f64::from(contact.mass_kg) * rise * speed).collect()
    }
}

/// Limited curvature `S''` in 1/m and speed in m/s along a path, at [`OVERSAMPLING`] times the
/// rate.
pub(super) struct Path {
    pub(super) curvatures: Vec<f64>,
    pub(super) speeds: Vec<f64>,
    pub(super) alpha_m: f64,
    pub(super) grid_step_m: f64,
}

impl Path {
    /// Force in newtons, smoothed as the contact says.
    pub(super) fn force(self, contact: &Contact<'_>) -> Vec<f64> {
        let rate_hz = RATE.hz() * OVERSAMPLING as f64;
        let mut rises: Vec<f64> = self.curvatures.iter().zip(&self.speeds).map(|(x, speed)| x * speed).collect();
        smooth(&mut rises, f64::from(contact.smoothing_s) * rate_hz * self.alpha_m / mean_alpha_m(contact));
        let mut slope = 0.0;
        let mass_kg = f64::from(contact.mass_kg);
        let [gain, exponent] = contact.slope.map(f64::from);
        let force = |(rise, speed): (f64, f64)| {
            slope += rise / rate_hz - slope * speed.abs() / rate_hz / (LEAK_POINTS * self.grid_step_m);
            mass_kg * rise * speed + gain * (speed * slope).abs().powf(exponent)
        };
        rises.into_iter().zip(self.speeds).map(force).collect()
    }
}

fn mean_alpha_m(contact: &Contact<'_>) -> f64 {
    0.5 * (f64::from(contact.alpha_m[0]) + f64::from(contact.alpha_m[1]))
}

/// Mean speed in each frame, in straight lines over the ticks.
fn speeds_of(motions: &[Motion]) -> impl Iterator<Item = f64> {
    let ends = std::iter::once(0.0).chain(motions.iter().map(|motion| f64::from(motion.velocity_m_per_s[0])));
    let ends: Vec<f64> = ends.collect();
    (0..motions.len() * TICK_FRAMES).map(move |frame| {
        let tick = frame / TICK_FRAMES;
        ends[tick] + (ends[tick + 1] - ends[tick]) * ((frame % TICK_FRAMES) as f64 + 0.5) / TICK_FRAMES as f64
    })
}

/// Exact curvature of periodic heights, [`FINE`] values for each.
fn curvature(mut heights: Vec<f64>, length_m: f64) -> Vec<f64> {
    let points = heights.len();
    let forward = fourier::forward(points);
    let mut bins = forward.make_output_vec();
    forward.process(&mut heights, &mut bins).expect("slices of the plan's lengths");
    let inverse = fourier::inverse(points * FINE);
    let mut input = inverse.make_input_vec();
    for (bin, (to, from)) in input.iter_mut().zip(&bins[..points.div_ceil(2)]).enumerate() {
        let wave = std::f64::consts::TAU * bin as f64 / length_m;
        *to = -wave * wave * from / points as f64;
    }
    let mut output = inverse.make_output_vec();
    inverse.process(&mut input, &mut output).expect("slices of the plan's lengths");
    output
}

/// Smooths by a Gaussian of a standard deviation in samples, as if the sound were periodic.
fn smooth(samples: &mut [f64], deviation: f64) {
    let forward = fourier::forward(samples.len());
    let mut bins: Vec<Complex<f64>> = forward.make_output_vec();
    let mut input = samples.to_vec();
    forward.process(&mut input, &mut bins).expect("slices of the plan's lengths");
    for (bin, value) in bins.iter_mut().enumerate() {
        let angle = std::f64::consts::TAU * bin as f64 / samples.len() as f64;
        *value *= (-0.5 * (deviation * angle).powi(2)).exp() / samples.len() as f64;
    }
    let inverse = fourier::inverse(samples.len());
    inverse.process(&mut bins, samples).expect("slices of the plan's lengths");
}
