//! Materials: density, elasticity and damping.

use std::path::PathBuf;

use serde::Deserialize;

use super::FileError;

/// One modulus, or those along the grain and across it.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(untagged)]
pub enum Modulus {
    /// Modulus for all directions, Pa.
    All(f64),
    /// Along the grain and across it, Pa.
    Grain([f64; 2]),
}

/// Material of a shape file: a shipped one by its name, whose numbers the other keys replace.
#[derive(Clone, Debug, Default, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Material {
    /// Name of a shipped material ([`MATERIALS`]).
    pub name: Option<String>,
    /// Density, kg/m³.
    pub density_kg_per_m3: Option<f64>,
    /// Young's modulus, Pa.
    pub youngs_modulus_pa: Option<Modulus>,
    /// Shear modulus in the plane of wood, Pa.
    pub shear_modulus_pa: Option<f64>,
    /// Poisson's ratio; of wood, the contraction across the grain for a stretch along it.
    pub poisson: Option<f64>,
    /// Angle of the grain to the x axis, degrees.
    #[serde(default)]
    pub grain_deg: f64,
    /// Rayleigh damping by mass, 1/s: d = (α + β ω²)/2.
    pub rayleigh_alpha_per_s: Option<f64>,
    /// Rayleigh damping by stiffness, s.
    pub rayleigh_beta_s: Option<f64>,
    /// Loss factor η: d = η ω/2.
    pub loss_factor: Option<f64>,
    /// Table of a fit, beside the shape file, whose decays by frequency hold for the body.
    pub damping: Option<PathBuf>,
}

/// Shipped material: isotropic, with Rayleigh damping.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NamedMaterial {
    /// Name.
    pub name: &'static str,
    /// Density, kg/m³.
    pub density_kg_per_m3: f64,
    /// Young's modulus, Pa.
    pub youngs_modulus_pa: f64,
    /// Poisson's ratio.
    pub poisson: f64,
    /// Rayleigh damping by mass, 1/s.
    pub rayleigh_alpha_per_s: f64,
    /// Rayleigh damping by stiffness, s.
    pub rayleigh_beta_s: f64,
}

const fn material(
    name: &'static str,
    density: f64,
    modulus: f64,
    poisson: f64,
    alpha: f64,
    beta: f64,
) -> NamedMaterial {
    NamedMaterial {
        name,
        density_kg_per_m3: density,
        youngs_modulus_pa: modulus,
        poisson,
        rayleigh_alpha_per_s: alpha,
        rayleigh_beta_s: beta,
    }
}

/// Shipped materials: those that are usual in modal sound work (James, Barbič and Pai 2006; Wang
/// and James 2019).
/// James 2019).
pub const MATERIALS: [NamedMaterial; 8] = [
    material("ceramic", 2700.0, 7.2e10, 0.19, 6.0, 1e-7),
    material("glass", 2600.0, 6.2e10, 0.20, 1.0, 1e-7),
    material("wood", 750.0, 1.1e10, 0.25, 60.0, 2e-6),
    material("plastic", 1070.0, 1.4e9, 0.35, 30.0, 1e-6),
    material("iron", 8000.0, 2.1e11, 0.28, 5.0, 1e-7),
    material("polycarbonate", 1190.0, 2.4e9, 0.37, 0.5, 4e-7),
    material("steel", 7850.0, 2.0e11, 0.29, 5.0, 3e-8),
    material("tin", 7265.0, 5e10, 0.325, 2.0, 3e-8),
];

impl Material {
    /// Shipped material that the file names, if it names one.
    ///
    /// # Errors
    /// [`FileError::NoMaterial`].
    pub fn named(&self) -> Result<Option<&'static NamedMaterial>, FileError> {
        let Some(name) = &self.name else { return Ok(None) };
        let found = MATERIALS.iter().find(|material| material.name == name);
        found.map(Some).ok_or_else(|| FileError::NoMaterial(name.clone()))
    }
}
