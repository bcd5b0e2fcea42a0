//! What can keep a page from being made.

use std::path::PathBuf;

use kit::file::FileError;

use crate::plot::PlotError;

/// Why a page was not made. No file is left behind, an older page stays as it was.
#[derive(Debug, thiserror::Error)]
pub enum ReportError {
    /// A picture in it cannot be made.
    #[error(transparent)]
    Plot(#[from] PlotError),
    /// A sound in it cannot be encoded.
    #[error("{}: the sound cannot be encoded: {cause}", path.display())]
    Sound {
        /// The page.
        path: PathBuf,
        /// What the encoder says.
        cause: hound::Error,
    },
    /// Its figures cannot be written as JSON.
    #[error("{}: the figures cannot be written as JSON: {cause}", path.display())]
    Figures {
        /// The page.
        path: PathBuf,
        /// Why.
        cause: serde_json::Error,
    },
    /// A file or the folder cannot be read or written.
    #[error(transparent)]
    File(#[from] FileError),
}
