//! Solid: surface and material as the finite cells take them.

use std::f64::consts::{PI, TAU};

use super::body::{check_size, isotropic};
use super::units::Units;
use super::{SolveError, Wanted};
use crate::file::{Edge, ShapeFile};
use crate::solid::{Cells, Grid, Solid};
use crate::surface::{Surface, SurfaceError};

/// Edges of the first and of the second cells, in wavelengths of the highest mode.
pub(super) const FIRST_SIZES: [f64; 2] = [0.8, 0.56];
/// Modes of a compact body beside the waves that its volume tells: those of its surface.
const OF_THE_SURFACE: f64 = 6.0;

/// Solid of a shape file.
#[derive(Clone, Debug)]
pub(super) struct SolidBody {
    /// Surface, metres.
    pub(super) surface: Surface,
    /// Units of what follows.
    pub(super) units: Units,
    inner: Surface,
    solid: Solid,
}

impl SolidBody {
    pub(super) fn of(file: &ShapeFile, surface: Surface) -> Result<Self, SolveError> {
        let [low, high] = surface.bounds();
        let longest = (0..3).map(|axis| high[axis] - low[axis]).fold(0.0, f64::max);
        check_size(longest)?;
        let held = file.support.edges.iter().flatten().chain(&file.support.edge);
        if held.into_iter().any(|edge| *edge != Edge::Free) {
            return Err(SolveError::Held);
        }
        let (young, poisson, density) = isotropic(file)?;
        let units = Units::of_body(longest, young, density);
        let inner = units.surface(&surface);
        Ok(Self { surface, units, inner, solid: Solid { young: 1.0, poisson, density: 1.0 } })
    }

    /// Wavelength of the highest mode that is wanted, in the body's units; at most twice the
    /// longest extent.
    pub(super) fn wavelength(&self, wanted: Wanted) -> f64 {
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
                let compact = (2.0 * PI * PI * (count + OF_THE_SURFACE) / self.inner.volume_m3()).cbrt();
                slender.min(wide).min(compact)
            }
            // The wave of a bending plate as thick as the body is narrow, or that of shear.
            Wanted::Below(frequency_hz) => {
                let omega = TAU * frequency_hz / self.units.rad_per_s;
                let bending = self.solid.young * extents[0] * extents[0] / 12.0;
                (omega * omega / bending).powf(0.25).max(omega / shear.sqrt())
            }
        };
        (TAU / number).min(2.0 * longest)
    }

    /// Matrices on a grid of cells with edges of at most a length, in the body's units.
    pub(super) fn cells(&self, size: f64) -> Result<Cells, SolveError> {
        let grid = Grid::over(&self.inner, size);
        let unknowns = grid.unknowns();
        if unknowns > super::MOST_UNKNOWNS {
            return Err(SolveError::TooLarge { unknowns });
        }
        Ok(self.solid.discretise(&self.inner, &grid).map_err(|error| match error {
            SurfaceError::Crossing(at) => SurfaceError::Crossing(at.map(|part| part * self.units.length_m)),
            other => other,
        })?)
    }

    /// Extents along the principal axes or the axes of the file.
    fn extents(&self) -> [f64; 3] {
        Grid::over(&self.inner, f64::INFINITY).extents_m()
    }
}
