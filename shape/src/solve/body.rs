//! Body: outline, material and support as the elements take them.

use std::f64::consts::{PI, TAU};

use super::across::Across;
use super::places::pieces;
use super::{SolveError, Wanted};
use crate::element::{Discrete, Elasticity, Material, Membrane, PlaneState, Plate, Revolve, Sheet, Support, Wide};
use crate::file::{Edge, Kind, Modulus, Plane, ShapeFile};
use crate::mesh::{Mesh, MeshError, Sizing};
use crate::outline::{FlatSide, Outline};

/// Extents of bodies, metres: others are units that were forgotten.
const EXTENT_M: [f64; 2] = [1e-3, 20.0];
/// Order of the elements.
const ORDER: usize = 4;
/// Model errors of a plate against elasticity in space, measured by the tests of `shape` named
/// `boxes`: waves err by a share of (k h)² with the wave number k and the thickness h, edges by a
/// share of thickness times length of the edge by area of the plate.
///
/// Waves along isotropic plates: at most 0.0019 (hinged plates), and a little for other edges.
const WAVE_ERROR: f64 = 0.0022;
/// Waves along orthotropic plates, whose mass does not take in that they become thinner: not
/// measured.
const GRAIN_ERROR: f64 = 0.004;
/// Twist at free edges: up to 0.0009 of a square, 0.001 of a bar.
const FREE_ERROR: f64 = 0.0011;
/// Lowest modes without a row of elements one thickness wide along free edges: thin-plate theory
/// is 0.3 thicknesses a side of a square above elasticity, and finite elements lie between.
const ROW_ERROR: f64 = 0.08;
/// Share of the error that is asked for below which rows along free edges are left out.
const ROW_SHARE: f64 = 0.2;
/// Angle in the body from which on elements become smaller towards a corner; stresses at it have no
/// bound. Corners of curves that are drawn as polygons are below it.
const FREE_CORNER: f64 = 195.0 / 180.0 * PI;
/// Angle of a corner of two hinged edges from which on elements become smaller.
const HINGED_CORNER: f64 = 95.0 / 180.0 * PI;
/// Elements at corners, as a share of the largest ones.
const CORNER_SHARE: f64 = 0.02;
/// Elements at corners of thin plates, as a share of the largest ones.
const HINGED_SHARE: f64 = 1e-3;
/// Clamped edges hold the surfaces, too, as if they lay 0.013 thicknesses further inside.
const CLAMPED_ERROR: f64 = 0.02;

/// Body of a shape file.
#[derive(Clone, Debug)]
pub struct Body {
    pub(super) kind: Kind,
    pub(super) outline: Outline,
    pub(super) supports: Vec<Support>,
    pub(super) material: Material,
    pub(super) plane: PlaneState,
    /// Thickness of a plate or width of a sheet, metres; 0 for a membrane.
    pub(super) thickness_m: f64,
    /// Tension, N/m, and mass per area, kg/m², of a membrane.
    pub(super) skin: [f64; 2],
    /// Distance of the frequencies of a pair, as a share of them.
    pub(super) split: f64,
    /// True if a row of elements lies along free edges of a plate.
    has_rows: bool,
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
        let mut body = Self {
            kind,
            outline: outline.clone(),
            supports,
            material: material(file)?,
            plane: match file.shape.plane {
                Plane::Stress => PlaneState::Stress,
                Plane::Strain => PlaneState::Strain,
            },
            thickness_m,
            split: file.shape.split.unwrap_or(0.0),
            skin: [file.shape.tension_n_per_m.unwrap_or(0.0), file.shape.density_kg_per_m2.unwrap_or(0.0)],
            has_rows: false,
            across: Across::default(),
        };
        body.has_rows = body.row_error() > ROW_SHARE * error;
        Ok(body)
    }

    /// Share by which frequencies err without rows along free edges.
    fn row_error(&self) -> f64 {
        let is_free = |support: &Support| if *support == Support::Free { ROW_ERROR } else { 0.0 };
        self.edge_error(is_free)
    }

    /// Error from edges: a share of thickness, of a sheet width, times length by area.
    pub(super) fn edge_error(&self, of_edge: impl Fn(&Support) -> f64) -> f64 {
        let sides = self.outline.sides();
        let length = |side: &FlatSide| (side.to[0] - side.from[0]).hypot(side.to[1] - side.from[1]);
        let edges: f64 = sides.iter().zip(&self.supports).map(|(side, edge)| length(side) * of_edge(edge)).sum();
        edges * self.thickness_m / self.outline.area()
    }

    /// Mass, kg.
    pub(super) fn mass_kg(&self, discrete: &Discrete) -> f64 {
        let area = self.outline.area();
        match self.kind {
            Kind::Membrane => area * self.skin[1],
            Kind::Plate | Kind::Sheet => area * self.material.density * self.thickness_m,
            Kind::Revolve | Kind::Solid => {
                let rings = pieces(discrete, &[]).into_iter().map(|(at, area, _)| TAU * at[0] * area);
                self.material.density * rings.sum::<f64>()
            }
        }
    }

    /// Wave number at a frequency, 1/m, of the slowest wave.
    fn wave_number(&self, omega: f64) -> f64 {
        let (youngs, shear) = softest(&self.material);
        match self.kind {
            Kind::Membrane => omega * (self.skin[1] / self.skin[0]).sqrt(),
            Kind::Plate => {
                let bending = youngs * self.thickness_m.powi(3) / 12.0;
                (omega * omega * self.material.density * self.thickness_m / bending).powf(0.25)
            }
            // The lowest modes of a slender sheet bend: their waves are about this short.
            Kind::Sheet | Kind::Revolve | Kind::Solid => omega * (self.material.density / shear).sqrt(),
        }
    }

    /// Wavelength of the highest mode that is wanted, metres; at most twice the longer extent.
    pub(super) fn wavelength_m(&self, wanted: Wanted) -> f64 {
        let [low, high] = self.outline.bounds().unwrap_or_default();
        let extents = [0, 1].map(|axis| high[axis] - low[axis]);
        let (longest, narrow) = (extents[0].max(extents[1]), width(&self.outline, extents));
        let number = match wanted {
            // As many half waves as modes in a slender body, their root in a wide one.
            Wanted::Lowest(count) => {
                let wide = (4.0 * PI * (count as f64 + 3.0) / self.outline.area()).sqrt();
                let slender = PI * (count as f64 + 1.0) / longest;
                wide.min(slender.max(PI / narrow))
            }
            Wanted::Below(frequency_hz) => self.wave_number(TAU * frequency_hz),
        };
        (TAU / number).min(2.0 * longest)
    }

    /// Share by which the theory of thick plates, or the expansion of a sheet across its width,
    /// errs at a frequency, against elasticity in space.
    pub(super) fn model_error(&self, frequency_hz: f64) -> f64 {
        if self.kind != Kind::Plate {
            return self.across.error(frequency_hz);
        }
        let of_edge = |support: &Support| match support {
            Support::Free => FREE_ERROR,
            Support::Hinged => 0.0,
            Support::Clamped => CLAMPED_ERROR,
        };
        let waves = match self.material.elasticity {
            Elasticity::Isotropic { .. } => WAVE_ERROR,
            Elasticity::Orthotropic { .. } => GRAIN_ERROR,
        };
        let turn = self.wave_number(TAU * frequency_hz) * self.thickness_m;
        let rows = if self.has_rows { 0.0 } else { self.row_error() };
        self.edge_error(of_edge) + rows + waves * turn * turn
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

    /// Mesh with edges of at most a length.
    pub(crate) fn mesh(&self, size_m: f64) -> Result<Mesh, SolveError> {
        // The twist of a thick plate falls off within a thickness of a free edge, the strain across
        // a sheet within its width of a clamped one.
        let is_layered = |&support: &Support| match self.kind {
            Kind::Plate => self.has_rows && support == Support::Free,
            _ => self.across.is_wide && support == Support::Clamped,
        };
        let layered = self.supports.iter().map(is_layered);
        let has_layer = matches!(self.kind, Kind::Plate | Kind::Sheet) && self.thickness_m < size_m;
        let layer_m = has_layer.then_some(self.thickness_m);
        let sizing = Sizing { size_m, layer_m, layered: layered.collect(), corners_m: self.corners_m(size_m) };
        Mesh::over(&self.outline, &sizing).map_err(|error| match error {
            // The size follows from the modes that are wanted.
            MeshError::TooFine { triangles, most, .. } => SolveError::TooFine { triangles, most },
            other => other.into(),
        })
    }

    /// Length of the elements at each corner where stresses have no bound, metres.
    fn corners_m(&self, size_m: f64) -> Vec<Option<f64>> {
        let sides = self.outline.sides();
        let starts = self.outline.rings.iter().scan(0, |first, ring| {
            *first += ring.len();
            Some((*first - ring.len())..*first)
        });
        let corner = |side: usize, before: usize| {
            let (into, out) = (sides[before].derivative(1.0), sides[side].derivative(0.0));
            let turn = (into[0] * out[1] - into[1] * out[0]).atan2(into[0] * out[0] + into[1] * out[1]);
            let hinged = [before, side].iter().all(|&side| self.supports[side] == Support::Hinged);
            let widest = if hinged && self.kind == Kind::Plate { HINGED_CORNER } else { FREE_CORNER };
            // Within a thickness of it a corner of a plate is one in space.
            let least_m = (HINGED_SHARE * size_m).max(0.5 * self.thickness_m);
            let length_m = if self.kind == Kind::Plate { least_m } else { CORNER_SHARE * size_m };
            (PI - turn > widest).then_some(length_m)
        };
        starts
            .flat_map(|ring| ring.clone().map(move |side| (side, if side == ring.start { ring.end } else { side } - 1)))
            .map(|(side, before)| corner(side, before))
            .collect()
    }

    /// Matrices of the motion with a number of waves round the axis, of all motion of flat bodies.
    pub(crate) fn elements(&self, mesh: &Mesh, waves: u32) -> Result<Discrete, SolveError> {
        let (material, thickness) = (self.material, self.thickness_m);
        let [tension, density] = self.skin;
        Ok(match self.kind {
            Kind::Plate => Plate { material, thickness }.discretise(mesh, ORDER, &self.supports)?,
            Kind::Sheet => self.sheet(mesh, ORDER)?,
            Kind::Membrane => Membrane { tension, density }.discretise(mesh, ORDER, &self.supports)?,
            Kind::Revolve | Kind::Solid => Revolve { material, waves }.discretise(mesh, ORDER, &self.supports)?,
        })
    }

    /// Matrices of a sheet by elements of an order.
    pub(crate) fn sheet(&self, mesh: &Mesh, order: usize) -> Result<Discrete, SolveError> {
        let (material, thickness, supports) = (self.material, self.thickness_m, &self.supports);
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

/// Young's modulus, Pa, Poisson's ratio and density, kg/m³, of a material that is alike in all
/// directions.
pub(super) fn isotropic(file: &ShapeFile) -> Result<(f64, f64, f64), SolveError> {
    let found = material(file)?;
    match found.elasticity {
        Elasticity::Isotropic { young, poisson } => Ok((young, poisson, found.density)),
        Elasticity::Orthotropic { .. } => Err(SolveError::Grain),
    }
}

/// Lowest Young's modulus and shear modulus of a material, Pa.
fn softest(material: &Material) -> (f64, f64) {
    match material.elasticity {
        Elasticity::Isotropic { young, poisson } => (young, young / (2.0 * (1.0 + poisson))),
        Elasticity::Orthotropic { young, shear, .. } => (young[0].min(young[1]), shear),
    }
}

/// Width of an outline: its smaller extent, or what its area leaves beside its length.
fn width(outline: &Outline, extents: [f64; 2]) -> f64 {
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
