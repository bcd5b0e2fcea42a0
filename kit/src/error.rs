//! Why a kit is refused.

use std::fmt;

use dsp_core::table::range::CHAIN_DEPTH;
use dsp_core::table::{Place, TableError};

use crate::file::FileError;
use crate::{Kit, nearest};

/// What is wrong with a kit, where, and what to do about it.
#[derive(Debug, thiserror::Error)]
pub enum KitError {
    /// A file cannot be read or written.
    #[error(transparent)]
    File(#[from] FileError),
    /// Neither a file nor a shipped kit.
    #[error("{name}: there is no such file, and no shipped kit of that name; shipped kits: {}", shipped.join(", "))]
    UnknownKit {
        /// What was asked for.
        name: String,
        /// The shipped kits.
        shipped: Vec<&'static str>,
    },
    /// A file that is neither text nor a binary kit.
    #[error(
        "{file}: neither a binary kit (it does not begin with \"MALL\") nor UTF-8 text (byte {offset} is not); give a kit as .toml or .bin"
    )]
    NotText {
        /// The file.
        file: String,
        /// The first byte that is not UTF-8.
        offset: usize,
    },
    /// The text is not TOML, or a key is unknown, missing, or of the wrong type.
    #[error("{at}: {message}")]
    Toml {
        /// Where.
        at: Location,
        /// What, and what is allowed.
        message: String,
    },
    /// The text is of a format version that this crate does not know.
    #[error(
        "{at}: format = {found}: this program knows format {}; update it, or write the file in that format",
        crate::text::FORMAT
    )]
    FormatVersion {
        /// Where.
        at: Location,
        /// The file's format version.
        found: i64,
    },
    /// A kit that has pads but no name.
    #[error("{file}: a kit with pads must have a name; add name = \"...\" above the first table")]
    MissingName {
        /// The file.
        file: String,
    },
    /// A file named by `include` cannot be had.
    #[error("{at}: include: {cause}")]
    Include {
        /// Where it is named.
        at: Location,
        /// What went wrong.
        cause: Box<KitError>,
    },
    /// An included file includes others.
    #[error(
        "{at}: include: this file is itself included by {by}, and only a kit's own file may include; name {named:?} there"
    )]
    NestedInclude {
        /// Where.
        at: Location,
        /// The file that it names.
        named: String,
        /// The file that includes this one.
        by: String,
    },
    /// An included file has pads.
    #[error("{at}: pad: this file is included by {by}, and only a kit's own file may have pads; move the pad there")]
    PadInInclude {
        /// Where.
        at: Location,
        /// The file that includes this one.
        by: String,
    },
    /// An included file has a background.
    #[error(
        "{at}: background: this file is included by {by}, and only a kit's own file may have a background; move it there"
    )]
    BackgroundInInclude {
        /// Where.
        at: Location,
        /// The file that includes this one.
        by: String,
    },
    /// Two items of one kind with the same name.
    #[error("{at}: {kind} {name:?}: there is one of that name at {first}; give each its own")]
    Duplicate {
        /// The second.
        at: Location,
        /// `object`, `striker` or `pad`.
        kind: &'static str,
        /// The name.
        name: String,
        /// The first.
        first: Location,
    },
    /// An item of the kit is wrong.
    #[error("{}{item}: {fault}", at.as_ref().map_or(String::new(), |at| format!("{at}: ")))]
    Item {
        /// Where it stands, for a kit from text.
        at: Option<Location>,
        /// The item with its index, counted from 0, and its name.
        item: String,
        /// The item.
        place: Place,
        /// What is wrong.
        fault: Box<Fault>,
    },
    /// The bytes of a binary kit are refused.
    #[error("{}{error}", file.as_ref().map_or(String::new(), |file| format!("{file}: ")))]
    Binary {
        /// The file, where there is one.
        file: Option<String>,
        /// What is wrong.
        error: TableError,
    },
}

/// What is wrong with an item of a kit.
#[derive(Debug, thiserror::Error)]
pub enum Fault {
    /// A value that the table reader refuses.
    #[error("{}", without_place(.0))]
    Table(TableError),
    /// A name that no object or striker has.
    #[error("{key} names {name:?}: there is no such {kind}{}", choice(name, kind, known))]
    Unknown {
        /// The key.
        key: &'static str,
        /// `object` or `striker`.
        kind: &'static str,
        /// The name.
        name: String,
        /// The names that exist.
        known: Vec<String>,
    },
    /// A mode's gains do not fit those of the other modes, or each other.
    #[error("{found} gains: must be {expected}, {why}")]
    GainCount {
        /// How many there are.
        found: usize,
        /// How many there must be.
        expected: usize,
        /// What asks for that many.
        why: &'static str,
    },
    /// An array with more or fewer numbers than the others ask for.
    #[error("{key} has {found} numbers: must have {expected}, {why}")]
    NumberCount {
        /// The key of the array.
        key: &'static str,
        /// How many there are.
        found: usize,
        /// How many there must be.
        expected: usize,
        /// What asks for that many.
        why: &'static str,
    },
    /// A breakpoint with another order than the first one's.
    #[error("a2 and b2: give both in every breakpoint (second order), or in none (first order)")]
    MixedOrder,
    /// A chain with another number of biquads than the first one.
    #[error("{found} biquads: must be {expected}, as many as the first chain has")]
    ChainDepth {
        /// How many there are.
        found: usize,
        /// How many there must be.
        expected: usize,
    },
    /// A MIDI note outside 0 to 127.
    #[error("midi_notes has {note}: notes are 0 to 127")]
    MidiNote {
        /// The note.
        note: i64,
    },
    /// More than the binary form can hold.
    #[error("{what}: {found}: must be at most {max}")]
    TooLarge {
        /// What is counted, with its unit.
        what: &'static str,
        /// How many there are.
        found: usize,
        /// The largest number that fits.
        max: usize,
    },
}

/// A place in a text file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Location {
    /// The file.
    pub file: String,
    /// The line, from 1.
    pub line: usize,
    /// The column in characters, from 1.
    pub column: usize,
}

impl Location {
    /// The place of the byte `offset` in a file's text.
    pub(crate) fn of(file: &str, text: &str, offset: usize) -> Self {
        let before = text.get(..offset).unwrap_or(text);
        let line_start = before.rfind('\n').map_or(0, |newline| newline + 1);
        Self {
            file: file.to_owned(),
            line: before.matches('\n').count() + 1,
            column: before.get(line_start..).map_or(0, |line| line.chars().count()) + 1,
        }
    }
}

impl fmt::Display for Location {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}:{}:{}", self.file, self.line, self.column)
    }
}

impl KitError {
    pub(crate) fn item(kit: &Kit, place: Place, fault: Fault) -> Self {
        Self::Item { at: None, item: item_name(kit, place), place, fault: Box::new(fault) }
    }

    /// The table reader's refusal of the binary built from `kit`.
    pub(crate) fn from_table(kit: &Kit, error: TableError) -> Self {
        match place_of(&error) {
            Some(place) => Self::item(kit, place, Fault::Table(error)),
            None => Self::Binary { file: None, error },
        }
    }
}

impl From<TableError> for KitError {
    fn from(error: TableError) -> Self {
        Self::Binary { file: None, error }
    }
}

fn item_name(kit: &Kit, place: Place) -> String {
    let object = |index: usize| kit.objects.get(index).map_or("", |object| &object.name);
    let striker = |index: usize| kit.strikers.get(index).map_or("", |striker| &striker.name);
    match place {
        Place::Kit => format!("kit {:?}", kit.name),
        Place::Object(index) => format!("object {index} {:?}", object(index)),
        Place::ObjectMode(index, mode) => format!("object {index} {:?}, mode {mode}", object(index)),
        Place::Striker(index) => format!("striker {index} {:?}", striker(index)),
        Place::StrikerMode(index, mode) => format!("striker {index} {:?}, mode {mode}", striker(index)),
        Place::Pad(index) => format!("pad {index} {:?}", kit.pads.get(index).map_or("", |pad| &pad.name)),
        Place::ObjectResidual(index) => format!("object {index} {:?}, residual", object(index)),
        Place::ObjectEdge(index, edge) => format!("object {index} {:?}, residual, edge {edge}", object(index)),
        Place::ObjectBand(index, band) => format!("object {index} {:?}, residual, band {band}", object(index)),
        Place::ObjectFilter(index) => format!("object {index} {:?}, dynamic filter", object(index)),
        Place::ObjectBreakpoint(index, breakpoint) => {
            format!("object {index} {:?}, dynamic filter, breakpoint {breakpoint}", object(index))
        }
        Place::ObjectLoop(index, number) => {
            format!("object {index} {:?}, dynamic filter, loop {number}", object(index))
        }
        Place::ObjectBiquads(index) => format!("object {index} {:?}, biquads", object(index)),
        Place::ObjectChain(index, chain) => format!("object {index} {:?}, biquads, chain {chain}", object(index)),
        Place::ObjectBiquad(index, number) => {
            let (chain, biquad) = (number / CHAIN_DEPTH, number % CHAIN_DEPTH);
            format!("object {index} {:?}, biquads, chain {chain}, biquad {biquad}", object(index))
        }
        Place::Background => "background".to_owned(),
        Place::BackgroundEdge(edge) => format!("background, edge {edge}"),
        Place::BackgroundBand(band) => format!("background, band {band}"),
        Place::Room => "room".to_owned(),
        Place::RoomBand(band) => format!("room, band {band}"),
    }
}

fn place_of(error: &TableError) -> Option<Place> {
    match *error {
        TableError::LengthMismatch { place, .. }
        | TableError::OutOfRange { place, .. }
        | TableError::Count { place, .. }
        | TableError::Dangling { place, .. }
        | TableError::BadName { place }
        | TableError::DuplicateName { place }
        | TableError::BadNote { place, .. }
        | TableError::SharedInput { place, .. }
        | TableError::BadText { place }
        | TableError::GaussianRestitution { place, .. }
        | TableError::EdgeOrder { place, .. }
        | TableError::UnstablePole { place, .. }
        | TableError::TimeOrder { place, .. }
        | TableError::NotZero { place, .. } => Some(place),
        TableError::Truncated { .. }
        | TableError::WrongMagic { .. }
        | TableError::NewerVersion { .. }
        | TableError::WrongCrc { .. }
        | TableError::TrailingBytes { .. }
        | TableError::SectionBounds { .. }
        | TableError::UnknownSection { .. }
        | TableError::NewerSection { .. }
        | TableError::SectionCount { .. } => None,
    }
}

/// The table reader's message without the place at its beginning, which [`KitError::Item`] says with the item's name.
fn without_place(error: &TableError) -> String {
    let message = error.to_string();
    let place = place_of(error).map_or(String::new(), |place| format!("{place}: "));
    message.strip_prefix(&place).unwrap_or(&message).to_owned()
}

fn choice(name: &str, kind: &str, known: &[String]) -> String {
    if known.is_empty() {
        return format!("; the kit has no {kind}s");
    }
    let nearest =
        nearest::nearest(name, known).map_or(String::new(), |nearest| format!(" (did you mean {nearest:?}?)"));
    let known: Vec<String> = known.iter().map(|name| format!("{name:?}")).collect();
    format!("{nearest}; {kind}s: {}", known.join(", "))
}
