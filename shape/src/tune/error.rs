//! Errors of the search for an undercut.

use crate::file::FileError;
use crate::mesh::MeshError;
use crate::solve::SolveError;

/// Fault of a bar, or a wish that no undercut fulfils.
#[derive(Debug, thiserror::Error)]
pub enum TuneError {
    /// Fault in the file.
    #[error(transparent)]
    File(#[from] FileError),
    /// Fault of the shape.
    #[error(transparent)]
    Solve(#[from] SolveError),
    /// Shape that has no undercut.
    #[error("an undercut is cut into a plain bar; {0}")]
    NoBar(&'static str),
    /// Ratios that are no tuning.
    #[error(
        "the ratios of an undercut are two or three rising numbers, 1 first, {most} at most: such as 1:4:10 or 1:3"
    )]
    Ratios {
        /// Highest ratio.
        most: f64,
    },
    /// Fundamental out of range.
    #[error("a fundamental of {0} Hz is asked for; it must be from 10 to 20000 Hz")]
    Fundamental(f64),
    /// Bar whose bending modes were not found.
    #[error(
        "the {count} lowest bending modes of the bar were not found: it is too thick; give a longer or flatter bar"
    )]
    NoBending {
        /// Number of modes.
        count: usize,
    },
    /// Ratios that no arch of this bar gives.
    #[error(
        "no arch was found that gives this bar {}: the nearest gives {} and leaves {:.0} % of its height; give a longer or flatter bar for higher ratios; lower ones than a plain bar's cannot be had",
        shown(asked), shown(reached), 100.0 * thinnest
    )]
    OutOfReach {
        /// Ratios that were asked for.
        asked: Vec<f64>,
        /// Ratios that were reached.
        reached: Vec<f64>,
        /// Least thickness, as a share of the height.
        thinnest: f64,
    },
}

impl From<MeshError> for TuneError {
    fn from(error: MeshError) -> Self {
        Self::Solve(error.into())
    }
}

/// Ratios with colons.
fn shown(ratios: &[f64]) -> String {
    let digits = |ratio: &f64| format!("{ratio:.3}").trim_end_matches('0').trim_end_matches('.').to_owned();
    ratios.iter().map(digits).collect::<Vec<_>>().join(" : ")
}
