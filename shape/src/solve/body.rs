//! Body: outline, material and support as the elements take them.

use std::f64::consts::TAU;

use super::SolveError;
use super::across::Across;
use super::places::pieces;
use super::units::{Units, relative, rounded};
use crate::element::{
    self, Discrete, Elasticity, Material, Membrane, PlaneState, Plate, Revolve, Sheet, Support, Wide,
};
use crate::file::{Edge, Kind, Modulus, Plane, ShapeFile};
use crate::mesh::{Mesh, MeshError, Sizing};
use crate::outline::{FlatSide, Outline};

/// Extents of bodies, metres: others are units that were forgotten.
const EXTENT_M: [f64; 2] = [1e-3, 20.0];
/// Order of the elements.
const ORDER: usize = 4;

/// Body of a shape file.
#[derive(Clone, Debug)]
pub struct Body {
    pub(super) kind: Kind,
    /// Units of all that follows.
    pub(crate) units: Units,
    pub(super) outline: Outline,
    pub(super) supports: Vec<Support>,
    pub(super) material: Material,
    pub(super) plane: PlaneState,
    /// Thickness of a plate or width of a sheet; 0 for a membrane.
    pub(super) thickness: f64,
    /// Distance of the frequencies of a pair, as a share of them.
    pub(super) split: f64,
    /// True if a row of elements lies along free edges of a plate.
    pub(super) has_rows: bool,
    /// Expansion of a sheet across its width.
    pub(super) across: Across,
}

impl Body {
    /// Body of a file and its outline, for frequencies with a relative error.
    ///
    /// # Errors
    /// A [`SolveError`] for numbers that fit no body.
    pub fn of(file: &ShapeFile, outline: &Outline, error: f64) -> Result<Self, SolveError> {
        outline.check()?;
        let [low, high] = outline.bounds().unwrap_or_default();
        let extents = [0, 1].map(|axis| high[axis] - low[axis]);
        let longest = extents[0].max(extents[1]);
        check_size(longest)?;
        let kind = file.shape.kind;
        if kind == Kind::Revolve && low[0] < -1e-9 * longest {
            return Err(element::Error::Quantity { name: "the radius of a point", value: low[0] }.into());
        }
        let thickness_m = if kind == Kind::Membrane { 0.0 } else { file.shape.thickness_m.unwrap_or(0.0) };
        let width_m = width(outline, extents);
        if kind == Kind::Plate && thickness_m > width_m / 3.0 * (1.0 + 1e-9) {
            return Err(SolveError::Thick { thickness_m, width_m });
        }
        let sides = outline.sides().len();
        let whole = if kind == Kind::Membrane { Edge::Clamped } else { Edge::Free };
        let edges = match &file.support.edges {
            Some(edges) if edges.len() != sides => {
                let listed = super::edges::listed(outline);
                return Err(SolveError::Edges { given: edges.len(), sides, listed });
            }
            Some(edges) => super::edges::by_side(file, outline, edges),
            None => vec![file.support.edge.unwrap_or(whole); sides],
        };
        let support = |edge: &Edge| match edge {
            Edge::Free => Support::Free,
            Edge::Hinged => Support::Hinged,
            Edge::Clamped => Support::Clamped,
        };
        let mut supports: Vec<Support> = edges.iter().map(support).collect();
        if kind == Kind::Revolve {
            // The axis is no edge of the body.
            let on_axis = |side: &FlatSide| side.from[0] == 0.0 && side.to[0] == 0.0;
            let sides = outline.sides();
            supports
                .iter_mut()
                .zip(&sides)
                .filter(|(_, side)| on_axis(side))
                .for_each(|(held, _)| *held = Support::Free);
        }
        let material = material(file)?;
        let skin = [file.shape.tension_n_per_m, file.shape.density_kg_per_m2].map(|given| given.unwrap_or(1.0));
        let units = match kind {
            Kind::Membrane => Units::of_skin(longest, skin),
            _ => Units::of_body(longest, along_grain(&material), material.density),
        };
        let mut body = Self {
            kind,
            units,
            outline: units.outline(outline),
            supports,
            material: relative(material),
            plane: match file.shape.plane {
                Plane::Stress => PlaneState::Stress,
                Plane::Strain => PlaneState::Strain,
            },
            thickness: rounded(thickness_m / longest),
            split: file.shape.split.unwrap_or(0.0),
            has_rows: false,
            across: Across::default(),
        };
        body.has_rows = body.wants_rows(error);
        Ok(body)
    }

    /// Mass, kg.
    pub(super) fn mass_kg(&self, discrete: &Discrete) -> f64 {
        let area = self.outline.area();
        self.units.mass_kg
            * match self.kind {
                Kind::Membrane => area,
                Kind::Plate | Kind::Sheet => area * self.thickness,
                Kind::Revolve | Kind::Solid => {
                    let rings = pieces(discrete, &[]).into_iter().map(|(at, area, _)| TAU * at[0] * area);
                    rings.sum::<f64>() / self.units.length_m.powi(3)
                }
            }
    }

    /// The sheet with a number of terms across its width.
    pub(crate) fn with_terms(mut self, terms: usize) -> Self {
        self.across.terms = terms;
        self
    }

    /// True for a body of revolution.
    pub(super) fn is_round(&self) -> bool {
        self.kind == Kind::Revolve
    }

    /// Mesh with edges of at most a length, in the body's units.
    pub(crate) fn mesh(&self, size: f64) -> Result<Mesh, SolveError> {
        // The twist of a thick plate falls off within a thickness of a free edge, the strain across
        // a sheet within its width of a clamped one.
        let is_layered = |&support: &Support| match self.kind {
            Kind::Plate => self.has_rows && support == Support::Free,
            _ => self.across.is_wide && support == Support::Clamped,
        };
        let layered = self.supports.iter().map(is_layered);
        let has_layer = matches!(self.kind, Kind::Plate | Kind::Sheet) && self.thickness < size;
        let layer_m = has_layer.then_some(self.thickness);
        let sizing = Sizing { size_m: size, layer_m, layered: layered.collect(), corners_m: self.at_corners(size) };
        Mesh::over(&self.outline, &sizing).map_err(|error| match error {
            // The size follows from the modes that are wanted.
            MeshError::TooFine { triangles, most, .. } => SolveError::TooFine { triangles, most },
            MeshError::Curve { at } => MeshError::Curve { at: at.map(|part| part * self.units.length_m) }.into(),
            other => other.into(),
        })
    }

    /// Matrices of the motion with a number of waves round the axis, of all motion of flat bodies,
    /// in the body's units.
    pub(crate) fn elements(&self, mesh: &Mesh, waves: u32) -> Result<Discrete, SolveError> {
        let (material, thickness) = (self.material, self.thickness);
        Ok(match self.kind {
            Kind::Plate => Plate { material, thickness }.discretise(mesh, ORDER, &self.supports)?,
            Kind::Sheet => self.sheet(mesh, ORDER)?,
            Kind::Membrane => Membrane { tension: 1.0, density: 1.0 }.discretise(mesh, ORDER, &self.supports)?,
            Kind::Revolve | Kind::Solid => Revolve { material, waves }.discretise(mesh, ORDER, &self.supports)?,
        })
    }

    /// Matrices of a sheet by elements of an order, in the body's units.
    pub(crate) fn sheet(&self, mesh: &Mesh, order: usize) -> Result<Discrete, SolveError> {
        let (material, thickness, supports) = (self.material, self.thickness, &self.supports);
        let Across { terms, around, .. } = self.across;
        Ok(match self.plane {
            PlaneState::Stress => {
                Wide { material, width: thickness, terms, around }.discretise(mesh, order, supports)?
            }
            state @ PlaneState::Strain => Sheet { material, thickness, state }.discretise(mesh, order, supports)?,
        })
    }
}

/// Checks that a body is neither too long nor too short.
pub(super) fn check_size(longest_m: f64) -> Result<(), SolveError> {
    if (EXTENT_M[0]..=EXTENT_M[1]).contains(&longest_m) {
        return Ok(());
    }
    let unit = if longest_m > EXTENT_M[1] { "millimetres, as 0.001 m," } else { "a factor of 1000 more" };
    Err(SolveError::Size { size_m: longest_m, unit })
}

/// Young's modulus of a material, that along the grain of wood, Pa.
fn along_grain(material: &Material) -> f64 {
    match material.elasticity {
        Elasticity::Isotropic { young, .. } => young,
        Elasticity::Orthotropic { young, .. } => young[0],
    }
}

/// Young's modulus, Pa, Poisson's ratio and density, kg/m³, of a material that is alike in all
/// directions.
pub(super) fn isotropic(file: &ShapeFile) -> Result<(f64, f64, f64), SolveError> {
    let found = material(file)?;
    match found.elasticity {
        Elasticity::Isotropic { young, poisson } => Ok((young, poisson, found.density)),
        Elasticity::Orthotropic { .. } => Err(SolveError::Grain),
    }
}

/// Width of an outline: its smaller extent, or what its area leaves beside its length.
pub(super) fn width(outline: &Outline, extents: [f64; 2]) -> f64 {
    let (longer, shorter) = (extents[0].max(extents[1]), extents[0].min(extents[1]));
    // A slanted bar is as wide as its area tells.
    let diagonal = longer.hypot(shorter);
    shorter.min(longer).min(2.0 * outline.area() / diagonal * 2.0)
}

/// Material of a file; that of a membrane is not used.
fn material(file: &ShapeFile) -> Result<Material, SolveError> {
    let given = &file.material;
    let named = given.named()?;
    let density = given.density_kg_per_m3.or(named.map(|named| named.density_kg_per_m3)).unwrap_or(1.0);
    let poisson = given.poisson.or(named.map(|named| named.poisson)).unwrap_or(0.0);
    let modulus = given.youngs_modulus_pa.clone().or(named.map(|named| named.youngs_modulus_pa.clone()));
    let elasticity = match modulus.unwrap_or(Modulus::All(1.0)) {
        Modulus::All(young) => Elasticity::Isotropic { young, poisson },
        Modulus::Grain(young) => {
            let shear = given.shear_modulus_pa.or(named.and_then(|named| named.shear_modulus_pa));
            let shear = shear.unwrap_or(young[1] / (2.0 * (1.0 + poisson)));
            let grain = given.grain_deg.to_radians();
            // Shear moduli over the thickness are not in the file: they are those of the plane.
            Elasticity::Orthotropic { young, poisson, shear, transverse: [shear; 2], grain }
        }
    };
    Ok(Material { elasticity, density })
}
