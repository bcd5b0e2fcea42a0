//! Motions: how a scraper or a ball moves over pads, as files.
//!
//! A file ([`csv`]) says where the tool is, line by line; [`path`] joins the lines by a smooth
//! path, and [`normal`] derives the force with which the tool is pressed down, where the file does
//! not give it. [`trials`] draws the motions of the paper's experiments.
//!
//! ```text
//! lines ── builder ── path ──┬── state at a time, state at the end of each tick
//!                            └── normal force (eq. 8 and 9)
//! ```

pub mod csv;
pub mod normal;
pub mod path;
pub mod trials;

mod builder;
mod error;
mod reader;
mod speed;

use std::path::Path;

use dsp_core::SampleRate;
use dsp_core::table::Kit;

pub use error::{MotionError, MotionFault};
pub use path::{Action, Contact, Motion, State};
pub use reader::{Reader, Ticks};
pub use speed::MOST_SPEED_M_PER_S;

/// Reads a file of a motion for a kit. The rate is that of its column `sample`, if it has one.
///
/// # Errors
/// [`MotionError`] for the first thing that is wrong.
pub fn read(path: &Path, kit: &Kit<'_>, rate: SampleRate) -> Result<Motion, MotionError> {
    let in_file = |fault| MotionError { path: path.to_owned(), fault };
    let bytes = kit::file::read_whole(path).map_err(|error| in_file(error.into()))?;
    csv::parse(&bytes, kit, rate).map_err(in_file)
}
