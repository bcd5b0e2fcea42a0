//! Errors of shape files.

use super::materials;

/// Fault of a shape file.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum FileError {
    /// Text that is no TOML, or keys that the format does not know.
    #[error("{0}")]
    Text(String),
    /// Another version of the format.
    #[error("format = {0}: this program reads format 1")]
    Format(u32),
    /// Unknown material.
    #[error("material.name = \"{0}\" is none of {names}; give density_kg_per_m3, youngs_modulus_pa and poisson", names = names())]
    NoMaterial(String),
    /// Number that is missing.
    #[error("{key} is missing; {what}")]
    Missing {
        /// Key.
        key: &'static str,
        /// Meaning of the key.
        what: &'static str,
    },
    /// Number out of range.
    #[error("{key} = {value} must be {range}")]
    Range {
        /// Key.
        key: &'static str,
        /// Value in the file.
        value: f64,
        /// Range of the key.
        range: &'static str,
    },
    /// Keys that exclude each other or do not fit the kind.
    #[error("{0}")]
    Keys(&'static str),
}

fn names() -> String {
    materials().keys().map(String::as_str).collect::<Vec<_>>().join(", ")
}
