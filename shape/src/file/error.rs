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
    /// Key that this body does not use.
    #[error("line {line}: {table}.{key} is not used by {of}: {advice}")]
    Unused {
        /// Line of the file, 1 being the first.
        line: usize,
        /// Table of the key.
        table: &'static str,
        /// Key.
        key: &'static str,
        /// Body that does not use it.
        of: &'static str,
        /// Advice.
        advice: &'static str,
    },
    /// Stiff material without weight: a unit that was forgotten.
    #[error(
        "sound would run at {speed_km_per_s:.0} km/s in a material of {density_kg_per_m3} kg/m3 and {modulus_pa:e} Pa, and no material takes it above 30 km/s: is a unit forgotten? Steel has 7850 kg/m3 and 200e9 Pa"
    )]
    Speed {
        /// Speed of sound in a rod, km/s.
        speed_km_per_s: f64,
        /// Density.
        density_kg_per_m3: f64,
        /// Largest modulus.
        modulus_pa: f64,
    },
    /// Direction in the plane of a body that moves across it alone.
    #[error(
        "{key} lies in the plane of the body, which moves across it alone, so that all modes would be silent: give a third number that is not 0, or leave it out for [0, 0, 1]"
    )]
    InPlane {
        /// Key.
        key: &'static str,
    },
    /// Pressure at a place that is not before the body.
    #[error(
        "sound.at_m: the pressure is heard before the body, which lies at z = 0, and z = {z} m is not above {above_m} m: give a larger z"
    )]
    NotAbove {
        /// Height of the place, metres.
        z: f64,
        /// Height of the body's upper surface, metres.
        above_m: f64,
    },
    /// Keys that exclude each other or do not fit the kind.
    #[error("{0}")]
    Keys(&'static str),
}

/// Keys that each file has, as the reader names them, and what to give for them.
const NEEDED: [(&str, &str, &str); 5] = [
    ("format", "format", "give format = 1 at the beginning"),
    ("name", "name", "give the object a name, at the beginning, such as name = \"bar\""),
    ("shape", "[shape]", "give this table the kind of the body, its outline and its thickness"),
    (
        "material",
        "[material]",
        "give this table the name of a material, such as name = \"steel\" (`malleus shape --materials` lists them), or \
         numbers",
    ),
    ("kind", "shape.kind", "give plate, sheet, membrane, revolve or solid"),
];

impl FileError {
    /// The fault behind an error of the TOML reader, which takes the first line for the place of a
    /// key that is missing.
    pub(super) fn of_reader(error: &toml::de::Error) -> Self {
        let name = error.message().strip_prefix("missing field `").and_then(|name| name.strip_suffix('`'));
        match NEEDED.into_iter().find(|needed| Some(needed.0) == name) {
            Some((_, key, what)) => Self::Missing { key, what },
            None => Self::Text(error.to_string()),
        }
    }
}

fn names() -> String {
    materials().keys().map(String::as_str).collect::<Vec<_>>().join(", ")
}
