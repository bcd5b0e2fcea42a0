//! Materials: density, elasticity and damping.

use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::LazyLock;

use serde::{Deserialize, Serialize};

use super::FileError;

/// One modulus, or those along the grain and across it.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
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
    /// Name of a shipped material ([`materials`]).
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

/// Shipped material, as `materials.toml` has it.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct NamedMaterial {
    /// Density, kg/m³.
    pub density_kg_per_m3: f64,
    /// Young's modulus, of wood along the grain and across it, Pa.
    pub youngs_modulus_pa: Modulus,
    /// Shear modulus in the plane of wood, Pa.
    pub shear_modulus_pa: Option<f64>,
    /// Poisson's ratio; of wood, the contraction across the grain for a stretch along it.
    pub poisson: f64,
    /// Rayleigh damping by mass, 1/s; 0 if missing.
    #[serde(default)]
    pub rayleigh_alpha_per_s: f64,
    /// Rayleigh damping by stiffness, s; 0 if missing.
    #[serde(default)]
    pub rayleigh_beta_s: f64,
    /// Loss factor, in place of Rayleigh damping.
    pub loss_factor: Option<f64>,
    /// Origin of the numbers: title and year, or "chosen".
    pub source: String,
}

/// Text of the shipped materials.
const TEXT: &str = include_str!("../../materials.toml");

/// Shipped materials by their names. A test holds the shipped text to be readable.
pub fn materials() -> &'static BTreeMap<String, NamedMaterial> {
    static MATERIALS: LazyLock<BTreeMap<String, NamedMaterial>> =
        LazyLock::new(|| toml::from_str(TEXT).unwrap_or_default());
    &MATERIALS
}

impl Material {
    /// Shipped material that the file names, if it names one.
    ///
    /// # Errors
    /// [`FileError::NoMaterial`].
    pub fn named(&self) -> Result<Option<&'static NamedMaterial>, FileError> {
        let Some(name) = &self.name else { return Ok(None) };
        materials().get(name).map(Some).ok_or_else(|| FileError::NoMaterial(name.clone()))
    }
}

#[cfg(test)]
mod tests {
    use super::{Modulus, NamedMaterial, TEXT};
    use std::collections::BTreeMap;

    #[test]
    fn shipped_materials_are_readable_and_tell_their_sources() {
        let all: BTreeMap<String, NamedMaterial> = toml::from_str(TEXT).expect("the shipped text is valid");
        assert!(all.len() >= 15, "{}", all.len());
        for (name, material) in &all {
            assert!(material.source.len() > 20, "{name}");
            let is_wood = matches!(material.youngs_modulus_pa, Modulus::Grain(_));
            assert_eq!(is_wood, material.shear_modulus_pa.is_some(), "{name}");
            let is_rayleigh = material.rayleigh_alpha_per_s > 0.0 || material.rayleigh_beta_s > 0.0;
            assert_ne!(is_rayleigh, material.loss_factor.is_some(), "{name}");
        }
    }
}
