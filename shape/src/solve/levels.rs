//! Discretisations of a body from coarse to fine, and the modes that are found on each.

use std::panic::resume_unwind;
use std::thread;

use super::model::{Level, Model};
use super::parts::{self, Part};
use super::units::rounded;
use super::{MOST_UNKNOWNS, SolveError, Wanted};
use crate::mesh::Mesh;

/// Largest number of meshes, each finer than the one before.
pub(super) const MOST_MESHES: usize = 10;
/// Ratio of a mesh's edges to those of the mesh before, from the third one on.
const FINER: f64 = 0.7;
/// Least growth of the number of unknowns from a mesh to the next one.
const LEAST_GROWTH: f64 = 1.3;
/// Least number of unknowns of a mesh for each mode that is wanted.
const LEAST_UNKNOWNS: usize = 6;

/// Discretisations that are fine enough for what is wanted, each finer than the one before.
pub(super) struct Levels<'a> {
    model: &'a Model,
    wanted: Wanted,
    /// Size of the mesh to make next, and of the one after it.
    sizes: [f64; 2],
    unknowns: usize,
    /// Number of meshes that were made, without those that were passed over.
    pub(super) made: usize,
}

/// Discretisation, and the modes on it.
pub(super) struct Searched {
    pub(super) mesh: Option<Mesh>,
    pub(super) elements: usize,
    pub(super) unknowns: usize,
    pub(super) parts: Result<Vec<Part>, SolveError>,
}

impl<'a> Levels<'a> {
    pub(super) fn new(model: &'a Model, wanted: Wanted) -> Self {
        Self { model, wanted, sizes: model.first_sizes(wanted).map(rounded), unknowns: 0, made: 0 }
    }

    /// Searches the first two discretisations at once, as one alone has no estimate of its error.
    pub(super) fn first_two(&mut self) -> Result<Vec<Searched>, SolveError> {
        let (model, wanted) = (self.model, self.wanted);
        let levels = self.take(2).collect::<Result<Vec<Level>, SolveError>>()?;
        Ok(thread::scope(|scope| {
            let start = |level| scope.spawn(move || search(model, wanted, level));
            let threads: Vec<_> = levels.into_iter().map(start).collect();
            threads.into_iter().map(|thread| thread.join().unwrap_or_else(|panic| resume_unwind(panic))).collect()
        }))
    }

    /// Searches the next discretisation; `None` if there are no more.
    pub(super) fn search_next(&mut self) -> Result<Option<Searched>, SolveError> {
        let level = self.next().transpose()?;
        Ok(level.map(|level| search(self.model, self.wanted, level)))
    }
}

impl Iterator for Levels<'_> {
    type Item = Result<Level, SolveError>;

    fn next(&mut self) -> Option<Self::Item> {
        // Meshes that are passed over do not count: the short sides of an outline may have one mesh
        // for many sizes.
        while self.made < MOST_MESHES {
            let level = match self.model.level(self.sizes[0]) {
                Ok(level) => level,
                error => return Some(error),
            };
            self.sizes = [self.sizes[1], FINER * self.sizes[1]];
            let unknowns = level.first.problem().size;
            if unknowns > MOST_UNKNOWNS {
                return Some(Err(SolveError::TooLarge { unknowns }));
            }
            // A curved outline may have one mesh for both sizes, and a coarse one too few unknowns.
            let is_coarse = matches!(self.wanted, Wanted::Lowest(count) if unknowns < LEAST_UNKNOWNS * count);
            if !is_coarse && unknowns as f64 >= LEAST_GROWTH * self.unknowns as f64 {
                self.unknowns = unknowns;
                self.made += 1;
                return Some(Ok(level));
            }
        }
        None
    }
}

fn search(model: &Model, wanted: Wanted, level: Level) -> Searched {
    let Level { mesh, first, elements } = level;
    let unknowns = first.problem().size;
    let parts = parts::find(model, mesh.as_ref(), first, wanted);
    Searched { mesh, elements, unknowns, parts }
}
