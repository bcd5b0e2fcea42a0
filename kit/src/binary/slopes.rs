//! Curvature and slopes of a surface on the grid of its binary form, from its heights.
//!
//! Heights are samples of a periodic function without waves shorter than the shortest one. Its
//! curvature `z''` is exact, by Fourier transform. The slope of the limited path is the integral of
//! `tanh(α z'')/α`, which is taken on a grid 32 times as fine, so that the limit's harmonics fold
//! back 60 dB lower at least; then each octave keeps the waves that its points can hold.

use dsp_core::table::layout::{GRID_MULTIPLE, GUARD, LIMITS, MapHeader, OCTAVES};
use fourier::Complex;

use super::waves::{bins, derivative, guarded, quantized, spline, values};
use crate::error::KitError;
use crate::surface::{GRID_POINTS_PER_WAVE, Surface};

/// Points of the fine grid for each of the grid.
const OVERSAMPLING: usize = 32;
/// Highest frequency of an octave in cycles a point, and the share of it from which on waves fade.
const EDGE: f64 = 0.45;
const FADE_FROM: f64 = 0.85;

/// Tables that are derived from a surface's heights.
pub(super) struct Tables {
    /// Number of the grid's points; of a map's in a row.
    pub(super) grid: usize,
    pub(super) curvature_rms_per_m: f64,
    pub(super) curvature_unit_per_m: f64,
    pub(super) curvature: Vec<i16>,
    pub(super) alpha_m: [f64; LIMITS],
    pub(super) slope_unit: [f64; LIMITS],
    pub(super) mean_per_m: [f64; LIMITS],
    pub(super) mix_gain: [f64; LIMITS - 1],
    /// Slopes of each octave, those of all limits at each point.
    pub(super) octaves: Vec<Vec<i16>>,
    /// Second head of a map.
    pub(super) map: Option<MapHeader>,
}

impl Tables {
    /// Derives the tables; `limits_m` gives the limits for an rms curvature. `None` for a flat
    /// surface.
    pub(super) fn new(
        surface: &Surface,
        limits_m: impl FnOnce(f64) -> Result<[f64; 2], KitError>,
    ) -> Result<Option<Self>, KitError> {
        let points = surface.heights.len();
        let length_m = points as f64 * f64::from(surface.step_m);
        let grid = (GRID_POINTS_PER_WAVE * length_m / f64::from(surface.shortest_m)).ceil() as usize;
        // A wrong wave, which the reader refuses, must not take all memory.
        let grid =
            grid.clamp(GRID_MULTIPLE, 2 * points.next_multiple_of(GRID_MULTIPLE)).next_multiple_of(GRID_MULTIPLE);
        let unit_m = f64::from(surface.unit_m);
        let heights = surface.heights.iter().map(|&height| f64::from(height) * unit_m).collect();
        let spectrum = derivative(heights, length_m, 2);
        let curvature_rms_per_m = (2.0 * spectrum.iter().map(Complex::norm_sqr).sum::<f64>()).sqrt();
        let is_flat = surface.heights.iter().all(|height| Some(height) == surface.heights.first());
        if is_flat || !(curvature_rms_per_m > 0.0 && curvature_rms_per_m.is_finite()) {
            return Ok(None);
        }
        let [least_m, most_m] = limits_m(curvature_rms_per_m)?;
        let alpha_m = [least_m, (least_m * most_m).sqrt(), most_m];
        let (curvature, curvature_unit_per_m) = quantized(&guarded(spline(&spectrum, grid)));
        let fine = values(&spectrum, grid * OVERSAMPLING);
        let mut tables = Self {
            grid,
            curvature_rms_per_m,
            curvature_unit_per_m,
            curvature,
            alpha_m,
            slope_unit: [0.0; LIMITS],
            mean_per_m: [0.0; LIMITS],
            mix_gain: [0, 1].map(|limit| mix_gain(&fine, [alpha_m[limit], alpha_m[limit + 1]])),
            octaves: (0..OCTAVES).map(|octave| vec![0; ((grid >> octave) + GUARD) * LIMITS]).collect(),
            map: None,
        };
        for (limit, alpha) in alpha_m.into_iter().enumerate() {
            let mut limited = bins(limited(&fine, alpha));
            tables.mean_per_m[limit] = limited.first().map_or(0.0, |mean| mean.re);
            for (bin, value) in limited.iter_mut().enumerate() {
                // The integral, but for the mean, whose integral is a ramp.
                let wave = std::f64::consts::TAU * bin as f64 / length_m;
                *value = if bin == 0 { Complex::new(0.0, 0.0) } else { *value / Complex::new(0.0, wave) };
            }
            let octaves = (0..OCTAVES).map(|octave| {
                let points = grid >> octave;
                let kept: Vec<_> = limited.iter().enumerate().map(|(bin, value)| value * share(bin, points)).collect();
                guarded(spline(&kept, points))
            });
            let octaves: Vec<Vec<f64>> = octaves.collect();
            let largest = octaves.iter().flatten().fold(0.0_f64, |largest, value| largest.max(value.abs()));
            let unit = (largest / f64::from(i16::MAX)).max(f64::MIN_POSITIVE);
            tables.slope_unit[limit] = f64::from(unit as f32).max(1e-30);
            for (table, values) in tables.octaves.iter_mut().zip(&octaves) {
                for (number, value) in table.iter_mut().skip(limit).step_by(LIMITS).zip(values) {
                    *number = (value / tables.slope_unit[limit]).round() as i16;
                }
            }
        }
        Ok(Some(tables))
    }
}

/// Largest curvature of a profile in either direction, 1/m; between heights it is taken at three
/// places.
pub(super) fn largest_curvature_per_m(surface: &Surface) -> f64 {
    let heights = surface.heights.iter().map(|&height| f64::from(height) * f64::from(surface.unit_m)).collect();
    let spectrum = derivative(heights, surface.heights.len() as f64 * f64::from(surface.step_m), 2);
    values(&spectrum, 4 * surface.heights.len())
        .into_iter()
        .fold(0.0, |largest, curvature| largest.max(curvature.abs()))
}

/// Curvature that is limited by a length α.
fn limited(curvature: &[f64], alpha_m: f64) -> Vec<f64> {
    curvature.iter().map(|curvature| (alpha_m * curvature).tanh() / alpha_m).collect()
}

/// Gain by which a mix of the curvatures at two limits falls short of that at the limit between
/// them: half of each has a smaller rms.
fn mix_gain(curvature: &[f64], [low_m, high_m]: [f64; 2]) -> f64 {
    let rms = |values: &mut dyn Iterator<Item = f64>| {
        let (sum, square) = values.fold((0.0, 0.0), |(sum, square), x| (sum + x, square + x * x));
        (square / curvature.len() as f64 - (sum / curvature.len() as f64).powi(2)).sqrt()
    };
    let [low, high] = [low_m, high_m].map(|alpha_m| limited(curvature, alpha_m));
    // Shares go by 1/α.
    let between = limited(curvature, 2.0 / (1.0 / low_m + 1.0 / high_m));
    let mixed = rms(&mut low.iter().zip(&high).map(|(low, high)| 0.5 * (low + high)));
    (2.0 * (rms(&mut between.into_iter()) / mixed - 1.0)).clamp(0.0, 1.0)
}

/// Share of a wave that an octave keeps.
fn share(bin: usize, points: usize) -> f64 {
    let position = ((EDGE - bin as f64 / points as f64) / (EDGE * (1.0 - FADE_FROM))).clamp(0.0, 1.0);
    position * position * (3.0 - 2.0 * position)
}
