//! Sheets that move in their plane.

use super::assembly::{Body, STRAINS, assemble};
use super::support::Ties;
use super::{Discrete, Error, Material, Nodes, Support, positive};
use crate::mesh::Mesh;
use crate::outline::Point;

/// Hold of a sheet in the direction of its thickness.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum PlaneState {
    /// Nothing: it is thin (plane stress). [`super::Wide`] takes any width.
    #[default]
    Stress,
    /// All strain is held: it is a slice of a long body (plane strain). Isotropic materials only.
    Strain,
}

/// Flat body that moves in its plane. Components: the displacements u and v along x and y, metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sheet {
    /// Material.
    pub material: Material,
    /// Thickness, metres; frequencies do not depend on it.
    pub thickness: f64,
    /// Hold of it in the direction of its thickness.
    pub state: PlaneState,
}

impl Sheet {
    /// Parts the sheet into elements of an order from 1 to 4, its sides supported as given by their
    /// numbers. Hinged sides are clamped.
    pub fn discretise(&self, mesh: &Mesh, order: usize, supports: &[Support]) -> Result<Discrete, Error> {
        self.material.check()?;
        positive("the thickness", self.thickness)?;
        let elasticity = match self.state {
            PlaneState::Stress => self.material.plane_stress(),
            PlaneState::Strain => self.material.plane_strain()?,
        };
        let elasticity = elasticity.map(|line| line.map(|modulus| modulus * self.thickness));
        let nodes = Nodes::new(mesh, order)?;
        let ties = Ties::new(&nodes, supports, false)?;
        assemble(&Slice { elasticity, mass: self.material.density * self.thickness }, nodes, ties)
    }
}

/// Sheet by what a unit of its area has.
#[derive(Default)]
pub(super) struct Slice {
    elasticity: [[f64; 3]; 3],
    mass: f64,
}

impl Body for Slice {
    const COMPONENTS: usize = 2;
    const STRAINS: usize = 3;
    const TURNED: Option<usize> = None;

    /// Strains εx, εy and γxy.
    fn strains(&self, _value: f64, _lowered: [[f64; 2]; 2], [x, y]: [f64; 2], _at: Point) -> [[f64; 3]; STRAINS] {
        [[x, 0.0, 0.0], [0.0, y, 0.0], [y, x, 0.0], [0.0; 3], [0.0; 3], [0.0; 3]]
    }

    fn stiffness(&self) -> [[f64; STRAINS]; STRAINS] {
        let mut stiffness = [[0.0; STRAINS]; STRAINS];
        for (line, part) in stiffness.iter_mut().zip(&self.elasticity) {
            line[..3].copy_from_slice(part);
        }
        stiffness
    }

    fn inertia(&self) -> [f64; 3] {
        [self.mass, self.mass, 0.0]
    }

    fn rigid(&self, [x, y]: Point) -> Vec<[f64; 3]> {
        vec![[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [-y, x, 0.0]]
    }
}
