//! Curvatures of a map on the grid of its binary form, from its heights.
//!
//! In the direction (c, s) the curvature is `z_xx c² + 2 z_xy c s + z_yy s²`. Splines of the three
//! are held, not one of the heights. The second derivative of a cubic spline through heights has
//! the image of a wave of f cycles a point at `(f/(1 - f))²` of it: -10 dB for the shortest wave.

use std::f64::consts::PI;

use dsp_core::table::layout::{CURVATURES, GUARD, LIMITS, MapHeader};
use dsp_core::table::range;
use fourier::Complex;
use zerocopy::byteorder::little_endian::{F32, U32};

use super::slopes::Tables;
use super::waves::{derivative, guarded, quantized, spline, values};
use crate::error::KitError;
use crate::surface::{GRID_POINTS_PER_WAVE, Surface};

/// Points of the grid on which means are taken, for each of the map's own.
const OVERSAMPLING: usize = 2;
/// Number of directions in which means are taken.
const DIRECTIONS: usize = 12;

/// Derivatives along a row and across rows of the curvatures `z_xx`, `z_xy` and `z_yy`.
const ORDERS: [[i32; 2]; CURVATURES] = [[2, 0], [1, 1], [0, 2]];

/// Derives the tables of a map. `limits_m` gives the limits α for an rms curvature, here that over
/// all directions. `None` for a flat surface.
pub(super) fn tables(
    surface: &Surface,
    limits_m: impl FnOnce(f64) -> Result<[f64; 2], KitError>,
) -> Result<Option<Tables>, KitError> {
    let map = Map::new(surface);
    let points = [0, 1].map(|axis| points(map.lengths_m[axis], f64::from(surface.shortest_m), map.sizes[axis]));
    let fine = map.curvatures(points.map(|points| OVERSAMPLING * points), values);
    let curvature_rms_per_m = rms_per_m(&fine);
    if !(curvature_rms_per_m > 0.0 && curvature_rms_per_m.is_finite()) {
        return Ok(None);
    }
    let [least_m, most_m] = limits_m(curvature_rms_per_m)?;
    let alpha_m = [least_m, (least_m * most_m).sqrt(), most_m];
    let means = alpha_m.map(|alpha_m| mean_waves(&fine, alpha_m));
    let [xx, mut xy, yy] = map.curvatures(points, spline);
    xy.iter_mut().for_each(|xy| *xy *= 2.0);
    let coefficients: Vec<f64> = [xx, xy, yy].iter().flat_map(|map| framed(map, points)).collect();
    let (curvature, curvature_unit_per_m) = quantized(&coefficients);
    let header = MapHeader {
        grid_rows: U32::new(points[1] as u32),
        mean_waves_per_m: means.map(|(_, waves)| waves.map(|wave| F32::new(wave as f32))),
    };
    Ok(Some(Tables {
        grid: points[0],
        curvature_rms_per_m,
        curvature_unit_per_m,
        curvature,
        alpha_m,
        slope_unit: [1.0; LIMITS],
        mean_per_m: means.map(|(mean, _)| mean),
        mix_gain: [0.0; LIMITS - 1],
        octaves: Vec::new(),
        map: Some(header),
    }))
}

/// Largest curvature of a map in any direction and of either sign, 1/m.
pub(super) fn largest_curvature_per_m(surface: &Surface) -> f64 {
    let map = Map::new(surface);
    let [xx, xy, yy] = map.curvatures(map.sizes.map(|size| OVERSAMPLING * size), values);
    let principal =
        |((xx, xy), yy): ((&f64, &f64), &f64)| 0.5 * (xx + yy).abs() + (0.25 * (xx - yy) * (xx - yy) + xy * xy).sqrt();
    xx.iter().zip(&xy).zip(&yy).map(principal).fold(0.0, f64::max)
}

/// Points of the grid over a length, at most twice as many as heights: a shortest wave that the
/// reader refuses must not take all memory.
fn points(length_m: f64, shortest_m: f64, heights: usize) -> usize {
    let least = range::GRID_POINTS;
    ((GRID_POINTS_PER_WAVE * length_m / shortest_m).ceil() as usize).clamp(least, least.max(2 * heights))
}

/// Periodic heights in metres, row by row.
struct Map {
    heights: Vec<f64>,
    /// Numbers of columns and rows, and their lengths in metres.
    sizes: [usize; 2],
    lengths_m: [f64; 2],
}

impl Map {
    fn new(surface: &Surface) -> Self {
        let sizes = [surface.heights.len() / surface.rows, surface.rows];
        let heights = surface.heights.iter().map(|&height| f64::from(height) * f64::from(surface.unit_m)).collect();
        Self { heights, sizes, lengths_m: sizes.map(|size| size as f64 * f64::from(surface.step_m)) }
    }

    /// Curvatures `z_xx`, `z_xy` and `z_yy` on another grid, by a way from waves to points.
    fn curvatures(
        &self,
        points: [usize; 2],
        way: impl Fn(&[Complex<f64>], usize) -> Vec<f64>,
    ) -> [Vec<f64>; CURVATURES] {
        ORDERS.map(|[along, across]| {
            let derived = |line: Vec<f64>, length_m: f64, order: i32, points: usize| {
                way(&derivative(line, length_m, order), points)
            };
            let rows = self.heights.chunks_exact(self.sizes[0]);
            let rows: Vec<Vec<f64>> =
                rows.map(|row| derived(row.to_vec(), self.lengths_m[0], along, points[0])).collect();
            let mut map = vec![0.0; points[0] * points[1]];
            for column in 0..points[0] {
                let line = rows.iter().map(|row| row[column]).collect();
                let line = derived(line, self.lengths_m[1], across, points[1]);
                line.into_iter().enumerate().for_each(|(row, value)| map[row * points[0] + column] = value);
            }
            map
        })
    }
}

/// Rms over a map of the curvature in all directions.
fn rms_per_m([xx, xy, yy]: &[Vec<f64>; CURVATURES]) -> f64 {
    // Means over θ: c⁴ and s⁴ 3/8, c² s² 1/8.
    let square =
        |((xx, xy), yy): ((&f64, &f64), &f64)| 0.375 * (xx * xx + yy * yy) + 0.125 * (2.0 * xx * yy + 4.0 * xy * xy);
    (xx.iter().zip(xy).zip(yy).map(square).sum::<f64>() / xx.len() as f64).sqrt()
}

/// Mean of the limited curvature over all directions, and its waves over the direction θ: cos 2θ,
/// sin 2θ, cos 4θ, sin 4θ, cos 6θ, sin 6θ. More are not needed: the first term of tanh beyond the
/// straight line, which has no mean, is of the third power.
fn mean_waves([xx, xy, yy]: &[Vec<f64>; CURVATURES], alpha_m: f64) -> (f64, [f64; 6]) {
    let mut waves = [0.0; 6];
    let mut mean = 0.0;
    for direction in 0..DIRECTIONS {
        let angle = PI * direction as f64 / DIRECTIONS as f64;
        let (s, c) = angle.sin_cos();
        let limited = |((xx, xy), yy): ((&f64, &f64), &f64)| {
            (alpha_m * (xx * c * c + 2.0 * xy * c * s + yy * s * s)).tanh() / alpha_m
        };
        let value = xx.iter().zip(xy).zip(yy).map(limited).sum::<f64>() / xx.len() as f64 / DIRECTIONS as f64;
        mean += value;
        for (index, wave) in waves.iter_mut().enumerate() {
            let (s, c) = (2.0 * (index / 2 + 1) as f64 * angle).sin_cos();
            *wave += 2.0 * value * if index.is_multiple_of(2) { c } else { s };
        }
    }
    (mean, waves)
}

/// Coefficients of a map with their guards in both directions.
fn framed(map: &[f64], points: [usize; 2]) -> Vec<f64> {
    let rows: Vec<Vec<f64>> = map.chunks_exact(points[0]).map(|row| guarded(row.to_vec())).collect();
    let order = std::iter::once(points[1] - 1).chain(0..points[1]).chain(0..GUARD - 1);
    order.flat_map(|row| rows[row].iter().copied()).collect()
}
