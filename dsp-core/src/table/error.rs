//! The errors of a kit's bytes.

use core::fmt;

use super::layout::{FORMAT_VERSION, SECTION_VERSION};
use super::place::{Field, Place};
use super::range::{BAND_WIDTH_HZ, Range};

/// Error in a kit's bytes. It tells the field, its place, its value and what is allowed.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum TableError {
    /// The bytes end before the kit does.
    Truncated {
        /// Bytes that the kit claims or needs.
        needed: usize,
        /// Bytes that are there.
        found: usize,
    },
    /// The first four bytes are not a kit's.
    WrongMagic {
        /// Bytes that stand there.
        found: [u8; 4],
    },
    /// The kit has a format version that this reader does not know.
    NewerVersion {
        /// Format version of the kit.
        found: u32,
    },
    /// The checksum does not fit the bytes: the kit was damaged or half written.
    WrongCrc {
        /// Checksum in the header.
        stored: u32,
        /// Checksum of the bytes.
        computed: u32,
    },
    /// Something other than erased flash follows the kit's end.
    TrailingBytes {
        /// Offset of the first such byte from the kit's beginning.
        offset: usize,
    },
    /// The sections do not tile the kit without gaps.
    SectionBounds {
        /// Number of the section in the directory, counted from 0.
        section: usize,
        /// Tag of the section.
        tag: [u8; 4],
        /// Offset of the section in bytes.
        offset: usize,
        /// Length of the section in bytes.
        length: usize,
        /// Offset in bytes at which the section must begin.
        expected_offset: usize,
        /// Length of the whole kit in bytes.
        kit_length: usize,
    },
    /// A section has a tag that this reader does not know and may not skip.
    UnknownSection {
        /// Tag of the section.
        tag: [u8; 4],
    },
    /// A section has a version that this reader does not know.
    NewerSection {
        /// Tag of the section.
        tag: [u8; 4],
        /// Version of the section.
        found: u32,
    },
    /// A section that a kit must have once is missing, or a section stands twice that may stand
    /// only once.
    SectionCount {
        /// Tag of the section.
        tag: [u8; 4],
        /// Number of sections with this tag.
        found: usize,
    },
    /// A section is longer or shorter than its head announces.
    LengthMismatch {
        /// Place of the section.
        place: Place,
        /// Length in bytes that the head announces.
        expected: usize,
        /// Length of the section in bytes.
        found: usize,
    },
    /// A number is outside its range, infinite, or not a number.
    OutOfRange {
        /// Place of the field.
        place: Place,
        /// Key of the field.
        field: Field,
        /// Value of the field.
        value: f32,
        /// Range that is allowed.
        allowed: Range,
    },
    /// A count or a number of a thing is outside its range.
    Count {
        /// Place of the field.
        place: Place,
        /// Key of the field.
        field: Field,
        /// Value of the field.
        value: usize,
        /// Smallest value that is allowed.
        min: usize,
        /// Largest value that is allowed.
        max: usize,
    },
    /// A field names an object, a striker or a pad that the kit does not have.
    Dangling {
        /// Place of the field.
        place: Place,
        /// Key of the field.
        field: Field,
        /// Index that the field names.
        index: usize,
        /// Number of such things in the kit.
        count: usize,
    },
    /// A striker rolls, but does not scrape.
    RollAlone {
        /// Place of the striker.
        place: Place,
    },
    /// A name is empty, begins or ends with a space, or has a character other than printable ASCII
    /// without `,` and `"`.
    BadName {
        /// Place of the thing with that name.
        place: Place,
    },
    /// Two things of one kind have the same name.
    DuplicateName {
        /// Place of the second of the two.
        place: Place,
    },
    /// A MIDI note is above 127, or two pads claim it.
    BadNote {
        /// Place of the pad.
        place: Place,
        /// MIDI note.
        note: u8,
    },
    /// Two pads, or two sensors of one pad, claim the same input.
    SharedInput {
        /// Place of the second pad.
        place: Place,
        /// Key of the field.
        field: Field,
        /// Number of the channel or the button.
        input: u8,
    },
    /// An edge of a noise band is less than [`BAND_WIDTH_HZ`] above the edge before it.
    EdgeOrder {
        /// Place of the edge.
        place: Place,
        /// Key of the edge.
        field: Field,
        /// Edge before it, in Hz.
        below: f32,
        /// Edge, in Hz.
        above: f32,
    },
    /// A filter has a pole on or outside the unit circle.
    UnstablePole {
        /// Place of the breakpoint or the biquad.
        place: Place,
        /// Key that decides the radius.
        field: Field,
        /// Largest radius of the poles.
        radius: f32,
    },
    /// A breakpoint is not later than the breakpoint before it.
    TimeOrder {
        /// Place of the breakpoint.
        place: Place,
        /// Time of the breakpoint before it, in seconds.
        before_s: f32,
        /// Time of the breakpoint, in seconds.
        time_s: f32,
    },
    /// A striker with a Gaussian pulse, which has no restitution, has one other than the default.
    GaussianRestitution {
        /// Place of the striker.
        place: Place,
        /// Restitution in the kit.
        value: f32,
    },
    /// A text is not UTF-8.
    BadText {
        /// Place of the thing with that text.
        place: Place,
    },
    /// Bytes or bits that must be zero are not zero.
    NotZero {
        /// Place of the field.
        place: Place,
        /// Key of the field.
        field: Field,
    },
}

struct Tag([u8; 4]);

impl fmt::Display for Tag {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "\"{}\"", self.0.escape_ascii())
    }
}

impl fmt::Display for TableError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::Truncated { needed, found } => {
                write!(f, "truncated: {needed} bytes are needed, {found} are there; copy the whole file")
            }
            Self::WrongMagic { found } => {
                write!(f, "wrong magic: a kit begins with \"MALL\", this begins with {}", Tag(found))
            }
            Self::NewerVersion { found } => {
                write!(
                    f,
                    "format version {found}: this reader knows version {FORMAT_VERSION}; update it, or build the kit again"
                )
            }
            Self::WrongCrc { stored, computed } => write!(
                f,
                "CRC mismatch: the header says {stored:08x}, the bytes give {computed:08x}: damaged or half written; build or copy the kit again"
            ),
            Self::TrailingBytes { offset } => {
                write!(
                    f,
                    "bytes other than 0xFF follow the kit's end, at offset {offset}; erase what lies behind the kit"
                )
            }
            Self::SectionBounds { section, tag, offset, length, expected_offset, kit_length } => write!(
                f,
                "section {section} ({}) at offset {offset}, {length} bytes: it must begin at {expected_offset}, be a multiple of 4 bytes long and end within the kit's {kit_length} bytes, the last section at their end; build the kit again",
                Tag(tag)
            ),
            Self::UnknownSection { tag } => {
                write!(f, "unknown section {}: this reader does not know that stage; update it", Tag(tag))
            }
            Self::NewerSection { tag, found } => {
                write!(
                    f,
                    "section {} of version {found}: this reader knows version {SECTION_VERSION}; update it",
                    Tag(tag)
                )
            }
            Self::SectionCount { tag, found } => {
                write!(f, "the kit has {found} sections {} instead of one; build it again", Tag(tag))
            }
            Self::LengthMismatch { place, expected, found } => {
                write!(f, "{place}: its head announces {expected} bytes, the section has {found}; build the kit again")
            }
            Self::OutOfRange { place, field, value, allowed } => {
                write!(f, "{place}: {} = {value}: must be from {} to {}", field.key(), allowed.min, allowed.max)
            }
            Self::Count { place, field, value, min, max } => {
                write!(f, "{place}: {} = {value}: must be from {min} to {max}", field.key())
            }
            Self::Dangling { place, field, index, count } => {
                write!(f, "{place}: {} names number {index}, but the kit has {count} (counted from 0)", field.key())
            }
            Self::BadName { place } => write!(
                f,
                "{place}: name must be 1 to 24 printable ASCII characters without comma and quote, and no space at its ends"
            ),
            Self::DuplicateName { place } => write!(f, "{place}: another one has the same name"),
            Self::BadNote { place, note } => {
                write!(f, "{place}: midi_notes has {note}: notes are 0 to 127, each for one pad only")
            }
            Self::SharedInput { place, field, input } => write!(
                f,
                "{place}: {} = {input}: another sensor or pad has that input already; give each its own",
                field.key()
            ),
            Self::EdgeOrder { place, field, below, above } => write!(
                f,
                "{place}: {} = {above}: must be at least {} Hz above the edge before it, {below}",
                field.key(),
                BAND_WIDTH_HZ
            ),
            Self::UnstablePole { place, field, radius } => write!(
                f,
                "{place}: {}: a pole of radius {radius} does not decay; move it within the unit circle",
                field.key()
            ),
            Self::TimeOrder { place, before_s, time_s } => {
                write!(f, "{place}: time_s = {time_s}: must be later than the breakpoint before it, {before_s}")
            }
            Self::GaussianRestitution { place, value } => write!(
                f,
                "{place}: restitution = {value}: a gaussian pulse has none; leave the key out, or take pulse = \"hertz\""
            ),
            Self::RollAlone { place } => write!(
                f,
                "{place}: a striker with a table [striker.roll] must have [striker.scrape] too; give it one with its mass_kg"
            ),
            Self::BadText { place } => write!(f, "{place}: source or licence is not UTF-8; save the text as UTF-8"),
            Self::NotZero { place, field } => write!(f, "{place}: {} must be zero", field.key()),
        }
    }
}

impl core::error::Error for TableError {}
