//! Missing points, filled from their neighbours.

use super::error::SurfaceError;
use super::heights::Heights;
use super::holes::estimates;
use super::options::Note;

/// Largest share of points that may be missing.
const MOST_MISSING: f64 = 0.5;
/// Number of sweeps of the relaxation of a map's holes.
const SWEEPS: usize = 400;

/// Fills short holes by polynomials through their neighbours, in a map along rows and columns.
///
/// # Errors
/// [`SurfaceError::Missing`] if more than half of all points are missing.
pub(super) fn fill_short(heights: &mut Heights) -> Result<Option<Note>, SurfaceError> {
    let missing = heights.values.iter().filter(|height| !height.is_finite()).count();
    if missing == 0 {
        return Ok(None);
    }
    let share = missing as f64 / heights.values.len() as f64;
    if share > MOST_MISSING {
        return Err(SurfaceError::Missing { percent: 100.0 * share });
    }
    let rows = heights.rows();
    let along = estimates(&heights.values, heights.columns);
    let across = if rows > 1 { estimates(&heights.turned().values, rows) } else { Vec::new() };
    for (index, (height, along)) in heights.values.iter_mut().zip(along).enumerate() {
        let (row, column) = (index / heights.columns, index % heights.columns);
        let across = across.get(column * rows + row).copied().flatten();
        let both = along.zip(across).map(|(along, across)| along.mean(across));
        if let Some(estimate) = both.or(along).or(across) {
            *height = estimate.height();
        }
    }
    Ok(Some(Note::Filled { percent: 100.0 * share }))
}

/// Fills all holes: along a profile by straight lines, in a map by the surface whose points are the
/// means of their neighbours.
pub(super) fn fill(heights: &mut Heights) {
    let missing: Vec<usize> = (0..heights.values.len()).filter(|&index| !heights.values[index].is_finite()).collect();
    if missing.is_empty() {
        return;
    }
    let known = heights.values.iter().filter(|height| height.is_finite());
    let mean = known.clone().sum::<f64>() / known.count().max(1) as f64;
    for row in heights.values.chunks_mut(heights.columns) {
        fill_row(row, mean);
    }
    if heights.rows() > 1 {
        relax(heights, &missing);
    }
}

/// The rows of a map that are whole between the columns where most rows are; `None` if fewer than a
/// quarter of them are, or these columns are fewer than `least`.
///
/// Points of long holes are filled more smoothly than measured ones, so that statistics are better
/// without them.
pub(super) fn whole_rows(heights: &Heights, least: usize) -> Option<Heights> {
    let runs: Vec<[usize; 2]> = heights.values.chunks_exact(heights.columns).map(longest_run).collect();
    let middle = |end: usize| {
        let mut ends: Vec<usize> = runs.iter().map(|run| run[end]).collect();
        ends.sort_unstable();
        ends[ends.len() / 2]
    };
    let (from, to) = (middle(0), middle(1));
    if to < from + least {
        return None;
    }
    let rows = heights.values.chunks_exact(heights.columns).map(|row| &row[from..to]);
    let whole: Vec<&[f64]> = rows.filter(|row| row.iter().all(|height| height.is_finite())).collect();
    (4 * whole.len() >= runs.len()).then(|| Heights { columns: to - from, values: whole.concat(), ..*heights })
}

/// First point of a row's longest stretch without a hole, and the point behind it.
fn longest_run(row: &[f64]) -> [usize; 2] {
    let (mut longest, mut begin) = ([0, 0], 0);
    for (index, height) in row.iter().enumerate() {
        if !height.is_finite() {
            begin = index + 1;
        } else if index + 1 - begin > longest[1] - longest[0] {
            longest = [begin, index + 1];
        }
    }
    longest
}

/// Straight lines over the holes of a row; a constant beyond its ends, and in a row without points.
fn fill_row(row: &mut [f64], otherwise: f64) {
    let mut last: Option<usize> = None;
    for index in 0..row.len() {
        if !row[index].is_finite() {
            continue;
        }
        let hole = last.map_or(0, |last| last + 1)..index;
        let (from, count) = (last.map_or(row[index], |last| row[last]), (index + 1 - hole.start) as f64);
        for (place, hole) in (1..).zip(hole) {
            row[hole] = from + (row[index] - from) * f64::from(place) / count;
        }
        last = Some(index);
    }
    let end = last.map_or(otherwise, |last| row[last]);
    row.iter_mut().skip(last.map_or(0, |last| last + 1)).for_each(|height| *height = end);
}

/// Sweeps by which the missing points become the means of their neighbours.
fn relax(heights: &mut Heights, missing: &[usize]) {
    let (columns, rows) = (heights.columns, heights.rows());
    for _ in 0..SWEEPS {
        for &index in missing {
            let (row, column) = (index / columns, index % columns);
            let mut sum = 0.0;
            let mut count = 0.0;
            let mut add = |is_there: bool, at: usize| {
                if is_there {
                    sum += heights.values[at];
                    count += 1.0;
                }
            };
            add(row > 0, index.wrapping_sub(columns));
            add(row + 1 < rows, index + columns);
            add(column > 0, index.wrapping_sub(1));
            add(column + 1 < columns, index + 1);
            heights.values[index] = sum / f64::max(count, 1.0);
        }
    }
}
