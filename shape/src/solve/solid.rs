//! Solid: surface and material as the finite cells take them.

use std::f64::consts::{PI, TAU};

use super::body::{check_size, isotropic};
use super::{SolveError, Wanted};
use crate::file::{Edge, ShapeFile};
use crate::solid::{Cells, Grid, Solid};
use crate::surface::Surface;

/// Edges of the first and of the second cells, in wavelengths of the highest mode.
pub(super) const FIRST_SIZES: [f64; 2] = [0.8, 0.56];
/// Modes of a compact body beside the waves that its volume tells: those of its surface.
const OF_THE_SURFACE: f64 = 6.0;

/// Solid of a shape file.
#[derive(Clone, Debug)]
pub(super) struct SolidBody {
    pub(super) surface: Surface,
    solid: Solid,
}

impl SolidBody {
    pub(super) fn of(file: &ShapeFile, surface: Surface) -> Result<Self, SolveError> {
        let [low, high] = surface.bounds();
        check_size((0..3).map(|axis| high[axis] - low[axis]).fold(0.0, f64::max))?;
        let held = file.support.edges.iter().flatten().chain(&file.support.edge);
        if held.into_iter().any(|edge| *edge != Edge::Free) {
            return Err(SolveError::Held);
        }
        let (young, poisson, density) = isotropic(file)?;
        Ok(Self { surface, solid: Solid { young, poisson, density } })
    }

    /// Wavelength of the highest mode that is wanted, metres; at most twice the longest extent.
    pub(super) fn wavelength_m(&self, wanted: Wanted) -> f64 {
        let mut extents = self.extents();
        extents.sort_by(f64::total_cmp);
        let [_, middle, longest] = extents;
        let shear = self.solid.young / (2.0 * (1.0 + self.solid.poisson));
        let number = match wanted {
            // As many half waves as modes in a slender body, their root in a wide one, and their
            // cube root in a compact one.
            Wanted::Lowest(count) => {
                let count = count as f64;
                let slender = PI * (count + 1.0) / longest;
                let wide = (4.0 * PI * (count + 3.0) / (longest * middle)).sqrt();
                let compact = (2.0 * PI * PI * (count + OF_THE_SURFACE) / self.surface.volume_m3()).cbrt();
                slender.min(wide).min(compact)
            }
            // The wave of a bending plate as thick as the body is narrow, or that of shear.
            Wanted::Below(frequency_hz) => {
                let omega = TAU * frequency_hz;
                let bending = self.solid.young * extents[0] * extents[0] / 12.0;
                (omega * omega * self.solid.density / bending)
                    .powf(0.25)
                    .max(omega * (self.solid.density / shear).sqrt())
            }
        };
        (TAU / number).min(2.0 * longest)
    }

    /// Matrices on a grid of cells with edges of at most `size_m`.
    pub(super) fn cells(&self, size_m: f64) -> Result<Cells, SolveError> {
        let grid = Grid::over(&self.surface, size_m);
        let unknowns = grid.unknowns();
        if unknowns > super::MOST_UNKNOWNS {
            return Err(SolveError::TooLarge { unknowns });
        }
        Ok(self.solid.discretise(&self.surface, &grid)?)
    }

    /// Extents along the principal axes or the axes of the file, metres.
    fn extents(&self) -> [f64; 3] {
        Grid::over(&self.surface, f64::INFINITY).extents_m()
    }
}
