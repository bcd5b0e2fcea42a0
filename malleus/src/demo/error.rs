//! Reasons for which the demo piece cannot be made. The shipped files give none.

use dsp_core::table::TableError;
use kit::KitError;

use crate::events::EventsFault;
use crate::motion::MotionFault;
use crate::motion::trials::TrialError;
use crate::render::scraped::ScrapedError;

/// Reason for which the demo piece cannot be made.
#[derive(Debug, thiserror::Error)]
pub enum DemoError {
    /// The kit lacks a pad or a striker of the piece.
    #[error("tables/demo-piece.csv: {0}")]
    Events(#[from] EventsFault),
    /// The kit with the surfaces cannot be read.
    #[error(transparent)]
    Kit(#[from] KitError),
    /// The kit with the surfaces is invalid.
    #[error("kit scrapes: {0}")]
    Table(#[from] TableError),
    /// A motion cannot be drawn.
    #[error("the demo's scrape: {0}")]
    Trial(#[from] TrialError),
    /// A motion is refused.
    #[error("the demo's scrape: {0}")]
    Motion(#[from] MotionFault),
    /// A motion makes no force.
    #[error("the demo's scrape: {0}")]
    Scraped(#[from] ScrapedError),
}
