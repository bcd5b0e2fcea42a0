//! The shape file: what a body is, of what, how it is held, struck and heard.

mod check;
mod error;
mod material;
mod point;
mod unused;

use std::path::PathBuf;

use serde::Deserialize;

pub use error::FileError;
pub use material::{Material, Modulus, NamedMaterial, materials};

/// A shape file, format 1: TOML, lengths in metres.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ShapeFile {
    /// Version of the format, 1.
    pub format: u32,
    /// Name of the object.
    pub name: String,
    /// Body.
    pub shape: Shape,
    /// Material.
    pub material: Material,
    /// Support; free if missing, membranes are clamped.
    #[serde(default)]
    pub support: Support,
    /// Places of strikes; nine from the middle to the rim if missing.
    #[serde(default)]
    pub strike: Strike,
    /// Place of what is heard; evenly over the body if missing.
    #[serde(default)]
    pub sound: Sound,
}

/// Kind of a body.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Kind {
    /// Flat plate that bends.
    Plate,
    /// Flat body that moves in its plane: an undercut bar seen from its side.
    Sheet,
    /// Skin under tension.
    Membrane,
    /// Body of revolution: a bell, a cymbal, a glass.
    Revolve,
    /// Solid: a block, a body of any surface.
    Solid,
}

/// State of a sheet across its plane.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Plane {
    /// No stress on the faces: bodies of any width.
    #[default]
    Stress,
    /// No strain across: long bodies.
    Strain,
}

/// Body: its kind, outline and thickness.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Shape {
    /// Kind of the body.
    pub kind: Kind,
    /// Corners of the outline, metres.
    #[serde(default, deserialize_with = "point::ring")]
    pub polygon_m: Option<Vec<[f64; 2]>>,
    /// Corners of the profile of a body of revolution: radius and height, metres.
    #[serde(default, deserialize_with = "point::ring")]
    pub profile_m: Option<Vec<[f64; 2]>>,
    /// Distance of the frequencies of a pair of a body of revolution, as a share of them.
    pub split: Option<f64>,
    /// SVG or PNG file with the outline, beside the shape file.
    pub outline: Option<PathBuf>,
    /// Surface of a solid, an STL or OBJ file beside the shape file.
    pub surface: Option<PathBuf>,
    /// Metres of a unit of the outline's or the surface's file, or of a pixel of a PNG file; that
    /// of a surface is 1 if missing.
    pub unit_m: Option<f64>,
    /// Corners of each hole, metres.
    #[serde(default, deserialize_with = "point::rings")]
    pub holes_m: Vec<Vec<[f64; 2]>>,
    /// Thickness of a plate, width of a sheet, metres.
    pub thickness_m: Option<f64>,
    /// Tension of a membrane, N/m.
    pub tension_n_per_m: Option<f64>,
    /// Mass of a membrane per area, kg/m².
    pub density_kg_per_m2: Option<f64>,
    /// State of a sheet across its plane.
    #[serde(default)]
    pub plane: Plane,
}

/// Support of an edge.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Edge {
    /// Moves freely.
    Free,
    /// Stays where it is, and may turn about the edge.
    Hinged,
    /// Neither moves nor turns.
    Clamped,
}

/// Support of the body.
#[derive(Clone, Debug, Default, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Support {
    /// Support of all edges.
    pub edge: Option<Edge>,
    /// Support by side of the outline, holes behind the outer ring.
    pub edges: Option<Vec<Edge>>,
}

/// Places of strikes.
#[derive(Clone, Debug, Default, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Strike {
    /// Corners of the path along which strikes lie, metres: two coordinates, on a solid three.
    pub path_m: Option<Vec<Vec<f64>>>,
    /// Number of positions evenly along the path, 1 to 64.
    pub positions: Option<usize>,
    /// Direction of a strike: two numbers on a sheet and on a body of revolution (radius, height),
    /// three on other bodies; normal to the surface if missing.
    pub direction: Option<Vec<f64>>,
    /// Peak force of the table's mallet at velocity 1, newtons; 20 if missing.
    pub peak_force_n: Option<f64>,
    /// Contact time of the table's mallet at velocity 1, seconds; 0.0005 if missing.
    pub contact_time_s: Option<f64>,
}

/// Readout of a mode: its share of what is heard.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Readout {
    /// Velocity of a point, m/s.
    Velocity,
    /// Sound pressure at a point before a plate in a baffle, Pa.
    Pressure,
    /// Share that is the same for each mode: the size of its shape at the strike (diffmodal §2.4).
    #[default]
    Even,
}

/// Place of what is heard.
#[derive(Clone, Debug, Default, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Sound {
    /// Readout.
    #[serde(default)]
    pub readout: Readout,
    /// Place, metres: two coordinates on the body, three on a solid or, for the pressure, before a
    /// plate; on a body of
    /// revolution radius and height, and the angle from the strike in degrees.
    pub at_m: Option<Vec<f64>>,
    /// Direction of the velocity, as that of a strike.
    pub direction: Option<Vec<f64>>,
}

impl ShapeFile {
    /// Corners of the outline, or of the profile of a body of revolution.
    pub fn corners_m(&self) -> Option<&[[f64; 2]]> {
        if self.shape.kind == Kind::Revolve { self.shape.profile_m.as_deref() } else { self.shape.polygon_m.as_deref() }
    }

    /// Reads a shape file's text and checks its numbers.
    ///
    /// # Errors
    /// A [`FileError`] that names the line or the key.
    pub fn parse(text: &str) -> Result<Self, FileError> {
        let file: Self = toml::from_str(text).map_err(|error| FileError::of_reader(&error))?;
        file.check(text)?;
        Ok(file)
    }
}
