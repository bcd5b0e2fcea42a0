//! Reasons for which a list of events is refused.

use std::path::PathBuf;

use kit::counting::counted;

/// Refusal of a file of events: it cannot be read, or the kit cannot play it.
#[derive(Debug, thiserror::Error)]
#[error("{}: {fault}", path.display())]
pub struct EventsError {
    /// Path of the refused file.
    pub path: PathBuf,
    /// Reason of the refusal.
    pub fault: EventsFault,
}

/// Reason for which the content of a file of events is refused.
#[derive(Debug, thiserror::Error)]
pub enum EventsFault {
    /// The file cannot be read from disk.
    #[error("{}", .0.reason())]
    File(#[from] kit::file::FileError),
    /// The file is binary, or text in another encoding than UTF-8.
    #[error(
        "not text in UTF-8 (byte {offset} is not); give events as CSV, such as time_s,pad,velocity, or as a Standard MIDI File"
    )]
    NotText {
        /// Offset of the first byte that is not UTF-8 or is a NUL, counted from 0.
        offset: usize,
    },
    /// A line has more or fewer fields than the header.
    #[error(
        "line {line}: the number of fields is {found}; the header has {expected}, and every line must have as many"
    )]
    FieldCount {
        /// Line of the file, counted from 1.
        line: u64,
        /// Number of fields on the line.
        found: u64,
        /// Number of fields in the header.
        expected: u64,
    },
    /// The header lacks a column, repeats one, or has an unknown one.
    #[error(
        "line 1: {0}; the header is `sample,pad,velocity` or `time_s,pad,velocity`, then any of `position`, `striker`, `action`, `peak_force`, `contact_time_s`"
    )]
    Header(String),
    /// A field holds a value that is not allowed there.
    #[error("line {line}: {column} = {value:?}: {allowed}")]
    Field {
        /// Line of the file, counted from 1.
        line: u64,
        /// Name of the column.
        column: &'static str,
        /// Refused value, as it stands in the file.
        value: String,
        /// Values that are allowed in the field, in words.
        allowed: String,
    },
    /// An event is earlier than the one on the line before it.
    #[error("line {line}: this event is earlier than the one before it; sort the file by time")]
    OutOfOrder {
        /// Line of the file, counted from 1.
        line: u64,
    },
    /// The MIDI file is damaged, cut off, or not a MIDI file at all.
    #[error("not a whole Standard MIDI File: it is damaged, cut off or of another format; export or copy it again")]
    Midi(#[source] midly::Error),
    /// The MIDI file divides a quarter note, or a second, into no ticks.
    #[error("MIDI timing of 0 ticks: a quarter note, or a second, must have at least one; export it again")]
    MidiTiming,
    /// The kit maps none of the file's MIDI notes to a pad.
    #[error("it has {}, and none is in midi_notes of any pad; the kit plays {mapped}", counted(*notes, "notes"))]
    NoMappedNote {
        /// Number of notes in the file.
        notes: usize,
        /// MIDI notes that the kit maps, each with its pad, in words.
        mapped: String,
    },
}
