//! Grid of cells over a body, along its principal axes or those of the file.

use faer::{Mat, Side};

use crate::surface::{Point, Surface, cross, dot, minus};

/// Share by which the box along the principal axes must be smaller than the upright one.
const SMALLER: f64 = 0.99;
/// Share of the box's side that flat faces across an axis have at least, for a plane of the grid to
/// lie in them.
const BROAD: f64 = 0.02;
/// Distance between planes of the grid that faces ask for, at least, as a share of the extent.
const APART: f64 = 1e-3;
/// Largest number of planes that faces ask for, along an axis.
const MOST_FACES: usize = 8;
/// Axes of the file.
const UPRIGHT: [Point; 3] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

/// Grid of cells, its axes at right angles. Planes lie in the body's broad flat faces, so that a
/// cell reaches over no slot and corners lie at corners of cells.
#[derive(Clone, Debug, PartialEq)]
pub struct Grid {
    /// Unit vectors of the axes.
    pub axes: [Point; 3],
    /// Corner from which planes are measured, metres.
    pub origin: Point,
    /// Places of the planes between cells along each axis, metres: from 0 to the body's extent.
    pub planes_m: [Vec<f64>; 3],
}

impl Grid {
    /// Makes the grid over a surface whose cells have edges of at most `size_m`, metres; none but
    /// the planes of faces if that is infinite. Its axes are the principal ones if their box is
    /// smaller than the upright one.
    pub fn over(surface: &Surface, size_m: f64) -> Self {
        let volume = |grid: &Self| grid.extents_m().iter().product::<f64>();
        let [upright, turned] = [UPRIGHT, principal(surface)].map(|axes| Self::along(surface, axes, size_m));
        if volume(&turned) < SMALLER * volume(&upright) { turned } else { upright }
    }

    /// Makes the grid along the axes of the file.
    pub fn upright(surface: &Surface, size_m: f64) -> Self {
        Self::along(surface, UPRIGHT, size_m)
    }

    fn along(surface: &Surface, axes: [Point; 3], size_m: f64) -> Self {
        let [low, high] = bounds(surface, axes);
        let origin = [0, 1, 2].map(|axis| (0..3).map(|part| low[part] * axes[part][axis]).sum());
        let extents = [0, 1, 2].map(|axis| high[axis] - low[axis]);
        let planes_m = [0, 1, 2].map(|axis| {
            let side = extents[(axis + 1) % 3] * extents[(axis + 2) % 3];
            let faces = faces(surface, axes[axis], low[axis], extents[axis], BROAD * side);
            parted(&faces, size_m)
        });
        Self { axes, origin, planes_m }
    }

    /// Gives the numbers of cells along the axes.
    pub fn counts(&self) -> [usize; 3] {
        self.planes_m.each_ref().map(|planes| planes.len() - 1)
    }

    /// Gives the number of cells.
    pub fn count(&self) -> usize {
        self.counts().iter().product()
    }

    /// Gives the extents of the body along the axes, metres.
    pub fn extents_m(&self) -> [f64; 3] {
        self.planes_m.each_ref().map(|planes| planes.last().copied().unwrap_or(0.0))
    }

    /// Gives the number of unknowns if all cells have a part inside the body.
    pub fn unknowns(&self) -> usize {
        3 * self.counts().iter().map(|count| super::ORDER * count + 1).product::<usize>()
    }

    /// Gives the place of a point along the axes, metres.
    pub(super) fn local(&self, point: Point) -> Point {
        let way = minus(point, self.origin);
        self.axes.map(|axis| dot(way, axis))
    }

    /// Gives the point, metres, of the planes with the numbers given.
    pub(crate) fn corner(&self, numbers: [usize; 3]) -> Point {
        let place = [0, 1, 2].map(|axis| self.planes_m[axis][numbers[axis]]);
        let along = |axis: usize| (0..3).map(|part| place[part] * self.axes[part][axis]).sum::<f64>();
        [0, 1, 2].map(|axis| self.origin[axis] + along(axis))
    }

    /// Gives the first and the last plane of a layer of cells, metres.
    pub(super) fn layer(&self, axis: usize, number: usize) -> [f64; 2] {
        [self.planes_m[axis][number], self.planes_m[axis][number + 1]]
    }

    /// Gives the edges of a cell, metres.
    pub(super) fn edges_m(&self, cell: [usize; 3]) -> [f64; 3] {
        [0, 1, 2].map(|axis| {
            let [low, high] = self.layer(axis, cell[axis]);
            high - low
        })
    }

    /// Gives the layer in which a place along an axis lies, the upper one of two; the nearest one
    /// of a place outside.
    pub(super) fn layer_of(&self, axis: usize, at_m: f64) -> usize {
        let planes = &self.planes_m[axis];
        planes[1..planes.len() - 1].partition_point(|plane| *plane <= at_m)
    }

    /// Gives the number of a cell, counted along the first axis first.
    pub(super) fn number(&self, cell: [usize; 3]) -> usize {
        let [x, y, _] = self.counts();
        (cell[2] * y + cell[1]) * x + cell[0]
    }

    /// Gives the place of a cell in the grid.
    pub(super) fn place(&self, number: usize) -> [usize; 3] {
        let [x, y, _] = self.counts();
        [number % x, number / x % y, number / (x * y)]
    }
}

/// Places along an axis of both ends of a body and of its broad flat faces, metres from `low`.
fn faces(surface: &Surface, axis: Point, low: f64, extent: f64, broad_m2: f64) -> Vec<f64> {
    let flat = surface.corners().filter_map(|corners| {
        let places = corners.map(|corner| dot(corner, axis) - low);
        let [least, most] =
            [places.iter().copied().fold(f64::MAX, f64::min), places.iter().copied().fold(0.0, f64::max)];
        let [a, b, c] = corners;
        let area = dot(cross(minus(b, a), minus(c, a)), axis).abs() / 2.0;
        (most - least < 1e-6 * extent).then_some((least, area))
    });
    let mut flat: Vec<(f64, f64)> = flat.collect();
    flat.sort_by(|a, b| a.0.total_cmp(&b.0));
    // One face is all that lies in a plane.
    let mut faces: Vec<(f64, f64)> = Vec::new();
    for (place, area) in flat {
        match faces.last_mut() {
            Some((last, sum)) if place - *last < 1e-6 * extent => *sum += area,
            _ => faces.push((place, area)),
        }
    }
    faces.retain(|(_, area)| *area >= broad_m2);
    faces.sort_by(|a, b| b.1.total_cmp(&a.1));
    let mut planes = vec![0.0, extent];
    for (place, _) in faces {
        if planes.len() < MOST_FACES + 2 && planes.iter().all(|plane| (place - plane).abs() > APART * extent) {
            planes.push(place);
        }
    }
    planes.sort_by(f64::total_cmp);
    planes
}

/// Places with others evenly between them, so that none are farther apart than `size_m`.
fn parted(planes: &[f64], size_m: f64) -> Vec<f64> {
    let mut result = vec![];
    for pair in planes.windows(2) {
        let width = pair[1] - pair[0];
        let count = ((width / size_m - 1e-9).ceil() as usize).max(1);
        result.extend((0..count).map(|step| pair[0] + width * step as f64 / count as f64));
    }
    result.extend(planes.last());
    result
}

/// Principal axes of a body, that of its longest extent first.
fn principal(surface: &Surface) -> [Point; 3] {
    let (_, second) = surface.second_moments();
    let matrix = Mat::from_fn(3, 3, |row, column| second[row][column]);
    let Ok(found) = matrix.self_adjoint_eigen(Side::Lower) else {
        return UPRIGHT;
    };
    let [long, middle] = [2, 1].map(|column| [0, 1, 2].map(|row| found.U()[(row, column)]));
    // Right-handed, so that triangles keep their sense.
    [long, middle, cross(long, middle)]
}

/// Lowest and highest coordinate of a body along three axes, metres.
fn bounds(surface: &Surface, axes: [Point; 3]) -> [Point; 2] {
    let start = [[f64::INFINITY; 3], [f64::NEG_INFINITY; 3]];
    surface.points().iter().fold(start, |[low, high], point| {
        let along = axes.map(|axis| dot(*point, axis));
        [[0, 1, 2].map(|axis| low[axis].min(along[axis])), [0, 1, 2].map(|axis| high[axis].max(along[axis]))]
    })
}
