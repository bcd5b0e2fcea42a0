//! Bodies of revolution.

use std::f64::consts::{FRAC_1_SQRT_2, PI};

use super::assembly::{Body, STRAINS, assemble};
use super::material::lame;
use super::support::Ties;
use super::{Discrete, Elasticity, Error, Material, Nodes, Support};
use crate::mesh::Mesh;
use crate::outline::Point;

/// Body of revolution, whose mesh is its profile in the half-plane of the radius r ≥ 0 (first
/// coordinate) and the height z (second), metres.
///
/// Components at angle φ: u_r cos nφ, u_θ sin nφ and u_z cos nφ, metres. At n = 0 the motion along
/// the circumference, which does not depend on φ there, is u_θ itself.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Revolve {
    /// Material; isotropic.
    pub material: Material,
    /// Number n of waves around the axis.
    pub waves: u32,
}

impl Revolve {
    /// Parts the profile into elements of an order from 1 to 4, its sides supported as given by
    /// their numbers. Hinged sides are clamped; a side on the axis is free, and held as n demands.
    pub fn discretise(&self, mesh: &Mesh, order: usize, supports: &[Support]) -> Result<Discrete, Error> {
        self.material.check()?;
        let Elasticity::Isotropic { young, poisson } = self.material.elasticity else { return Err(Error::Orthotropic) };
        let nodes = Nodes::new(mesh, order)?;
        let mut ties = Ties::new(&nodes, supports, false)?;
        let widest = nodes.positions.iter().map(|position| position[0]).fold(0.0, f64::max);
        for (node, position) in nodes.positions.iter().enumerate() {
            if position[0] < -1e-9 * widest {
                return Err(Error::Quantity { name: "the radius of a point", value: position[0] });
            }
            if position[0] > 1e-9 * widest || ties.fixed[node] == [true; 3] {
                continue;
            }
            ties.fixed[node] = match self.waves {
                0 => [true, true, false],
                1 => {
                    // A point on the axis can only move across it: u_r = -u_θ.
                    ties.axes[node] = [FRAC_1_SQRT_2, -FRAC_1_SQRT_2];
                    [false, true, true]
                }
                _ => [true; 3],
            };
        }
        let (lame, shear) = lame(young, poisson);
        assemble(&Harmonic { waves: f64::from(self.waves), lame, shear, density: self.material.density }, nodes, ties)
    }
}

/// Body of revolution by what its energies need.
struct Harmonic {
    waves: f64,
    lame: f64,
    shear: f64,
    density: f64,
}

impl Body for Harmonic {
    const COMPONENTS: usize = 3;
    const STRAINS: usize = 6;
    const TURNED: Option<usize> = Some(0);

    /// Strains ε_rr, ε_θθ, ε_zz, γ_rz, γ_rθ and γ_θz.
    fn strains(
        &self,
        value: f64,
        _lowered: [[f64; 2]; 2],
        [along_r, along_z]: [f64; 2],
        at: Point,
    ) -> [[f64; 3]; STRAINS] {
        let round = value / at[0];
        let waves = self.waves * round;
        [
            [along_r, 0.0, 0.0],
            [round, waves, 0.0],
            [0.0, 0.0, along_z],
            [along_z, 0.0, along_r],
            [-waves, along_r - round, 0.0],
            [0.0, along_z, -waves],
        ]
    }

    fn stiffness(&self) -> [[f64; STRAINS]; STRAINS] {
        let mut stiffness = [[0.0; STRAINS]; STRAINS];
        for row in 0..3 {
            stiffness[row][..3].fill(self.lame);
            stiffness[row][row] += 2.0 * self.shear;
            stiffness[row + 3][row + 3] = self.shear;
        }
        stiffness
    }

    fn inertia(&self) -> [f64; 3] {
        [self.density; 3]
    }

    fn weight(&self, at: Point) -> f64 {
        at[0] * if self.waves == 0.0 { 2.0 * PI } else { PI }
    }

    fn rigid(&self, [radius, height]: Point) -> Vec<[f64; 3]> {
        if self.waves == 0.0 {
            vec![[0.0, 0.0, 1.0], [0.0, radius, 0.0]]
        } else if self.waves == 1.0 {
            vec![[1.0, -1.0, 0.0], [height, -height, -radius]]
        } else {
            Vec::new()
        }
    }

    fn uneven(&self) -> bool {
        true
    }
}
