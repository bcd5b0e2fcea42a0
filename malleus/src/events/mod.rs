//! Lists of events, as files.
//!
//! [`csv`] is the project's own format, the one in which `malleus play --log` writes what was
//! played; [`midi`] reads a Standard MIDI File. [`usb_midi`] makes packets of one, for a board.

pub mod csv;
pub mod midi;
pub mod usb_midi;

mod error;
mod list;

use std::path::Path;

use dsp_core::SampleRate;
use dsp_core::table::Kit;

pub use error::{EventsError, EventsFault};
pub use list::{EventList, OwnForce, time_from_seconds};

/// Reads a file of events for a kit.
///
/// A file that begins with `MThd`, or whose name ends in `.mid` or `.midi`, is read as MIDI, any
/// other as CSV.
///
/// # Errors
/// [`EventsError`] for the first thing that is wrong.
pub fn read(path: &Path, kit: &Kit<'_>, rate: SampleRate) -> Result<EventList, EventsError> {
    let in_file = |fault| EventsError { path: path.to_owned(), fault };
    let bytes = kit::file::read_whole(path).map_err(|error| in_file(error.into()))?;
    let ends_with = |ending: &str| path.extension().is_some_and(|found| found.eq_ignore_ascii_case(ending));
    let list = if bytes.starts_with(b"MThd") || ends_with("mid") || ends_with("midi") {
        midi::parse(&bytes, kit, rate)
    } else {
        csv::parse(&bytes, kit, rate)
    };
    list.map_err(in_file)
}
