//! Lists of events, as files.
//!
//! [`csv`] is the project's own format, the same that a trigger reports; [`midi`] reads a Standard MIDI File.

pub mod csv;
pub mod midi;

use std::path::{Path, PathBuf};

use dsp_core::SampleRate;
use dsp_core::event::{Event, Time};
use dsp_core::table::Kit;

/// Events that cannot be read, or that the kit cannot play.
#[derive(Debug, thiserror::Error)]
#[error("{}: {fault}", path.display())]
pub struct EventsError {
    /// The file.
    pub path: PathBuf,
    /// What is wrong with it.
    pub fault: EventsFault,
}

/// What is wrong with a file of events.
#[derive(Debug, thiserror::Error)]
pub enum EventsFault {
    /// The file cannot be read.
    #[error(transparent)]
    File(#[from] kit::file::FileError),
    /// A line is not CSV.
    #[error("not CSV: {0}")]
    Csv(#[from] ::csv::Error),
    /// The header lacks a column or has an unknown one.
    #[error(
        "line 1: {0}; the header is `sample,pad,velocity` or `time_s,pad,velocity`, then any of `position`, `striker`, `action`"
    )]
    Header(String),
    /// A field cannot be.
    #[error("line {line}: {column} = {value:?}: {allowed}")]
    Field {
        /// The line of the file, from 1.
        line: u64,
        /// The column.
        column: &'static str,
        /// What stands there.
        value: String,
        /// What may stand there.
        allowed: String,
    },
    /// An event is earlier than the one before it.
    #[error("line {line}: this event is earlier than the one before it; sort the file by time")]
    OutOfOrder {
        /// The line of the file, from 1.
        line: u64,
    },
    /// The MIDI file is damaged.
    #[error("not a whole MIDI file: {0}; export or copy it again")]
    Midi(midly::Error),
    /// The MIDI file counts time in a way that cannot be.
    #[error("MIDI timing of 0 ticks: a quarter note, or a second, must have at least one; export it again")]
    MidiTiming,
    /// None of the MIDI notes is mapped.
    #[error("none of its {notes} notes is in midi_notes of any pad; the kit plays {mapped}")]
    NoMappedNote {
        /// How many notes it has.
        notes: usize,
        /// The notes of the kit and their pads.
        mapped: String,
    },
}

/// Events of a file, and what of it was left out.
#[derive(Clone, Debug, Default)]
pub struct EventList {
    /// The events in order of time.
    pub events: Vec<Event>,
    /// Remarks for the user, such as notes that no pad plays.
    pub remarks: Vec<String>,
}

/// Reads a file of events for a kit: MIDI by its first bytes `MThd` or the ending `.mid`/`.midi`, else CSV.
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

/// A time in seconds as frames and a fraction of a frame; negative times and times beyond 2^53 frames have none.
pub fn time_from_seconds(seconds: f64, rate: SampleRate) -> Option<Time> {
    let frames = seconds * rate.hz();
    if !(0.0..9e15).contains(&frames) {
        return None;
    }
    let whole = frames.floor();
    // `as` saturates: a fraction that rounds up to 1 stays just below it.
    Some(Time { frame: whole as u64, fraction: ((frames - whole) * 4_294_967_296.0).round() as u32 })
}
