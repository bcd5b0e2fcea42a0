//! Why a kit's bytes are refused.

use core::fmt;

use super::layout::{FORMAT_VERSION, SECTION_VERSION};
use super::place::{Field, Place};
use super::range::Range;

/// What is wrong with a kit's bytes: which field, where, what it holds and what is allowed.
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
        /// What stands there.
        found: [u8; 4],
    },
    /// The kit is of a version that this reader does not know.
    NewerVersion {
        /// The kit's version.
        found: u32,
    },
    /// The checksum does not fit the bytes: the kit was damaged or half written.
    WrongCrc {
        /// The checksum in the header.
        stored: u32,
        /// The checksum of the bytes.
        computed: u32,
    },
    /// Something other than erased flash follows the kit's end.
    TrailingBytes {
        /// Where the first such byte lies.
        offset: usize,
    },
    /// A section does not lie where the directory and its neighbours say.
    SectionBounds {
        /// Its place in the directory.
        section: usize,
        /// Its tag.
        tag: [u8; 4],
        /// Its offset in bytes.
        offset: usize,
        /// Its length in bytes.
        length: usize,
        /// The offset at which it must begin.
        expected_offset: usize,
        /// The bytes of the whole kit.
        kit_length: usize,
    },
    /// A section of a kind that this reader does not know and may not skip.
    UnknownSection {
        /// Its tag.
        tag: [u8; 4],
    },
    /// A section of a version that this reader does not know.
    NewerSection {
        /// Its tag.
        tag: [u8; 4],
        /// Its version.
        found: u32,
    },
    /// A section that a kit must have is missing, or there twice.
    SectionCount {
        /// Its tag.
        tag: [u8; 4],
        /// How many there are.
        found: usize,
    },
    /// A section's length does not fit what its head announces.
    LengthMismatch {
        /// Which section.
        place: Place,
        /// Bytes that the head announces.
        expected: usize,
        /// Bytes of the section.
        found: usize,
    },
    /// A number outside its range, infinite, or not a number.
    OutOfRange {
        /// Where it stands.
        place: Place,
        /// Which field.
        field: Field,
        /// Its value.
        value: f32,
        /// What is allowed.
        allowed: Range,
    },
    /// A count outside what is allowed.
    Count {
        /// Where it stands.
        place: Place,
        /// Which field.
        field: Field,
        /// Its value.
        value: usize,
        /// The smallest allowed.
        min: usize,
        /// The largest allowed.
        max: usize,
    },
    /// A reference to an object or striker that the kit does not have.
    Dangling {
        /// Where it stands.
        place: Place,
        /// Which field.
        field: Field,
        /// The index that it names.
        index: usize,
        /// How many there are.
        count: usize,
    },
    /// A name that is empty, has other characters than printable ASCII without `,` and `"`, or begins or ends with a space.
    BadName {
        /// Whose name.
        place: Place,
    },
    /// Two things of one kind with the same name.
    DuplicateName {
        /// The second of the two.
        place: Place,
    },
    /// A MIDI note above 127, or one that two pads claim.
    BadNote {
        /// Which pad.
        place: Place,
        /// The note.
        note: u8,
    },
    /// An input that two pads, or two sensors of one, claim.
    SharedInput {
        /// The second pad.
        place: Place,
        /// Which field.
        field: Field,
        /// The channel or the button.
        input: u8,
    },
    /// An edge of a noise band that is not above the one before it.
    EdgeOrder {
        /// Which edge.
        place: Place,
        /// Its key.
        field: Field,
        /// The one before, in Hz.
        below: f32,
        /// The edge, in Hz.
        above: f32,
    },
    /// A filter whose poles lie on or outside the unit circle.
    UnstablePole {
        /// Which breakpoint or biquad.
        place: Place,
        /// The key that decides it.
        field: Field,
        /// The largest radius of its poles.
        radius: f32,
    },
    /// A breakpoint that is not later than the one before it.
    TimeOrder {
        /// Which breakpoint.
        place: Place,
        /// The one before, in seconds.
        before_s: f32,
        /// The breakpoint, in seconds.
        time_s: f32,
    },
    /// A Gaussian striker with a restitution other than the default: its pulse has none.
    GaussianRestitution {
        /// Which striker.
        place: Place,
        /// Its restitution.
        value: f32,
    },
    /// A text that is not UTF-8.
    BadText {
        /// Whose text.
        place: Place,
    },
    /// Bytes that must be zero are not.
    NotZero {
        /// Where.
        place: Place,
        /// Which field.
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
                write!(f, "bytes other than 0xFF follow the kit's end, at offset {offset}")
            }
            Self::SectionBounds { section, tag, offset, length, expected_offset, kit_length } => write!(
                f,
                "section {section} ({}) at offset {offset}, {length} bytes: it must begin at {expected_offset}, be a multiple of 4 bytes long and end within the kit's {kit_length}, and the last section must end there",
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
                write!(f, "{found} sections {}: there must be exactly one", Tag(tag))
            }
            Self::LengthMismatch { place, expected, found } => {
                write!(f, "{place}: its head announces {expected} bytes, the section has {found}")
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
                super::range::BAND_WIDTH_HZ
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
            Self::BadText { place } => write!(f, "{place}: source or licence is not UTF-8"),
            Self::NotZero { place, field } => write!(f, "{place}: {} must be zero", field.key()),
        }
    }
}

impl core::error::Error for TableError {}
