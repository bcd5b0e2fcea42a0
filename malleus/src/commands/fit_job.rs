//! One recording that is to be fitted, and the files that its results go to.

use std::path::{Path, PathBuf};

use ::fit::FitError;

/// One recording that is to be fitted, and the files that its results go to.
pub(super) struct Job {
    /// Path of the recording, as the user gave it.
    pub(super) input: PathBuf,
    /// Name of the results, which no other recording of the run has.
    pub(super) name: String,
    /// Path of the table.
    pub(super) table: PathBuf,
    /// Path of the page, if a report is asked for.
    pub(super) page: Option<PathBuf>,
}

/// Message of an error that begins with the path of the recording.
///
/// Errors on the file itself name it already.
pub(super) fn with_file(input: &Path, error: FitError) -> String {
    match error {
        FitError::Read { .. }
        | FitError::NotAudio { .. }
        | FitError::Empty { .. }
        | FitError::Channel { .. }
        | FitError::NoMicrophone { .. }
        | FitError::Rate { .. }
        | FitError::Constant { .. }
        | FitError::NotFinite { .. } => error.to_string(),
        other => format!("{}: {other}", input.display()),
    }
}
