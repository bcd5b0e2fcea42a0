//! Errors on the way from a shape to its modes.

use kit::counting::counted;

use crate::eigen::EigenError;
use crate::element;
use crate::file::FileError;
use crate::mesh::MeshError;
use crate::outline::OutlineError;
use crate::surface::{ExtrudeError, Point, SurfaceError};

/// Fault of a shape, or a limit of the method.
#[derive(Debug, thiserror::Error)]
pub enum SolveError {
    /// Fault in the file.
    #[error(transparent)]
    File(#[from] FileError),
    /// Fault of the outline.
    #[error(transparent)]
    Outline(#[from] OutlineError),
    /// Fault of the surface of a solid.
    #[error(transparent)]
    Surface(#[from] SurfaceError),
    /// Outline over which no solid stands.
    #[error(transparent)]
    Extrude(#[from] ExtrudeError),
    /// Surface of a body that is no solid.
    #[error("a surface is that of a solid: set shape.kind = \"solid\"")]
    NoSolid,
    /// Solid that is held.
    #[error("a solid is free: leave out [support]; a body that is held is a plate, a sheet or a membrane")]
    Held,
    /// Solid with a grain.
    #[error("a solid is alike in all directions: give one youngs_modulus_pa; grain is for plates and sheets")]
    Grain,
    /// Place of a solid without its height.
    #[error("{key}: a point on a solid with a surface has three coordinates, [x, y, z]")]
    Coordinates {
        /// Key in the file.
        key: &'static str,
    },
    /// Place off the surface of a solid.
    #[error("{key}: the point ({:.6}, {:.6}, {:.6}) m is not on the surface of the body", at[0], at[1], at[2])]
    OffSurface {
        /// Key in the file.
        key: &'static str,
        /// Place, metres.
        at: Point,
    },
    /// Outline that no mesh can be made of.
    #[error(transparent)]
    Mesh(#[from] MeshError),
    /// Numbers that no element can be made of.
    #[error(transparent)]
    Element(#[from] element::Error),
    /// Modes that were not found.
    #[error(transparent)]
    Eigen(#[from] EigenError),
    /// Error out of range.
    #[error("an error of {0} is asked for; it must be above 0 and below 0.5")]
    Error(f64),
    /// Number of supports that is not that of the sides.
    #[error(
        "support.edges has {}, and the outline {}: {listed}; give one entry for each",
        counted(*given, "entries"),
        counted(*sides, "sides")
    )]
    Edges {
        /// Number in the file.
        given: usize,
        /// Number of sides.
        sides: usize,
        /// Numbers of straight and curved sides, in their order.
        listed: String,
    },
    /// Size of which no instrument is: a unit that was forgotten.
    #[error(
        "the body is {size_m} m long, and bodies from 1 mm to 20 m are solved; lengths are in metres: is {unit} meant?"
    )]
    Size {
        /// Longest extent.
        size_m: f64,
        /// Unit that would fit.
        unit: &'static str,
    },
    /// Plate that is too thick for the theory of plates.
    #[error(
        "thickness_m = {thickness_m} is more than a third of the width of {width_m} m; that is no plate: a sheet seen from the side, or a solid"
    )]
    Thick {
        /// Thickness.
        thickness_m: f64,
        /// Smaller extent of the outline.
        width_m: f64,
    },
    /// Place outside of the body.
    #[error("{key}: the point ({x}, {y}) m is not on the body")]
    Outside {
        /// Key in the file.
        key: &'static str,
        /// Coordinates, metres.
        x: f64,
        /// Coordinates, metres.
        y: f64,
    },
    /// Readout that the kind of body does not have.
    #[error(
        "sound.readout = \"pressure\" is that of a plate or a membrane in a baffle; take velocity for other bodies"
    )]
    NoPressure,
    /// Nothing that vibrates up to the highest frequency.
    #[error("no mode lies up to the highest frequency; ask for --modes N")]
    NoModes,
    /// Body that is too small to be heard.
    #[error(
        "the lowest mode lies at {lowest_hz:.0} Hz, and sound ends at {highest_hz:.0} Hz; lengths are in metres: is a unit forgotten?"
    )]
    Inaudible {
        /// Lowest frequency.
        lowest_hz: f64,
        /// Highest frequency that is rendered.
        highest_hz: f64,
    },
    /// Mode that does not oscillate.
    #[error(
        "the mode at {frequency_hz} Hz decays with {decay_per_s} 1/s and does not oscillate; lower the damping or the number of modes"
    )]
    Overdamped {
        /// Frequency without damping.
        frequency_hz: f64,
        /// Decay.
        decay_per_s: f64,
    },
    /// Mesh beyond the memory.
    #[error("this error would take {unknowns} unknowns, and at most {most} are solved; ask for a larger --error or fewer modes", most = super::MOST_UNKNOWNS)]
    TooLarge {
        /// Number of unknowns.
        unknowns: usize,
    },
    /// Mesh of more triangles than are made.
    #[error(
        "the modes would take about {triangles:.0} triangles, and at most {most:.0} are made; ask for fewer modes, a lower --max-hz or a larger --error"
    )]
    TooFine {
        /// Estimate of the number of triangles.
        triangles: f64,
        /// Largest number.
        most: f64,
    },
    /// Frequencies that still move on the finest mesh.
    #[error(
        "an error of {error} is asked for, and the finest mesh within 2 GB of memory reaches {reached:.2e}; ask for a larger --error or fewer modes"
    )]
    NotConverged {
        /// Error that was asked for.
        error: f64,
        /// Largest estimate.
        reached: f64,
    },
}
