//! Reasons for which a study cannot be made.

use std::path::PathBuf;

use dsp_core::table::TableError;
use kit::KitError;
use kit::file::FileError;

use crate::motion::trials::TrialError;
use crate::render::instrument::RenderError;
use crate::render::parts::PartsError;
use crate::render::scraped::ScrapedError;

/// Reason for which a study was not made.
#[derive(Debug, thiserror::Error)]
pub enum StudyError {
    /// The kit lacks a pad or a striker of the trials.
    #[error("kit {kit}: the study needs {kind} {name}, which the kit does not have; use the shipped kit scrapes")]
    Missing {
        /// Name of the kit.
        kit: String,
        /// Kind of the thing: pad or striker.
        kind: &'static str,
        /// Name of the thing.
        name: &'static str,
    },
    /// The folder holds another page under the name of the study's.
    #[error("{}: another page has this name; choose another folder with -o", .path.display())]
    OtherPage {
        /// Path of the page.
        path: PathBuf,
    },
    /// The kit of a trial cannot be built.
    #[error("the kit of a trial cannot be played: {0}")]
    Build(Box<KitError>),
    /// The table of a trial is invalid.
    #[error("the kit of a trial cannot be played: {0}")]
    Table(#[from] TableError),
    /// A trial cannot be drawn.
    #[error("a trial cannot be drawn: {0}")]
    Trial(#[from] TrialError),
    /// A motion makes no force.
    #[error("a trial cannot be played: {0}")]
    Scraped(#[from] ScrapedError),
    /// The instrument refuses a trial.
    #[error("a trial cannot be played: {0}")]
    Render(#[from] RenderError),
    /// The instrument refuses a part of a trial.
    #[error("a trial cannot be played: {0}")]
    Parts(#[from] PartsError),
    /// A sound is too long for the page.
    #[error("a sound of {seconds:.0} s is too long for the page")]
    Sound {
        /// Length in seconds.
        seconds: f64,
    },
    /// The page's data cannot be written as JSON.
    #[error("the page's data cannot be written as JSON: {0}")]
    Json(#[from] serde_json::Error),
    /// The page cannot be written.
    #[error(transparent)]
    File(#[from] FileError),
}
