//! Reasons for which a page cannot be made.

use std::path::PathBuf;

use kit::file::FileError;

use crate::plot::PlotError;

/// Reason for which a page was not made. No new file is left behind, and an older page is
/// unchanged.
#[derive(Debug, thiserror::Error)]
pub enum ReportError {
    /// A picture in the page cannot be made.
    #[error(transparent)]
    Plot(#[from] PlotError),
    /// A sound in the page cannot be encoded.
    #[error("{}: the sound is too long for a page; fit a shorter recording", path.display())]
    Sound {
        /// Path of the page.
        path: PathBuf,
        /// Error of the WAV encoder, kept for programs; the message leaves it out.
        #[source]
        cause: hound::Error,
    },
    /// The figures of the page cannot be written as JSON.
    #[error("{}: the figures cannot be written as JSON; leave --report out, and tell the developers", path.display())]
    Figures {
        /// Path of the page.
        path: PathBuf,
        /// Error of the JSON encoder, kept for programs; the message leaves it out.
        #[source]
        cause: serde_json::Error,
    },
    /// A page, the index or their folder cannot be read or written.
    #[error(transparent)]
    File(#[from] FileError),
}
