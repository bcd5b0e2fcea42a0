//! Reasons for which a board refuses a request.

use core::fmt;

use dsp_core::engine::LoadError;
use dsp_core::table::TableError;
use dsp_core::table::layout::FORMAT_VERSION;

/// Reason for which a board refuses a request. The kit that plays goes on playing.
///
/// On the wire a refusal is a code and two details ([`Refusal::parts`]); its sentence is made by
/// the reader.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Refusal {
    /// The message's checksum does not fit its bytes.
    DamagedMessage,
    /// Another message began, or a status byte came, before the message's end.
    CutMessage,
    /// The message is longer than [`MESSAGE_BYTES`](crate::MESSAGE_BYTES).
    LongMessage,
    /// The message is of another version of the protocol.
    OtherProtocol {
        /// Version of the message.
        found: u8,
    },
    /// The board does not know the command.
    UnknownCommand {
        /// Number of the command.
        command: u8,
    },
    /// The message is too short or too long for its command, or a field has no meaning.
    BadMessage,
    /// The board works on the last request and has not answered it yet.
    Working,
    /// The board does not have the slot.
    NoSuchSlot {
        /// Slot of the request, counted from 0.
        slot: u8,
        /// Number of slots of the board.
        slots: u8,
    },
    /// The slot holds no kit.
    EmptySlot {
        /// Slot of the request, counted from 0.
        slot: u8,
    },
    /// Another upload is under way.
    WriteUnderWay {
        /// Session of the upload under way.
        session: u32,
        /// Slot that the upload under way writes.
        slot: u8,
    },
    /// No upload of the request's session is under way.
    NoUpload,
    /// A chunk comes before the one that the board waits for.
    ChunkOutOfOrder {
        /// Number of the chunk that came.
        found: u32,
        /// Number of the chunk that the board waits for.
        expected: u32,
    },
    /// A chunk that is written already comes again, and is not the last one written.
    ChunkTwice {
        /// Number of the chunk that came.
        found: u32,
        /// Number of the chunk that the board waits for.
        expected: u32,
    },
    /// The upload was ended before its last chunk.
    ChunksMissing {
        /// Number of the chunk that the board waits for.
        expected: u32,
        /// Number of chunks of the upload.
        chunks: u32,
    },
    /// The bytes are no kit, or break a rule of the kit format.
    NotAKit,
    /// The kit, or a section of it, has a version that the firmware does not know.
    NewerKit {
        /// Version of the kit or of its section.
        found: u32,
        /// Newest version of a kit that the firmware knows.
        newest: u32,
    },
    /// The kit is longer than the slot.
    TooLong {
        /// Length of the kit in bytes.
        length: u32,
        /// Capacity of the slot in bytes.
        capacity: u32,
    },
    /// The checksum in the kit's header does not fit the bytes in the slot.
    WrongCrc {
        /// CRC-32 in the kit's header.
        stored: u32,
        /// CRC-32 of the bytes in the slot.
        computed: u32,
    },
    /// The board has no memory for the kit's modes, or the kit has too many pads for it.
    NotLoadable,
    /// The flash reports an error, or does not read back as it was written.
    Flash {
        /// Offset in bytes from the beginning of the slot or of the settings.
        offset: u32,
    },
    /// The board does not know the setting.
    UnknownSetting {
        /// Number of the setting.
        key: u8,
    },
    /// The board does not know the version of the settings.
    NewerSettings {
        /// Version of the request.
        found: u8,
    },
    /// The value of a setting is outside its range, or the board does not have the setting's input.
    SettingRange {
        /// Number of the setting.
        key: u8,
    },
}

impl Refusal {
    /// Code and details of the refusal on the wire.
    pub const fn parts(self) -> (u8, u32, u32) {
        match self {
            Self::DamagedMessage => (1, 0, 0),
            Self::CutMessage => (2, 0, 0),
            Self::LongMessage => (3, 0, 0),
            Self::OtherProtocol { found } => (4, found as u32, 0),
            Self::UnknownCommand { command } => (5, command as u32, 0),
            Self::BadMessage => (6, 0, 0),
            Self::Working => (7, 0, 0),
            Self::NoSuchSlot { slot, slots } => (8, slot as u32, slots as u32),
            Self::EmptySlot { slot } => (9, slot as u32, 0),
            Self::WriteUnderWay { session, slot } => (10, session, slot as u32),
            Self::NoUpload => (11, 0, 0),
            Self::ChunkOutOfOrder { found, expected } => (12, found, expected),
            Self::ChunkTwice { found, expected } => (13, found, expected),
            Self::ChunksMissing { expected, chunks } => (14, expected, chunks),
            Self::NotAKit => (15, 0, 0),
            Self::NewerKit { found, newest } => (16, found, newest),
            Self::TooLong { length, capacity } => (17, length, capacity),
            Self::WrongCrc { stored, computed } => (18, stored, computed),
            Self::NotLoadable => (19, 0, 0),
            Self::Flash { offset } => (20, offset, 0),
            Self::UnknownSetting { key } => (21, key as u32, 0),
            Self::NewerSettings { found } => (22, found as u32, 0),
            Self::SettingRange { key } => (23, key as u32, 0),
        }
    }

    /// Refusal of a code and its details; `None` for a code that this side does not know.
    pub const fn from_parts(code: u8, first: u32, second: u32) -> Option<Self> {
        Some(match code {
            1 => Self::DamagedMessage,
            2 => Self::CutMessage,
            3 => Self::LongMessage,
            4 => Self::OtherProtocol { found: first as u8 },
            5 => Self::UnknownCommand { command: first as u8 },
            6 => Self::BadMessage,
            7 => Self::Working,
            8 => Self::NoSuchSlot { slot: first as u8, slots: second as u8 },
            9 => Self::EmptySlot { slot: first as u8 },
            10 => Self::WriteUnderWay { session: first, slot: second as u8 },
            11 => Self::NoUpload,
            12 => Self::ChunkOutOfOrder { found: first, expected: second },
            13 => Self::ChunkTwice { found: first, expected: second },
            14 => Self::ChunksMissing { expected: first, chunks: second },
            15 => Self::NotAKit,
            16 => Self::NewerKit { found: first, newest: second },
            17 => Self::TooLong { length: first, capacity: second },
            18 => Self::WrongCrc { stored: first, computed: second },
            19 => Self::NotLoadable,
            20 => Self::Flash { offset: first },
            21 => Self::UnknownSetting { key: first as u8 },
            22 => Self::NewerSettings { found: first as u8 },
            23 => Self::SettingRange { key: first as u8 },
            _ => return None,
        })
    }
}

impl From<TableError> for Refusal {
    fn from(error: TableError) -> Self {
        match error {
            TableError::NewerVersion { found } | TableError::NewerSection { found, .. } => {
                Self::NewerKit { found, newest: FORMAT_VERSION }
            }
            TableError::WrongCrc { stored, computed } => Self::WrongCrc { stored, computed },
            _ => Self::NotAKit,
        }
    }
}

impl From<LoadError> for Refusal {
    fn from(_: LoadError) -> Self {
        Self::NotLoadable
    }
}

impl fmt::Display for Refusal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::DamagedMessage => {
                write!(f, "a message arrived damaged: try again, with another cable if it stays so")
            }
            Self::CutMessage => {
                write!(f, "a message arrived without its end: close other programs that play the board")
            }
            Self::LongMessage => write!(f, "a message is longer than the board takes: update malleus"),
            Self::OtherProtocol { found } => write!(
                f,
                "the board does not know version {found} of the protocol: use a malleus and a firmware of the same release"
            ),
            Self::UnknownCommand { command } => {
                write!(f, "the board's firmware does not know command {command}: update the firmware")
            }
            Self::BadMessage => {
                write!(f, "the board does not understand a message: use a malleus and a firmware of the same release")
            }
            Self::Working => write!(f, "the board still works on the last request: try again in some seconds"),
            Self::NoSuchSlot { slot, slots } => {
                write!(f, "there is no slot {slot}: the board has {slots}, counted from 0")
            }
            Self::EmptySlot { slot } => write!(f, "slot {slot} holds no kit: send one first"),
            Self::WriteUnderWay { session, slot } => write!(
                f,
                "another upload (session {session:08x}) writes slot {slot}: wait until it ends, or end it with --abandon if its program is gone"
            ),
            Self::NoUpload => write!(f, "the board knows nothing of this upload, as after a reset: begin it anew"),
            Self::ChunkOutOfOrder { found, expected } => {
                write!(f, "chunk {found} came out of order: the board waits for chunk {expected}")
            }
            Self::ChunkTwice { found, expected } => {
                write!(f, "chunk {found} came twice: the board waits for chunk {expected}")
            }
            Self::ChunksMissing { expected, chunks } => {
                write!(
                    f,
                    "the upload was ended too early: chunk {expected} and those behind it are missing, of {chunks} in all"
                )
            }
            Self::NotAKit => write!(f, "the bytes are not a kit: build it anew with malleus kit build"),
            Self::NewerKit { found, newest } => write!(
                f,
                "the kit is too new: a part of it has version {found}, and the firmware knows kits up to version {newest}: update the firmware"
            ),
            Self::TooLong { length, capacity } => {
                write!(f, "the kit is too long: it has {length} bytes, and the slot {capacity}")
            }
            Self::WrongCrc { stored, computed } => write!(
                f,
                "the kit in the slot is damaged: its checksum is {computed:08x} instead of {stored:08x}: send it again"
            ),
            Self::NotLoadable => write!(f, "the board cannot load the kit: malleus kit check --board says why"),
            Self::Flash { offset } => write!(
                f,
                "the board's flash failed at byte {offset}: send it again, and use another slot if it fails there again"
            ),
            Self::UnknownSetting { key } => {
                write!(f, "the board's firmware does not know setting {key}: update the firmware")
            }
            Self::NewerSettings { found } => {
                write!(f, "the board's firmware does not know settings of version {found}: update the firmware")
            }
            Self::SettingRange { key } => {
                write!(f, "the value of setting {key} is outside its range, or the board does not have that input")
            }
        }
    }
}

impl core::error::Error for Refusal {}
