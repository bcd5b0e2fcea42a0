//! Chladni figures: the normal motion of a mode over a body, and the lines that stay at rest.

use std::collections::HashMap;
use std::path::Path;

use shape::solve::{Figure, Motion};

use super::markup::data_uri;
use super::plan::{Plan, Point, bounds, drawing};
use crate::plot::{PlotError, field_png};

/// Width of a figure in its own units, and of its picture in pixels.
const WIDTH: f64 = 240.0;
/// Share of the way along an edge below which a crossing lies at the edge's end.
const AT_END: f64 = 1e-6;
/// Share of the largest motion below which all of a triangle at the rim rests.
const REST: f64 = 1e-4;

/// Draws the field of a mode's normal motion and its nodal lines.
///
/// # Errors
/// [`PlotError`] with `path`, the page, if the picture cannot be encoded.
pub(super) fn chladni(path: &Path, figure: &Figure, motion: &Motion, label: &str) -> Result<String, PlotError> {
    let plan = Plan::new(bounds(figure.points.iter().copied()), WIDTH, WIDTH);
    let values: Vec<f64> = motion.at.iter().map(|at| f64::from(at[0])).collect();
    let largest = values.iter().fold(f64::MIN_POSITIVE, |largest, value| largest.max(value.abs()));
    let values: Vec<f64> = values.iter().map(|value| value / largest).collect();
    let [columns, rows] = plan.size.map(|length| length.ceil() as usize);
    let png = field_png(path, columns as u32, &field(figure, &values, &plan, [columns, rows]))?;
    let rim: String = figure.rim.iter().map(|row| plan.along(row.iter().map(|&at| figure.points[at]))).collect();
    let nodal: String = nodal_lines(figure, &values).into_iter().map(|line| plan.along(line)).collect();
    let body = format!(
        "<image href=\"{}\" x=\"0\" y=\"0\" width=\"{columns}\" height=\"{rows}\"/><path class=\"rim\" d=\"{rim}\"/><path class=\"line wide nodal fit\" d=\"{nodal}\"/>",
        data_uri("image/png", &png)
    );
    Ok(drawing(plan.size, label, &body))
}

/// Values at the middle of each pixel; `None` outside the body.
fn field(figure: &Figure, values: &[f64], plan: &Plan, [columns, rows]: [usize; 2]) -> Vec<Option<f64>> {
    let mut pixels = vec![None; columns * rows];
    for corners in &figure.triangles {
        let [a, b, c] = corners.map(|corner| plan.place(figure.points[corner]));
        let area = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
        let range = |axis: usize, count: usize| {
            let [low, high] = [f64::min, f64::max].map(|pick| pick(pick(a[axis], b[axis]), c[axis]));
            (low - 0.5).ceil().max(0.0) as usize..((high + 0.5).floor().max(0.0) as usize).min(count)
        };
        for row in range(1, rows) {
            for column in range(0, columns) {
                let at = [column as f64 + 0.5, row as f64 + 0.5];
                let share = |from: [f64; 2], to: [f64; 2]| {
                    ((from[0] - at[0]) * (to[1] - at[1]) - (from[1] - at[1]) * (to[0] - at[0])) / area
                };
                let shares = [share(b, c), share(c, a), share(a, b)];
                if shares.iter().all(|share| *share >= -1e-9) {
                    let value = corners.iter().zip(shares).map(|(&corner, share)| share * values[corner]).sum();
                    pixels[row * columns + column] = Some(value);
                }
            }
        }
    }
    pixels
}

/// Lines along which values that are linear in each triangle vanish. The rim is no such line, even
/// where the body is held.
pub(super) fn nodal_lines(figure: &Figure, values: &[f64]) -> Vec<Vec<Point>> {
    joined(figure.triangles.iter().filter_map(|&corners| segment(figure, values, corners)).collect())
}

/// Part of a nodal line within a triangle.
fn segment(figure: &Figure, values: &[f64], corners: [usize; 3]) -> Option<[Point; 2]> {
    let is_positive = |corner: usize| values[corner] > 0.0;
    let touches_rim = corners.iter().any(|&corner| figure.on_rim[corner]);
    if touches_rim && corners.iter().all(|&corner| values[corner].abs() < REST) {
        return None;
    }
    let edges = [[0, 1], [1, 2], [2, 0]].map(|ends| ends.map(|end: usize| corners[end]));
    let mut crossings =
        edges.into_iter().filter(|&[from, to]| is_positive(from) != is_positive(to)).map(|[from, to]| {
            let share = values[from] / (values[from] - values[to]);
            let [start, end] = [figure.points[from], figure.points[to]];
            let is_on_rim = share < AT_END && figure.on_rim[from] || share > 1.0 - AT_END && figure.on_rim[to];
            ([0, 1].map(|axis| start[axis] + share * (end[axis] - start[axis])), is_on_rim)
        });
    let (first, second) = (crossings.next()?, crossings.next()?);
    let has_length = (first.0[0] - second.0[0]).hypot(first.0[1] - second.0[1]) > 0.0;
    (has_length && !(first.1 && second.1)).then_some([first.0, second.0])
}

/// Joins segments with common ends to lines.
fn joined(segments: Vec<[Point; 2]>) -> Vec<Vec<Point>> {
    let [low, high] = bounds(segments.iter().flatten().copied());
    let step = (high[0] - low[0]).max(high[1] - low[1]).max(f64::MIN_POSITIVE) * 1e-7;
    let key = |point: Point| point.map(|x| (x / step).round() as i64);
    let mut at_end: HashMap<[i64; 2], Vec<usize>> = HashMap::new();
    for (number, ends) in segments.iter().enumerate() {
        ends.iter().for_each(|&end| at_end.entry(key(end)).or_default().push(number));
    }
    let mut used = vec![false; segments.len()];
    // The segments from the end of a line on, and the points that they add to it.
    let follow = |used: &mut Vec<bool>, mut end: Point| {
        let mut points = Vec::new();
        while let Some(&next) = at_end.get(&key(end)).and_then(|all| all.iter().find(|next| !used[**next])) {
            used[next] = true;
            let [from, to] = segments[next];
            end = if key(from) == key(end) { to } else { from };
            points.push(end);
        }
        points
    };
    let mut lines = Vec::new();
    for (number, &[from, to]) in segments.iter().enumerate() {
        if used[number] {
            continue;
        }
        used[number] = true;
        let forth = follow(&mut used, to);
        let back = follow(&mut used, from);
        lines.push(back.into_iter().rev().chain([from, to]).chain(forth).collect());
    }
    lines
}
