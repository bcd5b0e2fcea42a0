//! Grid of cells over a body, along its principal axes or those of the file.

use faer::{Mat, Side};

use crate::surface::{Point, Surface, cross, dot, minus};

/// Share by which the box along the principal axes must be smaller than the upright one.
const SMALLER: f64 = 0.99;

/// Axes of the file.
const UPRIGHT: [Point; 3] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

/// Grid of equal cells, its axes at right angles.
#[derive(Clone, Debug, PartialEq)]
pub struct Grid {
    /// Unit vectors of the axes.
    pub axes: [Point; 3],
    /// Corner from which the cells are counted, metres.
    pub origin: Point,
    /// Edges of a cell, metres.
    pub edges_m: [f64; 3],
    /// Numbers of cells along the axes.
    pub counts: [usize; 3],
}

impl Grid {
    /// Makes the grid over a surface whose cells have edges of at most `size_m`, metres; a single
    /// cell if that is infinite. Its axes are the principal ones if their box is smaller than the
    /// upright one.
    pub fn over(surface: &Surface, size_m: f64) -> Self {
        let volume = |grid: &Self| grid.cell_m3() * grid.count() as f64;
        let [upright, turned] = [UPRIGHT, principal(surface)].map(|axes| Self::along(surface, axes, size_m));
        if volume(&turned) < SMALLER * volume(&upright) { turned } else { upright }
    }

    /// Makes the grid along the axes of the file.
    pub fn upright(surface: &Surface, size_m: f64) -> Self {
        Self::along(surface, UPRIGHT, size_m)
    }

    fn along(surface: &Surface, axes: [Point; 3], size_m: f64) -> Self {
        let [low, high] = bounds(surface, axes);
        let counts = [0, 1, 2].map(|axis| (((high[axis] - low[axis]) / size_m - 1e-9).ceil() as usize).max(1));
        let edges_m = [0, 1, 2].map(|axis| (high[axis] - low[axis]) / counts[axis] as f64);
        let origin = [0, 1, 2].map(|axis| (0..3).map(|part| low[part] * axes[part][axis]).sum());
        Self { axes, origin, edges_m, counts }
    }

    /// Gives the place of a point in units of cells.
    pub fn local(&self, point: Point) -> Point {
        let way = minus(point, self.origin);
        [0, 1, 2].map(|axis| dot(way, self.axes[axis]) / self.edges_m[axis])
    }

    /// Gives the point, metres, of a place in units of cells.
    pub(crate) fn point(&self, local: Point) -> Point {
        let along =
            |axis: usize| (0..3).map(|part| local[part] * self.edges_m[part] * self.axes[part][axis]).sum::<f64>();
        [0, 1, 2].map(|axis| self.origin[axis] + along(axis))
    }

    /// Gives the number of cells.
    pub fn count(&self) -> usize {
        self.counts.iter().product()
    }

    /// Gives the number of unknowns if all cells have a part inside the body.
    pub fn unknowns(&self) -> usize {
        3 * self.counts.iter().map(|count| super::ORDER * count + 1).product::<usize>()
    }

    /// Gives the number of a cell, counted along the first axis first.
    pub(super) fn number(&self, cell: [usize; 3]) -> usize {
        (cell[2] * self.counts[1] + cell[1]) * self.counts[0] + cell[0]
    }

    /// Gives the place of a cell in the grid.
    pub(super) fn place(&self, number: usize) -> [usize; 3] {
        let [x, y, _] = self.counts;
        [number % x, number / x % y, number / (x * y)]
    }

    /// Gives the volume of a cell, m³.
    pub(super) fn cell_m3(&self) -> f64 {
        self.edges_m.iter().product()
    }
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
