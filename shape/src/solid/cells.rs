//! Solid with finitely many unknowns.

use super::Grid;
use super::cell::parts;
use super::functions::{FUNCTIONS, lagrange};
use crate::eigen::Problem;
use crate::surface::Point;

/// Solid with finitely many unknowns: its matrices, and how to read its modes.
#[derive(Clone, Debug)]
pub struct Cells {
    /// Matrices of stiffness and mass; three unknowns a node, along the axes of the grid.
    pub problem: Problem,
    /// Grid of the cells.
    pub grid: Grid,
    /// Number of each of the grid's cells among those with unknowns.
    pub(super) cells: Vec<Option<usize>>,
    /// Nodes of each cell with unknowns.
    pub(super) members: Vec<Vec<usize>>,
    /// Mass of the body, kg.
    pub mass_kg: f64,
}

/// Number of motions of a free body that store no energy.
pub const RIGID: usize = 6;

impl Cells {
    /// Takes grid and mass from other units to metres and kilograms; the matrices stay.
    pub(crate) fn measure(&mut self, length_m: f64, mass_kg: f64) {
        let planes = self.grid.planes_m.iter_mut().flatten();
        planes.chain(&mut self.grid.origin).for_each(|place| *place *= length_m);
        self.mass_kg *= mass_kg;
    }

    /// Gives the number of cells with a part inside the body.
    pub fn len(&self) -> usize {
        self.members.len()
    }

    /// Says that no cell has a part inside the body; not so for a surface that is checked.
    pub fn is_empty(&self) -> bool {
        self.members.is_empty()
    }

    /// Gives the places in the grid of the cells with a part inside the body.
    pub(crate) fn places(&self) -> impl Iterator<Item = [usize; 3]> {
        let numbers = self.cells.iter().enumerate().filter(|(_, cell)| cell.is_some());
        numbers.map(|(number, _)| self.grid.place(number))
    }

    /// Gives the displacement of a mode, along the axes of the file, at a point on or in the body;
    /// `None` far from it.
    pub fn value(&self, vector: &[f64], point: Point) -> Option<Point> {
        let local = self.grid.local(point);
        let counts = self.grid.counts();
        let home = [0, 1, 2].map(|axis| self.grid.layer_of(axis, local[axis]));
        // A point on a face may belong to a cell that the body does not reach: one beside it
        // serves.
        let near = (0..27).filter_map(|step| {
            let beside = [step % 3, step / 3 % 3, step / 9];
            let cell = [0, 1, 2].map(|axis| (home[axis] + beside[axis]).wrapping_sub(1));
            let is_there = (0..3).all(|axis| cell[axis] < counts[axis]);
            let number = is_there.then(|| self.cells[self.grid.number(cell)]).flatten()?;
            let place = [0, 1, 2].map(|axis| {
                let [low, high] = self.grid.layer(axis, cell[axis]);
                (local[axis] - low) / (high - low)
            });
            let outside = place.iter().map(|part| (-part).max(part - 1.0).max(0.0)).fold(0.0, f64::max);
            Some((outside, number, place))
        });
        let (_, number, place) = near.min_by(|a, b| a.0.total_cmp(&b.0)).filter(|(outside, ..)| *outside < 0.5)?;
        let along = place.map(lagrange);
        let mut own = [0.0; 3];
        for (index, node) in self.members[number].iter().enumerate() {
            let [x, y, z] = parts(index, FUNCTIONS);
            let factor = along[0][x][0] * along[1][y][0] * along[2][z][0];
            (0..3).for_each(|axis| own[axis] += factor * vector.get(3 * node + axis).copied().unwrap_or(0.0));
        }
        Some([0, 1, 2].map(|axis| (0..3).map(|part| own[part] * self.grid.axes[part][axis]).sum()))
    }
}
