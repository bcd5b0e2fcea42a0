//! The board's end of the cable.

mod upload;

use crate::answer::{Answer, LeftOuts};
use crate::refusal::Refusal;
use crate::request::{CHUNK_BYTES, Request, code};
use crate::setting::{Key, Value};
use crate::store::{Content, HEADER_BYTES, Job, Store};
use crate::wire::{Heard, Message, Receiver};
use upload::Upload;

/// Result of one more byte, or of a job.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Outcome {
    /// Nothing is to be sent.
    Nothing,
    /// The message holds an answer to send.
    Answered,
    /// The message holds an answer to send, which refuses a request.
    Refused(Refusal),
}

/// Board's end of the cable: takes the bytes of the cable and gives the answers to send.
///
/// ```text
/// for byte in packet {
///     if device.receive(byte, &mut store, &mut message) != Outcome::Nothing {
///         send(message.bytes())
///     }
///     if let Some(job) = device.job() {
///         // fade the sound for a job that stalls the core, feed the watchdog
///         if device.work(&mut store, &mut message) != Outcome::Nothing {
///             send(message.bytes())
///         }
///     }
/// }
/// ```
///
/// On a board it takes 408 bytes of memory, and the caller's [`Message`] 304.
pub struct Device {
    receiver: Receiver,
    waiting: Option<Waiting>,
    upload: Option<Upload>,
    /// Upload that ended with a kit in the slot. The computer that did not hear so asks again.
    finished: Option<Upload>,
}

/// Request that waits for [`Device::work`].
#[derive(Clone, Copy)]
struct Waiting {
    command: u8,
    tag: u8,
    deed: Deed,
}

/// Request that takes long.
#[derive(Clone, Copy)]
enum Deed {
    Prepare(Upload),
    Finish(Upload),
    Erase(u8),
    Set(Key, Option<Value>),
    Start(Option<u8>),
    EnterDfu,
}

impl Deed {
    fn job(&self) -> Job {
        match *self {
            Self::Prepare(upload) => Job::Prepare(upload.slot),
            Self::Finish(upload) => Job::Finish(upload.slot),
            Self::Erase(slot) => Job::Erase(slot),
            Self::Set(key, _) => Job::Set(key),
            Self::Start(slot) => Job::Start(slot),
            Self::EnterDfu => Job::EnterDfu,
        }
    }
}

/// Answer to a request, or the request if it takes long.
enum Reply<'a> {
    Now(Answer<'a>),
    Later(Deed),
}

impl Device {
    /// Makes the end of a cable on which nothing has come yet.
    pub const fn new() -> Self {
        Self { receiver: Receiver::new(), waiting: None, upload: None, finished: None }
    }

    /// Takes one byte of the cable. Other MIDI messages and other SysEx are passed over.
    ///
    /// If a job then waits, [`work`](Self::work) must be called before more bytes come. The answer
    /// that is in `message` by then asks the computer to wait.
    pub fn receive<S: Store>(&mut self, byte: u8, store: &mut S, message: &mut Message) -> Outcome {
        let (command, tag, request) = match self.receiver.receive(byte) {
            Heard::Nothing => return Outcome::Nothing,
            // A board does not answer answers: its own might come back to it.
            Heard::Message(frame) if frame.command & code::ANSWER != 0 => return Outcome::Nothing,
            Heard::Broken { command, .. } if command & code::ANSWER != 0 => return Outcome::Nothing,
            Heard::Broken { command, tag, refusal } => (command, tag, Err(refusal)),
            Heard::Message(frame) => (frame.command, frame.tag, Request::read(frame.command, frame.payload)),
        };
        let refuse = |refusal, message: &mut Message| {
            Answer::Refused(refusal).write(command, tag, message);
            Outcome::Refused(refusal)
        };
        let request = match request {
            _ if self.waiting.is_some() => return refuse(Refusal::Working, message),
            Ok(request) => request,
            Err(refusal) => return refuse(refusal, message),
        };
        match serve(&mut self.upload, self.finished, request, store) {
            Ok(Reply::Now(answer)) => answer.write(command, tag, message),
            Ok(Reply::Later(deed)) => {
                self.waiting = Some(Waiting { command, tag, deed });
                match deed {
                    // The board will not be there to answer.
                    Deed::EnterDfu => Answer::Done,
                    _ => Answer::Working { ms: store.longest_ms(deed.job()) },
                }
                .write(command, tag, message);
            }
            Err(refusal) => return refuse(refusal, message),
        }
        Outcome::Answered
    }

    /// Job that waits for [`work`](Self::work).
    pub fn job(&self) -> Option<Job> {
        self.waiting.map(|waiting| waiting.deed.job())
    }

    /// Does the job that waits, if any.
    pub fn work<S: Store>(&mut self, store: &mut S, message: &mut Message) -> Outcome {
        message.clear();
        let Some(Waiting { command, tag, deed }) = self.waiting.take() else { return Outcome::Nothing };
        let (answer, outcome) = match self.carry_out(deed, store) {
            _ if matches!(deed, Deed::EnterDfu) => return Outcome::Nothing,
            Ok(answer) => (answer, Outcome::Answered),
            Err(refusal) => (Answer::Refused(refusal), Outcome::Refused(refusal)),
        };
        answer.write(command, tag, message);
        outcome
    }

    /// Drops the message under way, such as after the cable was unplugged. An upload stays, and the
    /// computer can go on with it.
    pub fn reset_wire(&mut self) {
        self.receiver.reset();
    }

    fn carry_out<S: Store>(&mut self, deed: Deed, store: &mut S) -> Result<Answer<'static>, Refusal> {
        match deed {
            Deed::Prepare(upload) => {
                self.finished = None;
                store.prepare(upload.slot)?;
                self.upload = Some(upload);
                return Ok(Answer::Upload(Some(upload.progress())));
            }
            Deed::Finish(upload) => {
                self.upload = None;
                upload.finish(store)?;
                self.finished = Some(upload);
            }
            Deed::Erase(slot) => {
                self.finished = self.finished.filter(|upload| upload.slot != slot);
                store.erase(slot)?;
            }
            Deed::Set(key, value) => store.set(key, value)?,
            Deed::Start(None) => store.start(None)?,
            Deed::Start(Some(slot)) => match store.content(store.bytes(slot).unwrap_or_default(), &mut |_| {}) {
                Content::Kit { .. } => store.start(Some(slot))?,
                Content::Refused(refusal) => return Err(refusal),
                Content::Empty | Content::Unfinished => return Err(Refusal::EmptySlot { slot }),
            },
            Deed::EnterDfu => store.enter_dfu(),
        }
        Ok(Answer::Done)
    }
}

impl Default for Device {
    fn default() -> Self {
        Self::new()
    }
}

fn serve<'s, S: Store>(
    upload: &mut Option<Upload>,
    finished: Option<Upload>,
    request: Request<'_>,
    store: &'s mut S,
) -> Result<Reply<'s>, Refusal> {
    let slots = store.slots();
    let capacity = |slot, store: &S| store.bytes(slot).map(<[u8]>::len).ok_or(Refusal::NoSuchSlot { slot, slots });
    Ok(Reply::Now(match request {
        Request::Identity => Answer::Identity { identity: store.identity(), slots, playing: store.playing() },
        Request::Slot { slot } => {
            let capacity = capacity(slot, store)? as u32;
            let mut left_out = LeftOuts::new();
            let bytes = store.bytes(slot).unwrap_or_default();
            let content = store.content(bytes, &mut |stage| left_out.push(stage));
            Answer::Slot { slot, capacity, content, left_out }
        }
        Request::Read { slot, offset } => {
            let bytes = store.bytes(slot).ok_or(Refusal::NoSuchSlot { slot, slots })?;
            let bytes = bytes.get(offset as usize..).unwrap_or_default();
            Answer::Bytes { slot, offset, bytes: bytes.get(..CHUNK_BYTES).unwrap_or(bytes) }
        }
        Request::Begin { session, slot, header } => {
            let capacity = capacity(slot, store)?;
            return begin((*upload, finished), (session, slot, header), capacity);
        }
        Request::Chunk { session, number, bytes } => {
            let mine = upload.as_mut().filter(|upload| upload.session == session);
            let written = mine.ok_or(Refusal::NoUpload)?.write(number, bytes, store);
            if let Err(Refusal::Flash { .. }) = written {
                *upload = None;
            }
            written?
        }
        Request::End { session } => {
            if finished.is_some_and(|upload| upload.session == session) {
                return Ok(Reply::Now(Answer::Done));
            }
            let upload = upload.filter(|upload| upload.session == session).ok_or(Refusal::NoUpload)?;
            upload.check_whole()?;
            return Ok(Reply::Later(Deed::Finish(upload)));
        }
        Request::Status => Answer::Upload(upload.map(|upload| upload.progress())),
        Request::Abandon => {
            *upload = None;
            Answer::Upload(None)
        }
        Request::Erase { slot } => {
            capacity(slot, store)?;
            match *upload {
                Some(Upload { session, slot: taken, .. }) if taken == slot => {
                    return Err(Refusal::WriteUnderWay { session, slot });
                }
                _ => return Ok(Reply::Later(Deed::Erase(slot))),
            }
        }
        Request::Get { key } => Answer::Setting { key, value: store.setting(key)? },
        Request::Set { key, value } => return Ok(Reply::Later(Deed::Set(key, value))),
        Request::Start { slot } => {
            slot.map_or(Ok(0), |slot| capacity(slot, store))?;
            return Ok(Reply::Later(Deed::Start(slot)));
        }
        Request::EnterDfu => return Ok(Reply::Later(Deed::EnterDfu)),
    }))
}

fn begin(
    (under_way, finished): (Option<Upload>, Option<Upload>),
    (session, slot, header): (u32, u8, [u8; HEADER_BYTES]),
    capacity: usize,
) -> Result<Reply<'static>, Refusal> {
    let asked = |upload: &Upload| upload.is(session, slot, &header);
    match under_way {
        Some(upload) if !asked(&upload) => Err(Refusal::WriteUnderWay { session: upload.session, slot: upload.slot }),
        // The computer did not hear the answer, or comes back after a break.
        _ => match under_way.or(finished.filter(asked)) {
            Some(upload) => Ok(Reply::Now(Answer::Upload(Some(upload.progress())))),
            None => Upload::begin(session, slot, header, capacity).map(|upload| Reply::Later(Deed::Prepare(upload))),
        },
    }
}
