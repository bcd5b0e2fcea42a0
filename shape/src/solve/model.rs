//! Body of any kind: flat ones and those of revolution, and solids.

use super::figure::{self, Figure};
use super::parts::{Matrices, Part, Place};
use super::places::Round;
use super::solid::SolidBody;
use super::solid_figure;
use super::solid_places::SolidPlaces;
use super::units::Units;
use super::{Body, Places, SolveError, Wanted};
use crate::eigen::Modes;
use crate::file::{Kind, ShapeFile};
use crate::gain::Gain;
use crate::mesh::Mesh;
use crate::outline::Outline;
use crate::surface::Surface;

/// Border of a body: the outline of a flat one, the profile of a round one, or the surface of a
/// solid.
#[derive(Clone, Copy, Debug)]
pub enum Geometry<'a> {
    /// Outline; a solid goes from z = 0 to its thickness over it.
    Outline(&'a Outline),
    /// Surface of a solid.
    Surface(&'a Surface),
}

impl<'a> From<&'a Outline> for Geometry<'a> {
    fn from(outline: &'a Outline) -> Self {
        Self::Outline(outline)
    }
}

impl<'a> From<&'a Surface> for Geometry<'a> {
    fn from(surface: &'a Surface) -> Self {
        Self::Surface(surface)
    }
}

/// Body with the places of its strikes.
pub(super) enum Model {
    Flat { body: Box<Body>, places: Places },
    Solid { body: SolidBody, places: SolidPlaces },
}

/// Discretisation of a body at one size of its elements.
pub(super) struct Level {
    /// Mesh of a flat body or of a profile, in the body's units; a solid has cells instead.
    pub(super) mesh: Option<Mesh>,
    /// Matrices of the motion without waves round the axis, of all motion otherwise.
    pub(super) first: Matrices,
    /// Number of triangles or cells.
    pub(super) elements: usize,
}

impl Model {
    pub(super) fn of(file: &ShapeFile, geometry: Geometry<'_>, wanted: Wanted, error: f64) -> Result<Self, SolveError> {
        let thickness_m = file.shape.thickness_m.unwrap_or(0.0);
        Ok(match (file.shape.kind, geometry) {
            (Kind::Solid, geometry) => {
                let (surface, top_m) = match geometry {
                    Geometry::Outline(outline) => (Surface::extruded(outline, thickness_m)?, Some(thickness_m)),
                    Geometry::Surface(surface) => (surface.clone(), None),
                };
                let places = SolidPlaces::of(file, &surface, top_m)?;
                Self::Solid { body: SolidBody::of(file, surface)?, places }
            }
            (_, Geometry::Outline(outline)) => {
                let places = Places::of(file, outline)?;
                let body = Body::of(file, outline, error)?.expanded(wanted, error)?;
                Self::Flat { body: Box::new(body), places }
            }
            (_, Geometry::Surface(_)) => return Err(SolveError::NoSolid),
        })
    }

    /// Units in which the body is solved.
    pub(super) fn units(&self) -> Units {
        match self {
            Self::Flat { body, .. } => body.units,
            Self::Solid { body, .. } => body.units,
        }
    }

    /// Edges of the first elements and of the second ones, in the body's units.
    pub(super) fn first_sizes(&self, wanted: Wanted) -> [f64; 2] {
        match self {
            Self::Flat { body, .. } => body.first_sizes().map(|size| size * body.wavelength(wanted)),
            Self::Solid { body, .. } => super::solid::FIRST_SIZES.map(|size| size * body.wavelength(wanted)),
        }
    }

    /// Guess of the lowest ω² that is not 0, in the body's units; `None` if there is none.
    pub(super) fn lowest(&self) -> Option<f64> {
        match self {
            Self::Flat { body, .. } => body.lowest(),
            Self::Solid { .. } => None,
        }
    }

    /// Takes places and modes to metres, seconds and kilograms; the matrices keep the body's units.
    pub(super) fn measure(&self, matrices: &mut Matrices, found: &mut Modes) {
        let units = self.units();
        units.measure(found);
        match (self, matrices) {
            (Self::Flat { body, .. }, Matrices::Flat(discrete)) => {
                discrete.stretch(units.length_m);
                if body.kind == Kind::Plate {
                    discrete.turn_less(&mut found.vectors, units.length_m);
                }
            }
            (_, Matrices::Solid(cells)) => cells.measure(units.length_m, units.mass_kg),
            (Self::Solid { .. }, Matrices::Flat(_)) => {}
        }
    }

    /// Power of the length of the edges as which errors fall at least; `None` if none is known.
    pub(super) fn falls(&self) -> Option<i32> {
        match self {
            Self::Flat { body, .. } => body.falls(),
            Self::Solid { .. } => None,
        }
    }

    /// Discretisation with edges of at most a length, in the body's units.
    pub(super) fn level(&self, size: f64) -> Result<Level, SolveError> {
        Ok(match self {
            Self::Flat { body, .. } => {
                let mesh = body.mesh(size)?;
                let first = Matrices::Flat(Box::new(body.elements(&mesh, 0)?));
                Level { elements: mesh.triangles.len(), mesh: Some(mesh), first }
            }
            Self::Solid { body, .. } => {
                let cells = body.cells(size)?;
                Level { elements: cells.len(), mesh: None, first: Matrices::Solid(Box::new(cells)) }
            }
        })
    }

    /// Matrices of the motion with a number of waves round the axis; `None` if the body has no such
    /// axis.
    pub(super) fn round(&self, mesh: Option<&Mesh>, waves: u32) -> Result<Option<Matrices>, SolveError> {
        let (Self::Flat { body, .. }, Some(mesh)) = (self, mesh) else { return Ok(None) };
        if !body.is_round() {
            return Ok(None);
        }
        Ok(Some(Matrices::Flat(Box::new(body.elements(mesh, waves)?))))
    }

    /// Share by which the theory errs at a frequency, against elasticity in space.
    pub(super) fn model_error(&self, frequency_hz: f64) -> f64 {
        match self {
            Self::Flat { body, .. } => body.model_error(frequency_hz),
            Self::Solid { .. } => 0.0,
        }
    }

    /// Distance of the frequencies of a pair, as a share of them.
    pub(super) fn split(&self) -> f64 {
        match self {
            Self::Flat { body, .. } => body.split,
            Self::Solid { .. } => 0.0,
        }
    }

    /// Mass, kg.
    pub(super) fn mass_kg(&self, matrices: &Matrices) -> f64 {
        match (self, matrices) {
            (Self::Flat { body, .. }, Matrices::Flat(discrete)) => body.mass_kg(discrete),
            (_, Matrices::Solid(cells)) => cells.mass_kg,
            (Self::Solid { .. }, Matrices::Flat(_)) => 0.0,
        }
    }

    /// Picture of the lowest modes.
    pub(super) fn figure(
        &self,
        mesh: Option<&Mesh>,
        parts: &[Part],
        modes: &[Place],
    ) -> Result<Option<Figure>, SolveError> {
        match (self, mesh) {
            (Self::Flat { places, .. }, Some(mesh)) => figure::of(mesh, parts, modes, places).map(Some),
            (Self::Solid { body, places }, _) => solid_figure::of(&body.surface, places, parts, modes),
            _ => Ok(None),
        }
    }

    /// Gains of a mode at all positions; ω in rad/s, d in 1/s.
    pub(super) fn gains(
        &self,
        matrices: &Matrices,
        vector: &[f64],
        round: Round,
        omega: f64,
        decay_per_s: f64,
    ) -> Result<Vec<Gain>, SolveError> {
        match (self, matrices) {
            (Self::Flat { places, .. }, Matrices::Flat(discrete)) => {
                places.gains(discrete, vector, round, omega, decay_per_s)
            }
            (Self::Solid { places, .. }, Matrices::Solid(cells)) => places.gains(cells, vector, omega, decay_per_s),
            _ => Ok(vec![]),
        }
    }
}
