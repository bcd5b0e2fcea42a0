//! Parts of a body's motion that have matrices of their own: all motion of a flat body, or that
//! with a number of waves round the axis of a body of revolution.

use std::f64::consts::TAU;

use super::model::Model;
use super::{SolveError, Wanted};
use crate::eigen::{self, EigenError, Modes, Problem};
use crate::element::Discrete;
use crate::mesh::Mesh;
use crate::solid::{Cells, RIGID};

/// Largest number of waves round an axis that is looked at.
const MOST_WAVES: u32 = 200;
/// Number of waves from which on higher ones have higher lowest modes, as a rule.
const FEW_WAVES: u32 = 3;
/// Distance of the limit of a count above the last mode, as a share of ω².
const ABOVE: f64 = 1e-5;

/// Distance of two modes that count as a pair, as a share of ω²: pairs of symmetric bodies on
/// meshes that are not symmetric are so far apart.
const PAIR: f64 = 2e-3;

/// Matrices of a part of the motion, in the body's units, and where its unknowns are.
pub(super) enum Matrices {
    Flat(Box<Discrete>),
    Solid(Box<Cells>),
}

impl Matrices {
    pub(super) fn problem(&self) -> &Problem {
        match self {
            Self::Flat(discrete) => &discrete.problem,
            Self::Solid(cells) => &cells.problem,
        }
    }

    /// Number of motions that store no energy.
    fn rigid(&self) -> usize {
        match self {
            Self::Flat(discrete) => discrete.rigid,
            Self::Solid(_) => RIGID,
        }
    }
}

/// Part of the motion, and its modes.
pub(super) struct Part {
    pub(super) matrices: Matrices,
    pub(super) found: Modes,
    /// Number of waves round the axis; 0 for flat bodies, too.
    pub(super) waves: u32,
}

/// Mode among those of all parts.
#[derive(Clone, Copy, Debug)]
pub(super) struct Place {
    /// ω², (rad/s)².
    pub(super) value: f64,
    /// Part, and the mode's number in it.
    pub(super) part: usize,
    pub(super) index: usize,
    /// Second of a pair: its waves lie a quarter of a wave further round the axis.
    pub(super) is_second: bool,
}

impl Part {
    /// Number of modes of one frequency for each mode of the matrices.
    fn multiplicity(&self) -> usize {
        1 + usize::from(self.waves > 0)
    }

    fn places(&self, part: usize) -> impl Iterator<Item = Place> {
        let elastic = self.found.values.iter().enumerate().skip(self.matrices.rigid());
        let both = [false, true].into_iter().take(self.multiplicity());
        elastic
            .flat_map(move |(index, &value)| both.clone().map(move |is_second| Place { value, part, index, is_second }))
    }
}

/// Finds the parts whose modes are wanted; `first` has no waves round the axis.
pub(super) fn find(
    model: &Model,
    mesh: Option<&Mesh>,
    first: Matrices,
    wanted: Wanted,
) -> Result<Vec<Part>, SolveError> {
    let mut parts: Vec<Part> = Vec::new();
    let square = model.units().square();
    let (mut next, mut waves, mut above) = (Some(first), 0, 0);
    while let Some(mut matrices) = next {
        let limit = match wanted {
            Wanted::Below(frequency_hz) => Some((TAU * frequency_hz).powi(2)),
            Wanted::Lowest(count) => sorted(&parts).get(count.saturating_sub(1)).map(|place| place.value),
        };
        let asked = match (limit, wanted) {
            (Some(limit), _) => eigen::Wanted::Below(limit / square),
            (None, Wanted::Lowest(count)) => eigen::Wanted::Lowest(count + matrices.rigid()),
            (None, Wanted::Below(_)) => break,
        };
        let mut found = eigen::modes(matrices.problem(), asked, model.lowest())?;
        model.measure(&mut matrices, &mut found);
        // No mode lies below the limit: two such numbers of waves end the search.
        above = if found.values.len() <= matrices.rigid() { above + 1 } else { 0 };
        parts.push(Part { matrices, found, waves });
        waves += 1;
        let is_done = waves > FEW_WAVES && above >= 2 || waves > MOST_WAVES;
        next = if is_done { None } else { model.round(mesh, waves)? };
    }
    Ok(parts)
}

/// Elastic modes of all parts, the lowest first.
pub(super) fn sorted(parts: &[Part]) -> Vec<Place> {
    let mut places: Vec<Place> = parts.iter().enumerate().flat_map(|(number, part)| part.places(number)).collect();
    places.sort_by(|a, b| a.value.total_cmp(&b.value));
    places
}

/// Number of rigid motions of all parts.
pub(super) fn rigid(parts: &[Part]) -> usize {
    parts.iter().map(|part| part.matrices.rigid() * part.multiplicity()).sum()
}

/// Counts the modes of all parts up to a limit just above the last one of those that are wanted, by
/// inertia; gives the count and the limit in (rad/s)².
pub(super) fn count(model: &Model, parts: &[Part], last: f64) -> Result<(usize, f64), EigenError> {
    if let [part] = parts {
        return Ok((part.found.counted, part.found.count_limit));
    }
    let limit = last * (1.0 + ABOVE);
    let below = limit / model.units().square();
    let counts = parts.iter().map(|part| Ok(eigen::count_below(part.matrices.problem(), below)? * part.multiplicity()));
    Ok((counts.sum::<Result<usize, EigenError>>()?, limit))
}

/// Tells whether a mode follows the last one that is wanted within [`PAIR`]: `next`, or, where
/// there is one part alone, the one that its search saw beyond those that were asked for.
pub(super) fn is_pair(parts: &[Part], last: &Place, next: Option<Place>) -> bool {
    let seen = if let [part] = parts { part.found.next } else { None };
    next.map(|next| next.value).or(seen).is_some_and(|value| value <= last.value * (1.0 + PAIR))
}
