//! Refusals of kits.

use std::fmt;

use dsp_core::table::range::CHAIN_DEPTH;
use dsp_core::table::{Place, TableError};

use crate::content::Kit;
use crate::counting::counted;
use crate::file::FileError;
use crate::nearest;

/// Refusal of a kit. Its message says what is wrong, where, and what to do.
#[derive(Debug, thiserror::Error)]
pub enum KitError {
    /// A file of the kit cannot be read or written.
    #[error(transparent)]
    File(#[from] FileError),
    /// The name is neither that of a file nor that of a shipped kit.
    #[error("{name}: there is no such file, and no shipped kit of that name; shipped kits: {}", shipped.join(", "))]
    UnknownKit {
        /// Name that was asked for.
        name: String,
        /// Names of the shipped kits.
        shipped: Vec<&'static str>,
    },
    /// The file is neither text in UTF-8 nor a binary kit.
    #[error(
        "{file}: not text in UTF-8 (byte {offset} is not); give a kit as text (.toml), or as a binary kit, which begins with \"MALL\" (.bin)"
    )]
    NotText {
        /// Name of the file.
        file: String,
        /// Offset of the first byte that is not UTF-8, counted from 0.
        offset: usize,
    },
    /// The text is not TOML, or a key is unknown, missing, or of the wrong type.
    #[error("{at}: {message}")]
    Toml {
        /// Place of the fault.
        at: Location,
        /// Description of the fault and of what is allowed there.
        message: String,
    },
    /// The text has a format version that this crate does not know.
    #[error("{at}: format = {found}: this program knows format {known}; update it, or write the file in that format")]
    FormatVersion {
        /// Place of the key `format`.
        at: Location,
        /// Format version of the file.
        found: i64,
        /// Format version that this crate knows.
        known: i64,
    },
    /// The kit has pads but no name.
    #[error("{file}: a kit with pads must have a name; add name = \"...\" above the first table")]
    MissingName {
        /// Name of the file.
        file: String,
    },
    /// A file that `include` names cannot be read, or is refused.
    #[error("{at}: include: {cause}")]
    Include {
        /// Place of the file's name.
        at: Location,
        /// Refusal of the named file.
        cause: Box<KitError>,
    },
    /// An included file includes another file.
    #[error(
        "{at}: include: this file is itself included by {by}, and only a kit's own file may include others; include {named:?} there"
    )]
    NestedInclude {
        /// Place of the name in the included file.
        at: Location,
        /// Name of the file that the included file includes.
        named: String,
        /// Name of the kit's own file.
        by: String,
    },
    /// An included file has pads.
    #[error("{at}: pad: this file is included by {by}, and only a kit's own file may have pads; move the pad there")]
    PadInInclude {
        /// Place of the first pad.
        at: Location,
        /// Name of the kit's own file.
        by: String,
    },
    /// An included file has a background.
    #[error(
        "{at}: background: this file is included by {by}, and only a kit's own file may have a background; move it there"
    )]
    BackgroundInInclude {
        /// Place of the background.
        at: Location,
        /// Name of the kit's own file.
        by: String,
    },
    /// Two items of one kind have the same name.
    #[error("{at}: {kind} {name:?}: there is one of that name at {first}; give each its own")]
    Duplicate {
        /// Place of the second name.
        at: Location,
        /// Kind of the items: `object`, `striker` or `pad`.
        kind: &'static str,
        /// Name that both items have.
        name: String,
        /// Place of the first name.
        first: Location,
    },
    /// An item of the kit is invalid.
    #[error("{}{item}: {fault}", at.as_ref().map_or(String::new(), |at| format!("{at}: ")))]
    Item {
        /// Place of the item in the text; `None` for a kit that is not from text.
        at: Option<Location>,
        /// Kind, index (counted from 0) and name of the item, in words.
        item: String,
        /// Place of the item in the kit.
        place: Place,
        /// Fault of the item.
        fault: Box<Fault>,
    },
    /// The bytes of a binary kit are refused.
    #[error("{}{error}", file.as_ref().map_or(String::new(), |file| format!("{file}: ")))]
    Binary {
        /// Name of the file, if the bytes are from one.
        file: Option<String>,
        /// Refusal by the reader of the binary form.
        error: TableError,
    },
}

/// Fault of an item of a kit.
#[derive(Debug, thiserror::Error)]
pub enum Fault {
    /// The reader of the binary form refuses a value.
    #[error("{}", without_place(.0))]
    Table(TableError),
    /// No object or striker has the given name.
    #[error("{key} names {name:?}: there is no such {kind}{}", choice(name, kind, known))]
    Unknown {
        /// Key that holds the name.
        key: &'static str,
        /// Kind of the item that is named: `object` or `striker`.
        kind: &'static str,
        /// Name that no item has.
        name: String,
        /// Names of the kit's items of that kind.
        known: Vec<String>,
    },
    /// A mode has more or fewer gains than another mode, or than its own other phase.
    #[error("{}: must be {expected}, {why}", counted(*found, "gains"))]
    GainCount {
        /// Number of gains.
        found: usize,
        /// Required number of gains.
        expected: usize,
        /// Reason for the required number, in words.
        why: &'static str,
    },
    /// An array has more or fewer numbers than another array requires.
    #[error("{key} has {}: must have {expected}, {why}", counted(*found, "numbers"))]
    NumberCount {
        /// Key of the array.
        key: &'static str,
        /// Number of numbers in the array.
        found: usize,
        /// Required number of numbers.
        expected: usize,
        /// Reason for the required number, in words.
        why: &'static str,
    },
    /// A breakpoint has another order than the first one of its path.
    #[error("a2 and b2: give both in every breakpoint (second order), or in none (first order)")]
    MixedOrder,
    /// A chain has another number of biquads than the first chain of its bank.
    #[error("{}: must be {expected}, as many as the first chain has", counted(*found, "biquads"))]
    ChainDepth {
        /// Number of biquads in the chain.
        found: usize,
        /// Number of biquads in the first chain.
        expected: usize,
    },
    /// All heights of a surface are the same.
    #[error("heights: all are the same; a surface must have waves")]
    Flat,
    /// The heights of a map do not fill its rows.
    #[error("heights: {} cannot make {rows} rows of one length; give as many to each row", counted(*heights, "numbers"))]
    Uneven {
        /// Number of heights.
        heights: usize,
        /// Number of rows.
        rows: usize,
    },
    /// A side of a map is shorter than three of its shortest waves.
    #[error(
        "heights: a side of the map is {side_m:e} m long, three shortest waves of {shortest_m:e} m at least are needed: give more rows or columns"
    )]
    Narrow {
        /// Length of the shorter side in metres.
        side_m: f64,
        /// Shortest wave in metres.
        shortest_m: f64,
    },
    /// A scraper's own limits are upside down.
    #[error("alpha_min_m = {least_m:e}: must be at most alpha_max_m = {most_m:e}; exchange the two")]
    Limits {
        /// Limit at the largest normal force in metres.
        least_m: f32,
        /// Limit at the least normal force in metres.
        most_m: f32,
    },
    /// A scraper's own limit and the usual other one of a surface are upside down.
    #[error(
        "{key} = {own_m:e}: must be at {bound} {usual_m:e}, the usual {other} on surface {surface:?}; give another {key}, or {other} too"
    )]
    LimitOnSurface {
        /// Key of the striker's own limit.
        key: &'static str,
        /// The striker's own limit in metres.
        own_m: f32,
        /// `most` or `least`.
        bound: &'static str,
        /// Key of the other limit.
        other: &'static str,
        /// The surface's other limit in metres.
        usual_m: f64,
        /// Name of the surface.
        surface: String,
    },
    /// A MIDI note lies outside 0 to 127.
    #[error("midi_notes has {note}: notes are 0 to 127")]
    MidiNote {
        /// Refused note.
        note: i64,
    },
    /// The kit has more of something than the binary form can hold.
    #[error("{what}: {found}: must be at most {max}")]
    TooLarge {
        /// Name of the counted thing, with its unit.
        what: &'static str,
        /// Number of these things in the kit.
        found: usize,
        /// Largest number that the binary form can hold.
        max: usize,
    },
}

/// Place in a text file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Location {
    /// Name of the file.
    pub file: String,
    /// Line, counted from 1.
    pub line: usize,
    /// Column in characters, counted from 1.
    pub column: usize,
}

impl Location {
    /// Finds line and column of the byte at `offset` in the text of a file.
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
    /// Creates the refusal of the item at `place`, without its place in a text.
    pub(crate) fn item(kit: &Kit, place: Place, fault: Fault) -> Self {
        Self::Item { at: None, item: item_name(kit, place), place, fault: Box::new(fault) }
    }

    /// Converts the reader's refusal of the binary form that was built from `kit`.
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

/// Kind, index and name of an item, in words.
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
        Place::Surface(index) => {
            format!("surface {index} {:?}", kit.surfaces.get(index).map_or("", |surface| &surface.name))
        }
        Place::StrikerScrape(index) => format!("striker {index} {:?}, scrape", striker(index)),
    }
}

/// Item that a refusal is about; `None` if it is about the bytes as a whole.
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
        | TableError::RollAlone { place }
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

/// Message of the reader of the binary form without the place at its beginning.
///
/// [`KitError::Item`] names the place in its own words.
fn without_place(error: &TableError) -> String {
    let message = error.to_string();
    let place = place_of(error).map_or(String::new(), |place| format!("{place}: "));
    message.strip_prefix(&place).unwrap_or(&message).to_owned()
}

/// Names that exist, in words, with the one that was probably meant.
fn choice(name: &str, kind: &str, known: &[String]) -> String {
    if known.is_empty() {
        return format!("; the kit has no {kind}s");
    }
    let nearest =
        nearest::nearest(name, known).map_or(String::new(), |nearest| format!(" (did you mean {nearest:?}?)"));
    let known: Vec<String> = known.iter().map(|name| format!("{name:?}")).collect();
    format!("{nearest}; {kind}s: {}", known.join(", "))
}
