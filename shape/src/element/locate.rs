//! Grid of squares that says which triangles may hold a point.

use crate::outline::Point;

/// Squares over a body, each with the triangles whose bounds touch it.
#[derive(Clone, Debug)]
pub(super) struct Grid {
    low: Point,
    step: Point,
    counts: [usize; 2],
    cells: Vec<Vec<usize>>,
}

impl Grid {
    /// Sorts triangles, given by their nodes, into about as many squares.
    pub(super) fn new(positions: &[Point], triangles: &[Vec<usize>], curved: &[bool]) -> Self {
        let all = bounds(positions.iter().copied());
        let size = [0, 1].map(|axis| (all[1][axis] - all[0][axis]).max(f64::MIN_POSITIVE));
        let side = (size[0] * size[1] / triangles.len().max(1) as f64).sqrt();
        let counts = size.map(|length| ((length / side).ceil() as usize).clamp(1, 1000));
        let step = [0, 1].map(|axis| size[axis] / counts[axis] as f64);
        let mut grid = Self { low: all[0], step, counts, cells: vec![Vec::new(); counts[0] * counts[1]] };
        for (number, nodes) in triangles.iter().enumerate() {
            let [mut low, mut high] = bounds(nodes.iter().map(|node| positions[*node]));
            for axis in 0..2 {
                // A curved edge may leave the bounds of its nodes a little; rounding leaves any.
                let margin = (high[axis] - low[axis]) * if curved[number] { 0.1 } else { 1e-5 };
                low[axis] -= margin;
                high[axis] += margin;
            }
            let [from, to] = [grid.cell(low), grid.cell(high)];
            for row in from[1]..=to[1] {
                for column in from[0]..=to[0] {
                    grid.cells[row * counts[0] + column].push(number);
                }
            }
        }
        grid
    }

    /// Returns the triangles that may hold a point.
    pub(super) fn near(&self, point: Point) -> impl Iterator<Item = usize> {
        let [column, row] = self.cell(point);
        self.cells[row * self.counts[0] + column].iter().copied()
    }

    fn cell(&self, point: Point) -> [usize; 2] {
        // The conversion takes what is below zero, and what is no number, to zero.
        [0, 1].map(|axis| (((point[axis] - self.low[axis]) / self.step[axis]) as usize).min(self.counts[axis] - 1))
    }
}

/// Lowest and highest coordinates of points.
pub(super) fn bounds(points: impl Iterator<Item = Point>) -> [Point; 2] {
    points.fold([[f64::INFINITY; 2], [f64::NEG_INFINITY; 2]], |[low, high], point| {
        [[0, 1].map(|axis| low[axis].min(point[axis])), [0, 1].map(|axis| high[axis].max(point[axis]))]
    })
}
