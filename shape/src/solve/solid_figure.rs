//! Picture of a solid from its broadest side: how far the surface that is seen moves to and fro.

use std::collections::{HashMap, HashSet};

use super::SolveError;
use super::figure::{Figure, MOST_MODES, Motion};
use super::parts::{Matrices, Part, Place};
use super::solid_places::SolidPlaces;
use crate::outline;
use crate::solid::{Cells, Grid};
use crate::surface::{Point, Surface, cross, dot, minus};

/// Steps along the longest extent into which triangles are parted.
const STEPS: f64 = 50.0;
/// Slope of a triangle, by the cosine of its normal with the way of view, below which it is not
/// seen.
const STEEP: f64 = 1e-3;

/// Way from which a solid is seen.
struct View {
    /// Unit vectors across the picture, up in it, and out of it.
    axes: [Point; 3],
}

impl View {
    /// View along the axis of the smallest extent.
    fn of(grid: &Grid) -> Self {
        let extent = |axis: usize| grid.extents_m()[axis];
        let thin = (0..3).min_by(|&a, &b| extent(a).total_cmp(&extent(b))).unwrap_or(2);
        let [across, up] = [grid.axes[(thin + 1) % 3], grid.axes[(thin + 2) % 3]];
        // The longer extent lies across.
        let is_long = extent((thin + 1) % 3) >= extent((thin + 2) % 3);
        let [across, up] = if is_long { [across, up] } else { [up, across.map(|part| -part)] };
        Self { axes: [across, up, cross(across, up)] }
    }

    fn flat(&self, point: Point) -> outline::Point {
        [dot(point, self.axes[0]), dot(point, self.axes[1])]
    }
}

/// Draws the picture of the lowest modes of a solid, which lie at places among the parts.
pub(super) fn of(
    surface: &Surface,
    strikes: &SolidPlaces,
    parts: &[Part],
    places: &[Place],
) -> Result<Option<Figure>, SolveError> {
    let Some(Matrices::Solid(cells)) = parts.first().map(|part| &part.matrices) else { return Ok(None) };
    let view = View::of(&cells.grid);
    let out = view.axes[2];
    let [low, high] = surface.bounds();
    let size_m = (0..3).map(|axis| high[axis] - low[axis]).fold(0.0, f64::max) / STEPS;
    let is_seen = |corners: [Point; 3]| {
        let normal = cross(minus(corners[1], corners[0]), minus(corners[2], corners[0]));
        dot(normal, out) > STEEP * dot(normal, normal).sqrt()
    };
    let (mut figure, mut points) = (Figure::default(), Vec::new());
    let mut sides: HashMap<[usize; 2], usize> = HashMap::new();
    for (vertices, corners) in surface.triangles().iter().zip(surface.corners()) {
        if is_seen(corners) {
            part_triangle(corners, size_m, &mut points, &mut figure.triangles);
            for corner in 0..3 {
                let [from, to] = [vertices[corner], vertices[(corner + 1) % 3]];
                *sides.entry([from.min(to), from.max(to)]).or_default() += 1;
            }
        }
    }
    let inner = points.len();
    // Sides of one triangle that is seen are the rim.
    let mut rim: Vec<[usize; 2]> = sides.into_iter().filter(|(_, count)| *count == 1).map(|(ends, _)| ends).collect();
    rim.sort_unstable();
    for ends in rim {
        figure.rim.push(vec![points.len(), points.len() + 1]);
        points.extend(ends.map(|vertex| surface.points()[vertex]));
    }
    figure.on_rim = (0..points.len()).map(|point| point >= inner).collect();
    figure.points = points.iter().map(|point| view.flat(*point)).collect();
    figure.inner_edges = cell_edges(cells, &view);
    figure.strikes = strikes.struck().map(|point| view.flat(point)).collect();
    figure.heard = strikes.heard_point().map(|point| view.flat(point));
    for place in places.iter().take(MOST_MODES) {
        let vector = parts.get(place.part).and_then(|part| part.found.vectors.get(place.index));
        let vector = vector.ok_or(SolveError::NoModes)?;
        let value = |point: &Point| cells.value(vector, *point).map_or(0.0, |motion| dot(motion, out)) as f32;
        let at = points.iter().map(|point| [value(point), 0.0, 0.0]).collect();
        figure.motions.push(Motion { waves: 0, is_second: false, at });
    }
    Ok(Some(figure))
}

/// Parts a triangle into some whose sides are at most a length.
fn part_triangle(corners: [Point; 3], size_m: f64, points: &mut Vec<Point>, triangles: &mut Vec<[usize; 3]>) {
    let side = |from: usize, to: usize| {
        let way = minus(corners[to], corners[from]);
        dot(way, way).sqrt()
    };
    let parts = (side(0, 1).max(side(1, 2)).max(side(2, 0)) / size_m).ceil().max(1.0) as usize;
    let begin = points.len();
    for row in 0..=parts {
        for column in 0..=parts - row {
            let shares = [parts - row - column, column, row].map(|share| share as f64 / parts as f64);
            points.push([0, 1, 2].map(|axis| (0..3).map(|corner| shares[corner] * corners[corner][axis]).sum()));
        }
    }
    let mut first = begin;
    for row in 0..parts {
        let count = parts - row;
        let next = first + count + 1;
        for column in 0..count {
            triangles.push([first + column, first + column + 1, next + column]);
            if column + 1 < count {
                triangles.push([first + column + 1, next + column + 1, next + column]);
            }
        }
        first = next;
    }
}

/// Edges of the cells as they are seen, each once.
fn cell_edges(cells: &Cells, view: &View) -> Vec<[outline::Point; 2]> {
    let grid = &cells.grid;
    let mut seen = HashSet::new();
    let mut edges = Vec::new();
    let longest_m = grid.extents_m().into_iter().fold(0.0, f64::max);
    for cell in cells.places() {
        for axis in 0..3 {
            for corner in 0..4 {
                let mut from = cell;
                from[(axis + 1) % 3] += corner % 2;
                from[(axis + 2) % 3] += corner / 2;
                let mut to = from;
                to[axis] += 1;
                let ends = [from, to].map(|place| view.flat(grid.corner(place)));
                // Edges behind each other are one in the picture.
                let key = ends.map(|end| end.map(|part| (part / (1e-6 * longest_m)).round() as i64));
                if key[0] != key[1] && seen.insert(key) {
                    edges.push(ends);
                }
            }
        }
    }
    edges
}
