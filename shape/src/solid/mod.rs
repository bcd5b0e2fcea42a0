//! Finite cells: the modes of a solid without a mesh of it.
//!
//! A grid of hexahedra covers the body. Their functions are polynomials of order 3 along each axis.
//! The energies are integrated inside the surface alone, exactly for its triangles; the rest of a
//! cell has 1e-7 of the stiffness and no mass (Parvizian, Düster and Rank 2007).

mod assembly;
mod cell;
mod cells;
mod functions;
mod grid;
mod moments;

pub use cells::{Cells, RIGID};
pub use grid::Grid;

use crate::surface::{Surface, SurfaceError};

/// Order of the functions along each axis.
pub const ORDER: usize = 3;

/// Elastic solid, alike in all directions.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Solid {
    /// Young's modulus E, Pa.
    pub young: f64,
    /// Poisson's ratio ν, -1 to 0.5.
    pub poisson: f64,
    /// Density ρ, kg/m³.
    pub density: f64,
}

impl Solid {
    /// Makes the matrices of the free body within a surface, on a grid.
    ///
    /// # Errors
    /// [`SurfaceError::Crossing`] where the surface encloses a part twice or inside out.
    pub fn discretise(&self, surface: &Surface, grid: &Grid) -> Result<Cells, SurfaceError> {
        let moments = moments::of(surface, grid)?;
        Ok(assembly::assemble(self, grid, &moments))
    }
}
