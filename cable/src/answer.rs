//! Answers of a board to a computer.

use dsp_core::SampleRate;

use crate::left_out::LeftOut;
use crate::refusal::Refusal;
use crate::request::{BUILT_IN, code, read_key, write_key};
use crate::setting::{Key, Value};
use crate::store::{Content, Identity};
use crate::text::Text;
use crate::wire::{Message, Payload};

/// Stages that a board leaves out of a kit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LeftOuts {
    bytes: [[u8; LeftOut::BYTES]; Self::MOST],
    count: usize,
}

impl LeftOuts {
    /// Most stages that one answer names: three of each of 16 pads, the background and the room.
    pub const MOST: usize = 50;

    /// Makes an empty list.
    pub const fn new() -> Self {
        Self { bytes: [[0; LeftOut::BYTES]; Self::MOST], count: 0 }
    }

    /// Adds a stage; one more than [`MOST`](Self::MOST) is dropped.
    pub fn push(&mut self, stage: LeftOut) {
        if let Some(place) = self.bytes.get_mut(self.count) {
            *place = stage.bytes();
            self.count += 1;
        }
    }

    /// Stages of the list.
    pub fn iter(&self) -> impl Iterator<Item = LeftOut> {
        self.bytes.iter().take(self.count).filter_map(|&bytes| LeftOut::from_bytes(bytes))
    }
}

impl Default for LeftOuts {
    fn default() -> Self {
        Self::new()
    }
}

/// Upload under way.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Progress {
    /// Session of the upload.
    pub session: u32,
    /// Slot that it writes, counted from 0.
    pub slot: u8,
    /// Number of the chunk that the board waits for; [`chunks`](Self::chunks) if it has all.
    pub next: u16,
    /// Number of chunks of the upload.
    pub chunks: u16,
}

/// Answer of a board to a computer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Answer<'a> {
    /// Answer to [`Request::Identity`](crate::Request::Identity).
    Identity {
        /// Names and rate of the board.
        identity: Identity,
        /// Number of slots.
        slots: u8,
        /// Slot whose kit plays; `None` for the built-in kit.
        playing: Option<u8>,
    },
    /// Answer to [`Request::Slot`](crate::Request::Slot).
    Slot {
        /// Slot, counted from 0.
        slot: u8,
        /// Capacity of the slot in bytes.
        capacity: u32,
        /// Content of the slot.
        content: Content,
        /// Stages of the kit that the board leaves out.
        left_out: LeftOuts,
    },
    /// Answer to [`Request::Read`](crate::Request::Read).
    Bytes {
        /// Slot, counted from 0.
        slot: u8,
        /// Offset of the first byte.
        offset: u32,
        /// Bytes of the slot's flash; fewer than asked for at the slot's end.
        bytes: &'a [u8],
    },
    /// Answer to [`Request::Begin`](crate::Request::Begin),
    /// [`Request::Status`](crate::Request::Status) and
    /// [`Request::Abandon`](crate::Request::Abandon): the upload under way.
    Upload(Option<Progress>),
    /// Answer to [`Request::Chunk`](crate::Request::Chunk): the chunk is in the flash.
    Written {
        /// Number of the chunk.
        number: u16,
        /// CRC-32 of the chunk's bytes.
        crc: u32,
    },
    /// Answer to [`Request::Get`](crate::Request::Get).
    Setting {
        /// Name of the setting.
        key: Key,
        /// Value of the setting; `None` if it is not set.
        value: Option<Value>,
    },
    /// Answer to [`Request::End`](crate::Request::End), [`Request::Erase`](crate::Request::Erase),
    /// [`Request::Set`](crate::Request::Set), [`Request::Start`](crate::Request::Start) and
    /// [`Request::EnterDfu`](crate::Request::EnterDfu).
    Done,
    /// Message before the answer: the board needs time.
    Working {
        /// Longest time until the answer, in milliseconds.
        ms: u16,
    },
    /// Answer that refuses the request.
    Refused(Refusal),
}

impl<'a> Answer<'a> {
    /// Writes the answer to a request of a command and a tag.
    pub fn write(&self, command: u8, tag: u8, message: &mut Message) {
        message.begin(
            match self {
                Self::Working { .. } => code::WORKING,
                Self::Refused(_) => code::REFUSED,
                _ => command | code::ANSWER,
            },
            tag,
        );
        match *self {
            Self::Identity { identity, slots, playing } => {
                for text in [identity.firmware, identity.revision, identity.board] {
                    message.put(text.bytes());
                }
                let (numerator, denominator) = identity.rate.ratio();
                message.put(&numerator.to_le_bytes());
                message.put(&denominator.to_le_bytes());
                message.put(&[slots, playing.unwrap_or(BUILT_IN)]);
            }
            Self::Slot { slot, capacity, content, ref left_out } => {
                message.put(&[slot]);
                message.put(&capacity.to_le_bytes());
                write_content(content, message);
                message.put(left_out.bytes.get(..left_out.count).unwrap_or_default().as_flattened());
            }
            Self::Bytes { slot, offset, bytes } => {
                message.put(&[slot]);
                message.put(&offset.to_le_bytes());
                message.put(bytes);
            }
            Self::Upload(None) | Self::Done => {}
            Self::Upload(Some(Progress { session, slot, next, chunks })) => {
                message.put(&session.to_le_bytes());
                message.put(&[slot]);
                message.put(&next.to_le_bytes());
                message.put(&chunks.to_le_bytes());
            }
            Self::Written { number, crc } => {
                message.put(&number.to_le_bytes());
                message.put(&crc.to_le_bytes());
            }
            Self::Setting { key, value } => {
                write_key(key, message);
                if let Some(value) = value {
                    message.put(&value.bits().to_le_bytes());
                }
            }
            Self::Working { ms } => message.put(&ms.to_le_bytes()),
            Self::Refused(refusal) => write_refusal(refusal, message),
        }
        message.end();
    }

    /// True if a message's command is an answer to a request's.
    pub(crate) fn is_to(command: u8, request: u8) -> bool {
        matches!(command, code::WORKING | code::REFUSED) || command == request | code::ANSWER
    }

    /// The answer without borrowed bytes; `None` for [`Answer::Bytes`].
    pub(crate) fn owned(self) -> Option<Answer<'static>> {
        Some(match self {
            Self::Bytes { .. } => return None,
            Self::Identity { identity, slots, playing } => Answer::Identity { identity, slots, playing },
            Self::Slot { slot, capacity, content, left_out } => Answer::Slot { slot, capacity, content, left_out },
            Self::Upload(progress) => Answer::Upload(progress),
            Self::Written { number, crc } => Answer::Written { number, crc },
            Self::Setting { key, value } => Answer::Setting { key, value },
            Self::Done => Answer::Done,
            Self::Working { ms } => Answer::Working { ms },
            Self::Refused(refusal) => Answer::Refused(refusal),
        })
    }

    /// Reads an answer from a message's command and payload; `None` if it has no meaning here.
    pub fn read(command: u8, payload: &'a [u8]) -> Option<Self> {
        let mut payload = Payload(payload);
        let answer = match command {
            code::WORKING => Self::Working { ms: payload.u16()? },
            code::REFUSED => Self::Refused(read_refusal(&mut payload)?),
            _ => match command ^ code::ANSWER {
                code::IDENTITY => read_identity(&mut payload)?,
                code::SLOT => read_slot(&mut payload)?,
                code::READ => Self::Bytes { slot: payload.u8()?, offset: payload.u32()?, bytes: payload.rest() },
                code::BEGIN | code::STATUS | code::ABANDON => Self::Upload(match payload.is_over() {
                    true => None,
                    false => Some(Progress {
                        session: payload.u32()?,
                        slot: payload.u8()?,
                        next: payload.u16()?,
                        chunks: payload.u16()?,
                    }),
                }),
                code::CHUNK => Self::Written { number: payload.u16()?, crc: payload.u32()? },
                code::GET => read_setting(&mut payload)?,
                code::END | code::ERASE | code::SET | code::START | code::ENTER_DFU => Self::Done,
                _ => return None,
            },
        };
        payload.is_over().then_some(answer)
    }
}

fn write_content(content: Content, message: &mut Message) {
    match content {
        Content::Empty => message.put(&[0]),
        Content::Unfinished => message.put(&[1]),
        Content::Kit { name, length, crc } => {
            message.put(&[2]);
            message.put(name.bytes());
            message.put(&length.to_le_bytes());
            message.put(&crc.to_le_bytes());
        }
        Content::Refused(refusal) => {
            message.put(&[3]);
            write_refusal(refusal, message);
        }
    }
}

fn read_content(payload: &mut Payload<'_>) -> Option<Content> {
    Some(match payload.u8()? {
        0 => Content::Empty,
        1 => Content::Unfinished,
        2 => Content::Kit { name: Text::from_bytes(payload.array()?)?, length: payload.u32()?, crc: payload.u32()? },
        3 => Content::Refused(read_refusal(payload)?),
        _ => return None,
    })
}

fn write_refusal(refusal: Refusal, message: &mut Message) {
    let (number, first, second) = refusal.parts();
    message.put(&[number]);
    message.put(&first.to_le_bytes());
    message.put(&second.to_le_bytes());
}

fn read_refusal(payload: &mut Payload<'_>) -> Option<Refusal> {
    Refusal::from_parts(payload.u8()?, payload.u32()?, payload.u32()?)
}

fn read_identity<'a>(payload: &mut Payload<'_>) -> Option<Answer<'a>> {
    let mut text = || Text::from_bytes(payload.array()?);
    let (firmware, revision, board) = (text()?, text()?, text()?);
    let rate = SampleRate::new(payload.u32()?, payload.u32()?)?;
    let (slots, playing) = (payload.u8()?, payload.u8()?);
    let playing = (playing != BUILT_IN).then_some(playing);
    Some(Answer::Identity { identity: Identity { firmware, revision, board, rate }, slots, playing })
}

fn read_slot<'a>(payload: &mut Payload<'_>) -> Option<Answer<'a>> {
    let (slot, capacity, content) = (payload.u8()?, payload.u32()?, read_content(payload)?);
    let mut left_out = LeftOuts::new();
    while !payload.is_over() {
        left_out.push(LeftOut::from_bytes(payload.array()?)?);
    }
    Some(Answer::Slot { slot, capacity, content, left_out })
}

fn read_setting<'a>(payload: &mut Payload<'_>) -> Option<Answer<'a>> {
    let key = read_key(payload).ok()?;
    let value = match payload.is_over() {
        true => None,
        false => Some(key.value(payload.u32()?)?),
    };
    Some(Answer::Setting { key, value })
}
