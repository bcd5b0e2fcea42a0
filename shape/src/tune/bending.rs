//! Bending modes of a bar seen from its side.

use std::f64::consts::TAU;

use super::TuneError;
use crate::eigen;
use crate::element::Discrete;
use crate::file::ShapeFile;
use crate::mesh::Mesh;
use crate::outline::Outline;
use crate::solve::{Body, SolveError};

/// Modes that are looked at beside the bending ones: longitudinal ones lie among them.
const BESIDE: usize = 4;
/// Modes that are looked at beside these in a wide bar, which bends across its width, too.
const BESIDE_WIDE: usize = 6;
/// Longest edge of a triangle, as a share of the bar's height.
const EDGE: f64 = 0.75;
/// Order of the elements.
const ORDER: usize = 4;
/// Order of the elements by which the terms for a wide bar are chosen.
const FIRST_ORDER: usize = 3;
/// Largest number of terms of the expansion across the width.
const MOST_TERMS: usize = 6;
/// Change of the frequencies by the last term at which the terms are enough, as a share of them.
const TOLERANCE: f64 = 5e-5;

/// Frequencies of the lowest bending modes of a bar along x in plane stress, Hz. A mode bends if
/// its motion is across the length more than along it.
pub(super) fn frequencies_hz(file: &ShapeFile, count: usize) -> Result<Vec<f64>, TuneError> {
    let (body, mesh) = bar(file)?;
    let modes = modes(&body.sheet(&mesh, ORDER)?, body.units.rad_per_s, count + BESIDE)?;
    Ok(bending(&modes, count)?.iter().map(|mode| mode.hz).collect())
}

/// Change of the frequencies of bending modes by the width of the bar, which plane stress leaves
/// out.
#[derive(Clone, Debug)]
pub(super) struct Width {
    /// Factor of each frequency.
    pub(super) factors: Vec<f64>,
    /// Number of terms of the expansion across the width.
    terms: usize,
}

impl Width {
    /// The change of a first bar, with as many terms as it needs.
    pub(super) fn first(file: &ShapeFile, count: usize) -> Result<Self, TuneError> {
        let mut width = Self { factors: vec![1.0; count], terms: 0 };
        for terms in 1..=MOST_TERMS {
            let next = Self::by(file, count, terms, FIRST_ORDER)?;
            let changes = width.factors.iter().zip(&next.factors).map(|(a, b)| (a / b - 1.0).abs());
            let change = changes.fold(0.0, f64::max);
            width = next;
            // Changes fall from term to term: the last one is beyond what is left.
            if change <= TOLERANCE {
                break;
            }
        }
        Ok(width)
    }

    /// The change of another bar, with as many terms.
    pub(super) fn of(&self, file: &ShapeFile, count: usize) -> Result<Self, TuneError> {
        Self::by(file, count, self.terms, ORDER)
    }

    fn by(file: &ShapeFile, count: usize, terms: usize, order: usize) -> Result<Self, TuneError> {
        let (body, mesh) = bar(file)?;
        let unit = body.units.rad_per_s;
        let all = modes(&body.sheet(&mesh, order)?, unit, count + BESIDE)?;
        let discrete = body.with_terms(terms).sheet(&mesh, order)?;
        let wide = modes(&discrete, unit, count + BESIDE + BESIDE_WIDE)?;
        let factor = |mode: &Mode| mode.nearest(&wide).map(|wide| wide.hz / mode.hz);
        let factors: Option<Vec<f64>> = bending(&all, count)?.into_iter().map(factor).collect();
        Ok(Self { factors: factors.ok_or(TuneError::NoBending { count })?, terms })
    }
}

/// Body and mesh of a bar.
fn bar(file: &ShapeFile) -> Result<(Body, Mesh), TuneError> {
    let polygon = file.shape.polygon_m.as_deref().unwrap_or(&[]);
    let outline = Outline::polygon(polygon, &[]).map_err(SolveError::Outline)?;
    let [low, high] = outline.bounds().unwrap_or_default();
    let body = Body::of(file, &outline, 0.0)?;
    let mesh = body.mesh(EDGE * (high[1] - low[1]) / body.units.length_m)?;
    Ok((body, mesh))
}

/// Mode of a bar.
struct Mode {
    hz: f64,
    /// Motion of each node of the middle plane.
    shape: Vec<[f64; 2]>,
}

impl Mode {
    fn of(discrete: &Discrete, hz: f64, vector: &[f64]) -> Self {
        let node = |node: usize| {
            let [x, y, _] = discrete.at_node(vector, node);
            [x, y]
        };
        Self { hz, shape: (0..discrete.nodes.positions.len()).map(node).collect() }
    }

    fn bends(&self) -> bool {
        let [along, across] =
            self.shape.iter().fold([0.0; 2], |sum, at| [sum[0] + at[0] * at[0], sum[1] + at[1] * at[1]]);
        across > along
    }

    /// Cosine of the angle between the motions in two modes.
    fn likeness(&self, other: &Self) -> f64 {
        let product =
            |a: &Self, b: &Self| a.shape.iter().zip(&b.shape).map(|(a, b)| a[0] * b[0] + a[1] * b[1]).sum::<f64>();
        product(self, other).abs() / (product(self, self) * product(other, other)).sqrt()
    }

    /// The mode whose motion is most like this one's.
    fn nearest<'a>(&self, modes: &'a [Self]) -> Option<&'a Self> {
        modes.iter().max_by(|a, b| self.likeness(a).total_cmp(&self.likeness(b)))
    }
}

/// Lowest elastic modes of a bar.
fn modes(discrete: &Discrete, unit_rad_per_s: f64, count: usize) -> Result<Vec<Mode>, TuneError> {
    let wanted = eigen::Wanted::Lowest(discrete.rigid + count);
    let found = eigen::modes(&discrete.problem, wanted, None).map_err(SolveError::Eigen)?;
    let elastic = found.values.iter().zip(&found.vectors).skip(discrete.rigid);
    let hz = |value: f64| unit_rad_per_s * value.max(0.0).sqrt() / TAU;
    Ok(elastic.map(|(value, vector)| Mode::of(discrete, hz(*value), vector)).collect())
}

/// The lowest ones of some modes that bend a bar.
fn bending(modes: &[Mode], count: usize) -> Result<Vec<&Mode>, TuneError> {
    let bending: Vec<&Mode> = modes.iter().filter(|mode| mode.bends()).take(count).collect();
    if bending.len() < count { Err(TuneError::NoBending { count }) } else { Ok(bending) }
}
