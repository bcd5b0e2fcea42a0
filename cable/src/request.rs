//! Requests of a computer to a board.

use crate::refusal::Refusal;
use crate::setting::{Key, SETTINGS_VERSION, Value};
use crate::store::HEADER_BYTES;
use crate::wire::{Message, Payload};

/// Most bytes of a kit in one message.
pub const CHUNK_BYTES: usize = 240;

/// Numbers of the requests on the wire. An answer has the number of its request, and
/// [`ANSWER`](code::ANSWER).
pub(crate) mod code {
    pub(crate) const IDENTITY: u8 = 0x01;
    pub(crate) const SLOT: u8 = 0x02;
    pub(crate) const READ: u8 = 0x03;
    pub(crate) const BEGIN: u8 = 0x04;
    pub(crate) const CHUNK: u8 = 0x05;
    pub(crate) const END: u8 = 0x06;
    pub(crate) const STATUS: u8 = 0x07;
    pub(crate) const ABANDON: u8 = 0x08;
    pub(crate) const ERASE: u8 = 0x09;
    pub(crate) const GET: u8 = 0x0A;
    pub(crate) const SET: u8 = 0x0B;
    pub(crate) const START: u8 = 0x0C;
    pub(crate) const ENTER_DFU: u8 = 0x0D;
    /// Bit of an answer.
    pub(crate) const ANSWER: u8 = 0x40;
    /// Answer that asks for time.
    pub(crate) const WORKING: u8 = 0x7E;
    /// Answer that refuses.
    pub(crate) const REFUSED: u8 = 0x7F;
}

/// Slot number on the wire that stands for the built-in kit.
pub(crate) const BUILT_IN: u8 = 0xFF;

/// Request of a computer to a board.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Request<'a> {
    /// Asks for the names and the rate of the board.
    Identity,
    /// Asks for a slot's content.
    Slot {
        /// Slot, counted from 0.
        slot: u8,
    },
    /// Asks for [`CHUNK_BYTES`] bytes of a slot's flash.
    Read {
        /// Slot, counted from 0.
        slot: u8,
        /// Offset of the first byte.
        offset: u32,
    },
    /// Begins an upload, or asks how far the upload of this session is.
    Begin {
        /// Session of the upload; any number that other uploads do not use.
        session: u32,
        /// Slot to write, counted from 0.
        slot: u8,
        /// First bytes of the kit. The board writes them last.
        header: [u8; HEADER_BYTES],
    },
    /// Writes a part of the kit.
    Chunk {
        /// Session of the upload.
        session: u32,
        /// Number of the chunk, counted from 0.
        number: u16,
        /// Bytes of the kit from [`HEADER_BYTES`] + [`CHUNK_BYTES`] · `number` on:
        /// [`CHUNK_BYTES`] of them, fewer in the last chunk.
        bytes: &'a [u8],
    },
    /// Ends an upload: the board checks the kit.
    End {
        /// Session of the upload.
        session: u32,
    },
    /// Asks which upload is under way.
    Status,
    /// Ends the upload under way without a kit.
    Abandon,
    /// Erases a slot.
    Erase {
        /// Slot, counted from 0.
        slot: u8,
    },
    /// Asks for a setting.
    Get {
        /// Name of the setting.
        key: Key,
    },
    /// Sets a setting.
    Set {
        /// Name of the setting.
        key: Key,
        /// Value of the setting; `None` removes it.
        value: Option<Value>,
    },
    /// Plays a kit.
    Start {
        /// Slot, counted from 0; `None` for the built-in kit.
        slot: Option<u8>,
    },
    /// Restarts the board in the bootloader of its ROM.
    EnterDfu,
}

impl<'a> Request<'a> {
    /// Number of the request on the wire.
    pub const fn command(&self) -> u8 {
        match self {
            Self::Identity => code::IDENTITY,
            Self::Slot { .. } => code::SLOT,
            Self::Read { .. } => code::READ,
            Self::Begin { .. } => code::BEGIN,
            Self::Chunk { .. } => code::CHUNK,
            Self::End { .. } => code::END,
            Self::Status => code::STATUS,
            Self::Abandon => code::ABANDON,
            Self::Erase { .. } => code::ERASE,
            Self::Get { .. } => code::GET,
            Self::Set { .. } => code::SET,
            Self::Start { .. } => code::START,
            Self::EnterDfu => code::ENTER_DFU,
        }
    }

    /// Writes the request as a message with a tag from 0 to 127.
    pub fn write(&self, tag: u8, message: &mut Message) {
        message.begin(self.command(), tag);
        match *self {
            Self::Identity | Self::Status | Self::Abandon | Self::EnterDfu => {}
            Self::Slot { slot } | Self::Erase { slot } => message.put(&[slot]),
            Self::Read { slot, offset } => {
                message.put(&[slot]);
                message.put(&offset.to_le_bytes());
            }
            Self::Begin { session, slot, header } => {
                message.put(&session.to_le_bytes());
                message.put(&[slot]);
                message.put(&header);
            }
            Self::Chunk { session, number, bytes } => {
                message.put(&session.to_le_bytes());
                message.put(&number.to_le_bytes());
                message.put(bytes);
            }
            Self::End { session } => message.put(&session.to_le_bytes()),
            Self::Get { key } => write_key(key, message),
            Self::Set { key, value } => {
                write_key(key, message);
                if let Some(value) = value {
                    message.put(&value.bits().to_le_bytes());
                }
            }
            Self::Start { slot } => message.put(&[slot.unwrap_or(BUILT_IN)]),
        }
        message.end();
    }

    /// Reads a request from a message's command and payload.
    ///
    /// # Errors
    /// A [`Refusal`] if the command or the setting is unknown, or the payload does not fit.
    pub fn read(command: u8, payload: &'a [u8]) -> Result<Self, Refusal> {
        let mut payload = Payload(payload);
        let request = match command {
            code::IDENTITY => Some(Self::Identity),
            code::SLOT => payload.u8().map(|slot| Self::Slot { slot }),
            code::READ => payload.u8().zip(payload.u32()).map(|(slot, offset)| Self::Read { slot, offset }),
            code::BEGIN => read_begin(&mut payload),
            code::CHUNK => read_chunk(&mut payload),
            code::END => payload.u32().map(|session| Self::End { session }),
            code::STATUS => Some(Self::Status),
            code::ABANDON => Some(Self::Abandon),
            code::ERASE => payload.u8().map(|slot| Self::Erase { slot }),
            code::GET => Some(Self::Get { key: read_key(&mut payload)? }),
            code::SET => Some(read_set(&mut payload)?),
            code::START => payload.u8().map(|slot| Self::Start { slot: (slot != BUILT_IN).then_some(slot) }),
            code::ENTER_DFU => Some(Self::EnterDfu),
            _ => return Err(Refusal::UnknownCommand { command }),
        };
        request.filter(|_| payload.is_over()).ok_or(Refusal::BadMessage)
    }
}

fn read_begin<'a>(payload: &mut Payload<'a>) -> Option<Request<'a>> {
    Some(Request::Begin { session: payload.u32()?, slot: payload.u8()?, header: payload.array()? })
}

fn read_chunk<'a>(payload: &mut Payload<'a>) -> Option<Request<'a>> {
    Some(Request::Chunk { session: payload.u32()?, number: payload.u16()?, bytes: payload.rest() })
}

fn read_set<'a>(payload: &mut Payload<'a>) -> Result<Request<'a>, Refusal> {
    let key = read_key(payload)?;
    if payload.is_over() {
        return Ok(Request::Set { key, value: None });
    }
    let bits = payload.u32().ok_or(Refusal::BadMessage)?;
    let value = key.value(bits).ok_or(Refusal::SettingRange { key: key.parts().0 })?;
    Ok(Request::Set { key, value: Some(value) })
}

/// Writes the version of the settings, the number of one, and its piezo.
pub(crate) fn write_key(key: Key, message: &mut Message) {
    let (number, piezo) = key.parts();
    message.put(&[SETTINGS_VERSION, number, piezo]);
}

/// Reads the version of the settings, the number of one, and its piezo.
pub(crate) fn read_key(payload: &mut Payload<'_>) -> Result<Key, Refusal> {
    let [version, number, piezo] = payload.array().ok_or(Refusal::BadMessage)?;
    match version {
        SETTINGS_VERSION => Key::from_parts(number, piezo).ok_or(Refusal::UnknownSetting { key: number }),
        found => Err(Refusal::NewerSettings { found }),
    }
}
