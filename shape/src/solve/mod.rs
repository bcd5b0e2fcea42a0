//! From a shape file to modes: the mesh becomes finer until the frequencies stand.

mod across;
mod body;
mod corners;
mod edges;
mod error;
mod figure;
mod levels;
mod model;
mod parts;
mod places;
mod solid;
mod solid_figure;
mod solid_places;
mod theory;
mod units;

use std::f64::consts::TAU;

use crate::damping::Damping;
use crate::eigen::EigenError;
use crate::file::ShapeFile;
use crate::gain::Gain;

pub use body::Body;
pub use error::SolveError;
pub use figure::{Figure, MOST_MODES as MOST_FIGURES, Motion, Tried};
use levels::{Levels, MOST_MESHES, Searched};
pub use model::Geometry;
use model::Model;
use parts::{Part, Place};
pub use places::Places;
use places::Round;

/// Modes to find.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Wanted {
    /// A number of modes, the lowest.
    Lowest(usize),
    /// All modes up to a frequency in Hz.
    Below(f64),
}

/// Mode of a body.
#[derive(Clone, Debug, PartialEq)]
pub struct Mode {
    /// Frequency, Hz.
    pub frequency_hz: f64,
    /// Estimated error of the frequency, as a share of it.
    pub error: f64,
    /// Decay, 1/s: amplitude e^(-d t).
    pub decay_per_s: f64,
    /// Gains by position of the strike.
    pub gains: Vec<Gain>,
}

/// Modes of a body, and the mesh on which they stand.
#[derive(Clone, Debug)]
pub struct Solved {
    /// Modes from the lowest to the highest, those of rigid motion left out.
    pub modes: Vec<Mode>,
    /// Number of rigid motions.
    pub rigid: usize,
    /// Number of modes, rigid ones too, up to `counted_to_hz` by the inertia of K - ω² M.
    pub counted: usize,
    /// Frequency in Hz up to which the modes were counted.
    pub counted_to_hz: f64,
    /// True if the number of modes that was asked for leaves out the next one though its frequency
    /// is that of the last one: half a pair is left.
    pub cut_pair: bool,
    /// Number of unknowns of the finest mesh.
    pub unknowns: usize,
    /// Number of triangles of the finest mesh, or of cells of a solid.
    pub elements: usize,
    /// Mass of the body, kg.
    pub mass_kg: f64,
    /// Meshes that were tried, the coarsest first; the modes stand on the last one.
    pub meshes: Vec<Tried>,
    /// Picture of the body and its lowest modes; `None` if the kind of body has none.
    pub figure: Option<Figure>,
}

/// Largest number of unknowns, before the size of their factors is known.
pub const MOST_UNKNOWNS: usize = 400_000;
/// Least share of the error that is asked for that the mesh may have.
const MESH_SHARE: f64 = 0.3;
/// Error that is added to each estimate: that of curves as cubics, of rounding in thin plates, of
/// corners within their smallest elements.
const LEAST_ERROR: f64 = 2e-5;
/// Half the sample rate of boards: modes above it are not heard.
pub const HIGHEST_HZ: f64 = 24_000.0;

/// Finds the modes of a shape. `geometry` is the outline or the surface that the file gives or
/// names; `measured` are frequency and decay of the modes of the table that the material's
/// `damping` names. `tell` gets the steps that are done, of 100.
///
/// # Errors
/// A [`SolveError`] that says what to change.
pub fn solve<'a>(
    file: &ShapeFile,
    geometry: impl Into<Geometry<'a>>,
    measured: Vec<[f64; 2]>,
    wanted: Wanted,
    error: f64,
    tell: &mut dyn FnMut(usize),
) -> Result<Solved, SolveError> {
    if !(error > 0.0 && error < 0.5) {
        return Err(SolveError::Error(error));
    }
    let model = Model::of(file, geometry.into(), wanted, error)?;
    let damping = Damping::of(&file.material, measured);
    let mut levels = Levels::new(&model, wanted);
    let mut before: Option<(Vec<f64>, Vec<f64>)> = None;
    let mut meshes = Vec::new();
    tell(0);
    let mut pair = levels.first_two()?.into_iter();
    while let Some(searched) = pair.next().map_or_else(|| levels.search_next(), |searched| Ok(Some(searched)))? {
        tell(100 * levels.made / MOST_MESHES);
        let Searched { mesh, elements, unknowns, parts } = searched;
        let parts = match parts {
            // The error of the mesh before is more use than the size of this one.
            Err(SolveError::Eigen(EigenError::TooLarge { .. })) if before.is_some() => break,
            parts => parts?,
        };
        let mut places = parts::sorted(&parts);
        let next = if let Wanted::Lowest(count) = wanted {
            let next = places.get(count).copied();
            places.truncate(count);
            next
        } else {
            None
        };
        let elastic: Vec<f64> = places.iter().map(|place| place.value.max(0.0).sqrt() / TAU).collect();
        let Some(last) = places.last() else { return Err(SolveError::NoModes) };
        if let Some(&lowest_hz) = elastic.first().filter(|&&lowest| lowest >= HIGHEST_HZ) {
            return Err(SolveError::Inaudible { lowest_hz, highest_hz: HIGHEST_HZ });
        }
        meshes.push(Tried { unknowns, elements, frequencies_hz: elastic.clone() });
        let finer = meshes.iter().rev().nth(1).map_or(1.0, |coarse| (coarse.unknowns as f64 / unknowns as f64).sqrt());
        let left = left(finer, model.falls());
        let estimates = estimates(&model, &elastic, before.as_ref().map(|before| before.0.as_slice()), left);
        // The theory's own error cannot be mended by a finer mesh: that has the rest, or a share.
        let is_fine = |(estimate, &frequency): (&f64, &f64)| {
            let theory = model.model_error(frequency);
            estimate - theory <= (error - theory).max(MESH_SHARE * error)
        };
        if estimates.iter().zip(&elastic).all(is_fine) {
            tell(95);
            let (counted, limit) = parts::count(&model, &parts, last.value)?;
            let is_cut = matches!(wanted, Wanted::Lowest(_)) && parts::is_pair(&parts, last, next);
            let mass_kg = parts.first().map_or(0.0, |part| model.mass_kg(&part.matrices));
            let mode = |(place, &error)| Ok((model.mode(&parts, place, &damping, error)?, *place));
            let mut modes = places.iter().zip(&estimates).map(mode).collect::<Result<Vec<_>, SolveError>>()?;
            modes.sort_by(|a, b| a.0.frequency_hz.total_cmp(&b.0.frequency_hz));
            let (modes, places): (Vec<Mode>, Vec<Place>) = modes.into_iter().unzip();
            let figure = model.figure(mesh.as_ref(), &parts, &places)?;
            tell(100);
            return Ok(Solved {
                modes,
                rigid: parts::rigid(&parts),
                counted,
                counted_to_hz: limit.max(0.0).sqrt() / TAU,
                cut_pair: is_cut,
                unknowns,
                elements,
                mass_kg,
                meshes,
                figure,
            });
        }
        before = Some((elastic, estimates));
    }
    let worst = before.map_or(1.0, |(_, estimates)| estimates.iter().copied().fold(0.0, f64::max));
    Err(SolveError::NotConverged { error, reached: worst })
}

/// Error of a mesh whose edges are `finer` times those of the mesh before, as a share of what it
/// changes, if errors fall as a power of the edges: at most all of it, which holds even where they
/// fall as slowly as at the sharpest corner of a membrane.
fn left(finer: f64, falls: Option<i32>) -> f64 {
    let Some(power) = falls else { return 1.0 };
    let ratio = finer.powi(power);
    if ratio < 0.5 { ratio / (1.0 - ratio) } else { 1.0 }
}

/// Estimates the error of each frequency from the mesh before, and of the model.
///
/// The error of a mesh is `left` times what its frequencies differ from those of the mesh before. A
/// single difference may be small by chance, hence each mode has the largest one of all modes up to
/// the next above it.
fn estimates(model: &Model, frequencies_hz: &[f64], before: Option<&[f64]>, left: f64) -> Vec<f64> {
    let change = |(index, &frequency): (usize, &f64)| {
        before.and_then(|before| before.get(index)).map_or(1.0, |&other| left * (frequency - other).abs() / frequency)
    };
    let changes: Vec<f64> = frequencies_hz.iter().enumerate().map(change).collect();
    let mut largest = 0.0_f64;
    let of = |(index, &frequency): (usize, &f64)| {
        let near = changes.iter().skip(index).take(2).copied().fold(0.0, f64::max);
        largest = largest.max(near);
        largest + LEAST_ERROR + model.model_error(frequency)
    };
    frequencies_hz.iter().enumerate().map(of).collect()
}

impl Model {
    /// Mode with its decay and gains.
    fn mode(&self, parts: &[Part], place: &Place, damping: &Damping, error: f64) -> Result<Mode, SolveError> {
        let part = parts.get(place.part).ok_or(SolveError::NoModes)?;
        let vector = part.found.vectors.get(place.index).ok_or(SolveError::NoModes)?;
        // An imperfect body has the modes of a pair at two frequencies.
        let apart = if part.waves == 0 { 0.0 } else { self.split() / 2.0 };
        let omega = place.value.max(0.0).sqrt() * if place.is_second { 1.0 + apart } else { 1.0 - apart };
        let decay_per_s = damping.decay_per_s(omega / TAU);
        if decay_per_s >= omega {
            return Err(SolveError::Overdamped { frequency_hz: omega / TAU, decay_per_s });
        }
        // The body's frequency is the undamped one; a table has the damped one.
        let damped = (omega * omega - decay_per_s * decay_per_s).sqrt();
        let round = Round { waves: part.waves, is_second: place.is_second, is_split: self.split() > 0.0 };
        let gains = self.gains(&part.matrices, vector, round, damped, decay_per_s)?;
        Ok(Mode { frequency_hz: damped / TAU, error, decay_per_s, gains })
    }
}
