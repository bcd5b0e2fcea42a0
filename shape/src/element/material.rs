//! Elastic materials.

use super::{Error, positive};

/// Elasticity of a material.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Elasticity {
    /// Elasticity alike in all directions.
    Isotropic {
        /// Young's modulus E, Pa.
        young: f64,
        /// Poisson's ratio ν.
        poisson: f64,
    },
    /// Different along and across a grain, as that of wood or of laminates.
    Orthotropic {
        /// Young's moduli along and across the grain, Ex and Ey, Pa.
        young: [f64; 2],
        /// Poisson's ratio νxy: contraction across the grain for stretch along it.
        poisson: f64,
        /// Shear modulus in the plane, Gxy, Pa.
        shear: f64,
        /// Shear moduli over the thickness along and across the grain, Gxz and Gyz, Pa.
        transverse: [f64; 2],
        /// Angle from the x axis to the grain, counter-clockwise, radians.
        grain: f64,
    },
}

/// Material of a body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Material {
    /// Elasticity.
    pub elasticity: Elasticity,
    /// Density ρ, kg/m³.
    pub density: f64,
}

impl Material {
    /// Makes an isotropic material from Young's modulus (Pa), Poisson's ratio and density (kg/m³).
    pub fn isotropic(young: f64, poisson: f64, density: f64) -> Self {
        Self { elasticity: Elasticity::Isotropic { young, poisson }, density }
    }

    /// Checks that all constants are possible.
    pub(super) fn check(&self) -> Result<(), Error> {
        positive("the density", self.density)?;
        match self.elasticity {
            Elasticity::Isotropic { young, poisson } => {
                positive("Young's modulus", young)?;
                if poisson > -1.0 && poisson < 0.5 {
                    return Ok(());
                }
                Err(Error::Quantity { name: "Poisson's ratio", value: poisson })
            }
            Elasticity::Orthotropic { young, poisson, shear, transverse, grain } => {
                positive("Young's modulus along the grain", young[0])?;
                positive("Young's modulus across the grain", young[1])?;
                positive("the shear modulus in the plane", shear)?;
                positive("the shear modulus along the grain", transverse[0])?;
                positive("the shear modulus across the grain", transverse[1])?;
                if !grain.is_finite() {
                    return Err(Error::Quantity { name: "the angle of the grain", value: grain });
                }
                if poisson * poisson * young[1] / young[0] < 1.0 {
                    return Ok(());
                }
                Err(Error::Quantity { name: "Poisson's ratio", value: poisson })
            }
        }
    }

    /// Returns the stiffness of plane stress, Pa, for the strains εx, εy, γxy.
    pub(super) fn plane_stress(&self) -> [[f64; 3]; 3] {
        match self.elasticity {
            Elasticity::Isotropic { young, poisson } => {
                let stiffness = young / (1.0 - poisson * poisson);
                let shear = stiffness * (1.0 - poisson) / 2.0;
                [[stiffness, poisson * stiffness, 0.0], [poisson * stiffness, stiffness, 0.0], [0.0, 0.0, shear]]
            }
            Elasticity::Orthotropic { young, poisson, shear, grain, .. } => {
                let rest = 1.0 - poisson * poisson * young[1] / young[0];
                let mixed = poisson * young[1] / rest;
                let along = [[young[0] / rest, mixed, 0.0], [mixed, young[1] / rest, 0.0], [0.0, 0.0, shear]];
                let (s, c) = grain.sin_cos();
                let turn = [[c * c, s * s, c * s], [s * s, c * c, -c * s], [-2.0 * c * s, 2.0 * c * s, c * c - s * s]];
                turned(&along, &turn)
            }
        }
    }

    /// Returns the stiffness in space, Pa, for the strains εx, εy, γxy, εz, γxz and γyz; the grain
    /// lies in the plane of x and y.
    ///
    /// A file does not tell the moduli of wood across that plane: wood counts as alike in all
    /// directions across its grain, so that Ez = Ey, Gxz = Gxy, νxz = νxy, and Gyz follows from
    /// νyz. This one is `around`, or νxy as in an isotropic material, and less where no body could
    /// have it.
    pub(super) fn space(&self, around: Option<f64>) -> [[f64; 6]; 6] {
        let mut stiffness = [[0.0; 6]; 6];
        match self.elasticity {
            Elasticity::Isotropic { young, poisson } => {
                let (lame, shear) = lame(young, poisson);
                for row in [0, 1, 3] {
                    [0, 1, 3].into_iter().for_each(|column| stiffness[row][column] = lame);
                    stiffness[row][row] += 2.0 * shear;
                }
                [2, 4, 5].into_iter().for_each(|row| stiffness[row][row] = shear);
                stiffness
            }
            Elasticity::Orthotropic { young: [along, across], poisson, shear, grain, .. } => {
                let mixed = poisson * poisson * across / along;
                let around = around.unwrap_or(poisson).min(0.9 - 1.9 * mixed);
                // Inverse of the compliance of εx, εy and εz, x along the grain.
                let rest = 1.0 - around - 2.0 * mixed;
                let lateral = poisson * across / rest;
                let own = across * (1.0 - mixed) / (rest * (1.0 + around));
                let other = across * (around + mixed) / (rest * (1.0 + around));
                let round_shear = across / (2.0 * (1.0 + around));
                stiffness[0] = [along * (1.0 - around) / rest, lateral, 0.0, lateral, 0.0, 0.0];
                stiffness[1] = [lateral, own, 0.0, other, 0.0, 0.0];
                stiffness[2][2] = shear;
                stiffness[3] = [lateral, other, 0.0, own, 0.0, 0.0];
                stiffness[4][4] = shear;
                stiffness[5][5] = round_shear;
                let (s, c) = grain.sin_cos();
                let turn = [
                    [c * c, s * s, c * s, 0.0, 0.0, 0.0],
                    [s * s, c * c, -c * s, 0.0, 0.0, 0.0],
                    [-2.0 * c * s, 2.0 * c * s, c * c - s * s, 0.0, 0.0, 0.0],
                    [0.0, 0.0, 0.0, 1.0, 0.0, 0.0],
                    [0.0, 0.0, 0.0, 0.0, c, s],
                    [0.0, 0.0, 0.0, 0.0, -s, c],
                ];
                turned(&stiffness, &turn)
            }
        }
    }

    /// Returns the stiffness of plane strain, Pa, for the strains εx, εy, γxy.
    pub(super) fn plane_strain(&self) -> Result<[[f64; 3]; 3], Error> {
        let Elasticity::Isotropic { young, poisson } = self.elasticity else { return Err(Error::Orthotropic) };
        let (lame, shear) = lame(young, poisson);
        Ok([[lame + 2.0 * shear, lame, 0.0], [lame, lame + 2.0 * shear, 0.0], [0.0, 0.0, shear]])
    }

    /// Returns the stiffness against shear over the thickness, Pa, for γxz and γyz.
    pub(super) fn transverse(&self) -> [[f64; 2]; 2] {
        match self.elasticity {
            Elasticity::Isotropic { young, poisson } => {
                let shear = lame(young, poisson).1;
                [[shear, 0.0], [0.0, shear]]
            }
            Elasticity::Orthotropic { transverse, grain, .. } => {
                let (sine, cosine) = grain.sin_cos();
                turned(&[[transverse[0], 0.0], [0.0, transverse[1]]], &[[cosine, sine], [-sine, cosine]])
            }
        }
    }
}

/// Returns Lamé's constants λ and μ, Pa.
pub(super) fn lame(young: f64, poisson: f64) -> (f64, f64) {
    (young * poisson / ((1.0 + poisson) * (1.0 - 2.0 * poisson)), young / (2.0 * (1.0 + poisson)))
}

/// Stiffness for strains that a matrix turns into those of the given stiffness.
fn turned<const N: usize>(stiffness: &[[f64; N]; N], turn: &[[f64; N]; N]) -> [[f64; N]; N] {
    let mut result = [[0.0; N]; N];
    for (row, line) in result.iter_mut().enumerate() {
        for (column, entry) in line.iter_mut().enumerate() {
            for (left, inner) in stiffness.iter().enumerate() {
                for (right, value) in inner.iter().enumerate() {
                    *entry += turn[left][row] * value * turn[right][column];
                }
            }
        }
    }
    result
}
