//! Plates after Reissner and Mindlin.

use std::f64::consts::PI;

use super::assembly::{Body, STRAINS, assemble};
use super::support::Ties;
use super::{Discrete, Elasticity, Error, Material, Nodes, Support, positive};
use crate::mesh::Mesh;
use crate::outline::Point;

/// Part of the shear over the thickness that a plate whose sections stay plane counts (Mindlin
/// 1951). Published plate frequencies have it; 5/6 would make waves exact up to (k h)², and is
/// 0.55 % off the benchmark FV52.
const SHEAR_CORRECTION: f64 = PI * PI / 12.0;

/// Flat plate that bends and shears, after Reissner and Mindlin.
///
/// A plate that bends becomes thinner where it is stretched: with a = ν/(1 - ν), a point moves
/// across the plate by w + a (∂θx/∂x + ∂θy/∂y) (z²/2 - h²/40), of which w is the mean weighted by
/// the shear's parabola. The mass takes this in.
///
/// Components: the deflection w, metres, and the slopes θx and θy of what was normal to the plate:
/// a point at height z above the middle moves by -z θ in the plane. Without shear θ = ∇w.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Plate {
    /// Material.
    pub material: Material,
    /// Thickness h, metres.
    pub thickness: f64,
}

impl Plate {
    /// Parts the plate into elements of an order from 1 to 4, its sides supported as given by their
    /// numbers. Hinged sides hold w and the slope along them; at their corners, all slopes.
    ///
    /// Thin plates want order 4: lower orders are far too stiff there.
    pub fn discretise(&self, mesh: &Mesh, order: usize, supports: &[Support]) -> Result<Discrete, Error> {
        self.material.check()?;
        positive("the thickness", self.thickness)?;
        let nodes = Nodes::new(mesh, order)?;
        let ties = Ties::new(&nodes, supports, true)?;
        assemble(self, nodes, ties)
    }
}

impl Body for Plate {
    const COMPONENTS: usize = 3;
    const STRAINS: usize = 5;
    const TURNED: Option<usize> = Some(1);
    const LOWERED: bool = true;

    /// Curvatures κx, κy and twist 2κxy, then shears γxz and γyz.
    ///
    /// The shears take slopes of the order that the derivatives of w have: whole slopes could
    /// hardly equal these in thin plates, and would make the elements too stiff.
    fn strains(
        &self,
        _value: f64,
        [along_x, along_y]: [[f64; 2]; 2],
        [x, y]: [f64; 2],
        _at: Point,
    ) -> [[f64; 3]; STRAINS] {
        [
            [0.0, x, 0.0],
            [0.0, 0.0, y],
            [0.0, y, x],
            [x, -along_x[0], -along_y[0]],
            [y, -along_x[1], -along_y[1]],
            [0.0; 3],
        ]
    }

    fn stiffness(&self) -> [[f64; STRAINS]; STRAINS] {
        let mut stiffness = [[0.0; STRAINS]; STRAINS];
        for (line, part) in stiffness.iter_mut().zip(self.material.plane_stress()) {
            line[..3].copy_from_slice(&part.map(|modulus| modulus * self.thickness.powi(3) / 12.0));
        }
        for (line, part) in stiffness[3..].iter_mut().zip(self.material.transverse()) {
            line[3..5].copy_from_slice(&part.map(|modulus| SHEAR_CORRECTION * modulus * self.thickness));
        }
        stiffness
    }

    fn inertia(&self) -> [f64; 3] {
        let mass = self.material.density * self.thickness;
        let turning = mass * self.thickness * self.thickness / 12.0;
        [mass, turning, turning]
    }

    /// Integrals of (z²/2 - h²/40) and of its square over the thickness are h³/60 and h⁵/600. An
    /// orthotropic material does not tell how it becomes thinner.
    fn swelling(&self) -> Option<[f64; 2]> {
        let Elasticity::Isotropic { poisson, .. } = self.material.elasticity else { return None };
        let thinner = poisson / (1.0 - poisson);
        let mass = self.material.density * thinner * self.thickness.powi(3);
        Some([mass / 60.0, mass * thinner * self.thickness * self.thickness / 600.0])
    }

    fn rigid(&self, [x, y]: Point) -> Vec<[f64; 3]> {
        vec![[1.0, 0.0, 0.0], [x, 1.0, 0.0], [y, 0.0, 1.0]]
    }
}
