//! Membranes under tension.

use super::assembly::{Body, STRAINS, assemble};
use super::support::Ties;
use super::{Discrete, Error, Nodes, Support, positive};
use crate::mesh::Mesh;
use crate::outline::Point;

/// Membrane under the same tension in all directions. Component: the deflection w, metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Membrane {
    /// Tension T, N/m.
    pub tension: f64,
    /// Mass of a unit of area σ, kg/m².
    pub density: f64,
}

impl Membrane {
    /// Parts the membrane into elements of an order from 1 to 4, its sides supported as given by
    /// their numbers. Hinged sides are clamped.
    pub fn discretise(&self, mesh: &Mesh, order: usize, supports: &[Support]) -> Result<Discrete, Error> {
        positive("the tension", self.tension)?;
        positive("the mass of a unit of area", self.density)?;
        let nodes = Nodes::new(mesh, order)?;
        let ties = Ties::new(&nodes, supports, false)?;
        assemble(self, nodes, ties)
    }
}

impl Body for Membrane {
    const COMPONENTS: usize = 1;
    const STRAINS: usize = 2;
    const TURNED: Option<usize> = None;

    fn strains(&self, _value: f64, _lowered: [[f64; 2]; 2], [x, y]: [f64; 2], _at: Point) -> [[f64; 3]; STRAINS] {
        [[x, 0.0, 0.0], [y, 0.0, 0.0], [0.0; 3], [0.0; 3], [0.0; 3], [0.0; 3]]
    }

    fn stiffness(&self) -> [[f64; STRAINS]; STRAINS] {
        let mut stiffness = [[0.0; STRAINS]; STRAINS];
        stiffness[0][0] = self.tension;
        stiffness[1][1] = self.tension;
        stiffness
    }

    fn inertia(&self) -> [f64; 3] {
        [self.density, 0.0, 0.0]
    }

    fn rigid(&self, _at: Point) -> Vec<[f64; 3]> {
        vec![[1.0, 0.0, 0.0]]
    }
}
