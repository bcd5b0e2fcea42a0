//! Maps as measured, made periodic.

use dsp_core::table::layout::{CURVATURES, GUARD, MapHeader, SurfaceHeader};
use dsp_core::table::range;
use fourier::Complex;
use kit::GRID_POINTS_PER_WAVE;

use super::error::SurfaceError;
use super::heights::Heights;
use super::section::{FADE, closed, even, resampled};
use super::waves::{frequency_per_m, signal, spectrum};

/// Least length of a map's sides in shortest waves.
const LEAST_WAVES: f64 = 10.0;
/// Part of a surface as a periodic map that a kit takes: its heights row by row, the number of
/// rows, and the step in metres, which is `shortest_m / points_per_wave`.
///
/// The plane of least squares is taken off. The part is the one with the fewest missing points,
/// since filled points are smoother than measured ones; of several such parts it is the one
/// nearest to the middle. Opposite edges fade into each other. No wave is shorter than
/// `shortest_m`, whatever its direction.
///
/// # Errors
/// [`SurfaceError::MapTooSmall`] for a side of less than 10 shortest waves.
pub(super) fn map(
    heights: &Heights,
    is_missing: &[bool],
    shortest_m: f64,
    points_per_wave: f64,
) -> Result<(Vec<f64>, usize, f64), SurfaceError> {
    let own_m = heights.step_m;
    let sides = [heights.columns, heights.rows()];
    let shorter_m = sides[0].min(sides[1]) as f64 * own_m;
    if shorter_m < LEAST_WAVES * shortest_m {
        return Err(SurfaceError::MapTooSmall { side_m: shorter_m, shortest_m });
    }
    let fades = sides.map(|side| ((FADE * shortest_m / own_m) as usize).min(side / 8));
    let mut counts = [0, 1].map(|axis| even((sides[axis] - fades[axis] - 1) as f64));
    while bytes(counts.map(|count| count as f64 * own_m / shortest_m), points_per_wave) > range::SURFACE_BYTES {
        let longer = usize::from(counts[1] > counts[0]);
        counts[longer] -= 2;
    }
    // One step for both directions: rows and columns are cut to whole numbers of it.
    let columns = even(counts[0] as f64 * own_m * points_per_wave / shortest_m);
    let step_m = counts[0] as f64 * own_m / columns as f64;
    let rows = even(counts[1] as f64 * own_m / step_m);
    let level = levelled(heights);
    let begin = begin(is_missing, sides, [0, 1].map(|axis| counts[axis] + fades[axis]));
    let across = |axis: usize| begin[axis]..begin[axis] + counts[axis] + fades[axis];
    // Waves along the rows, in each of which the waves across them are cut off on a circle.
    let waves: Vec<Vec<Complex<f64>>> =
        across(1).map(|row| spectrum(&closed(&level[row * sides[0]..][across(0)], fades[0]))).collect();
    let mut bins = vec![vec![Complex::new(0.0, 0.0); columns / 2 + 1]; rows];
    for bin in 0..(columns / 2).min(counts[0] / 2) {
        let along_per_m = frequency_per_m(bin, counts[0], own_m);
        let is_kept = |across: usize| {
            let per_m = along_per_m.hypot(frequency_per_m(across, counts[1], own_m));
            per_m > 0.0 && per_m <= 1.0 / shortest_m
        };
        let line = |part: &dyn Fn(&Complex<f64>) -> f64| {
            let line: Vec<f64> = waves.iter().map(|row| part(&row[bin])).collect();
            resampled(&closed(&line, fades[1]), rows, is_kept)
        };
        let [real, imaginary] = [line(&|x| x.re), line(&|x| x.im)];
        for ((bins, real), imaginary) in bins.iter_mut().zip(real).zip(imaginary) {
            bins[bin] = Complex::new(real, imaginary) * (columns as f64 / counts[0] as f64);
        }
    }
    Ok((bins.into_iter().flat_map(|bins| signal(bins, columns)).collect(), rows, step_m))
}

/// Begin of a part of a size within sides, with the fewest missing points.
fn begin(is_missing: &[bool], sides: [usize; 2], size: [usize; 2]) -> [usize; 2] {
    // Missing points above and to the left of each corner.
    let width = sides[0] + 1;
    let mut before = vec![0_usize; width * (sides[1] + 1)];
    for (row, line) in is_missing.chunks_exact(sides[0]).enumerate() {
        let mut sum = 0;
        for (column, &is_missing) in line.iter().enumerate() {
            sum += usize::from(is_missing);
            before[(row + 1) * width + column + 1] = before[row * width + column + 1] + sum;
        }
    }
    let room = [0, 1].map(|axis| sides[axis] - size[axis]);
    let missing = |[x, y]: [usize; 2]| {
        let at = |x: usize, y: usize| before[y * width + x];
        at(x + size[0], y + size[1]) + at(x, y) - at(x, y + size[1]) - at(x + size[0], y)
    };
    let from_middle = |[x, y]: [usize; 2]| x.abs_diff(room[0] / 2) + y.abs_diff(room[1] / 2);
    let places = (0..=room[1]).flat_map(|y| (0..=room[0]).map(move |x| [x, y]));
    places.min_by_key(|&place| (missing(place), from_middle(place))).unwrap_or([0; 2])
}

/// Bytes that a map takes in a kit, of sides in shortest waves.
fn bytes(waves: [f64; 2], points_per_wave: f64) -> usize {
    let count = |per_wave: f64, more: usize| -> usize {
        waves.iter().map(|waves| (waves * per_wave).ceil() as usize + more).product()
    };
    // The step is rounded, so that a side may be some points longer.
    let heights = count(points_per_wave, 2);
    let curvatures = count(GRID_POINTS_PER_WAVE, GUARD + 1);
    size_of::<SurfaceHeader>() + size_of::<MapHeader>() + 2 * (heights + CURVATURES * curvatures)
}

/// Heights without the plane of least squares.
fn levelled(heights: &Heights) -> Vec<f64> {
    let (columns, rows) = (heights.columns, heights.rows());
    let middle = [0.5 * (columns as f64 - 1.0), 0.5 * (rows as f64 - 1.0)];
    let place = |index: usize| [(index % columns) as f64 - middle[0], (index / columns) as f64 - middle[1]];
    let count = heights.values.len() as f64;
    let mean = heights.values.iter().sum::<f64>() / count;
    let slope = |axis: usize| {
        let (along, square) = heights.values.iter().enumerate().fold((0.0, 0.0), |(along, square), (index, height)| {
            let x = place(index)[axis];
            (along + x * height, square + x * x)
        });
        along / f64::max(square, f64::MIN_POSITIVE)
    };
    let slopes = [slope(0), slope(1)];
    let flat = |(index, height): (usize, &f64)| {
        let [x, y] = place(index);
        height - mean - slopes[0] * x - slopes[1] * y
    };
    heights.values.iter().enumerate().map(flat).collect()
}
