//! A cable in memory between a task of the computer and a board.

use std::collections::VecDeque;

use cable::{Answer, Device, Exchange, HostError, Link, Message, Outcome, Query, Request, Task, converse};

use crate::board::TestBoard;

/// Failure of the cable in memory.
#[derive(Debug, PartialEq, Eq)]
pub(crate) enum WireError {
    /// The cable was pulled.
    Unplugged,
    Host(HostError),
}

impl From<HostError> for WireError {
    fn from(error: HostError) -> Self {
        Self::Host(error)
    }
}

/// Shares of messages, in percent, that are damaged in one of several ways.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Damage {
    pub(crate) dropped: u64,
    pub(crate) doubled: u64,
    pub(crate) cut: u64,
    pub(crate) altered: u64,
    /// Share of messages with real-time bytes inside and a note before them.
    pub(crate) interleaved: u64,
}

/// Cable with a board at its end. Time passes only while the computer waits.
pub(crate) struct Wire {
    pub(crate) device: Device,
    pub(crate) board: TestBoard,
    pub(crate) damage: Damage,
    /// Number of messages that the computer can still send before the cable is pulled.
    pub(crate) sends_left: usize,
    /// Number of messages that the computer has sent.
    pub(crate) sent: usize,
    random: u64,
    now_ms: u64,
    inbox: VecDeque<u8>,
}

impl Wire {
    pub(crate) fn new(board: TestBoard) -> Self {
        Self {
            device: Device::new(),
            board,
            damage: Damage::default(),
            sends_left: usize::MAX,
            sent: 0,
            random: 0,
            now_ms: 0,
            inbox: VecDeque::new(),
        }
    }

    pub(crate) fn damaged(board: TestBoard, damage: Damage, seed: u64) -> Self {
        Self { damage, random: seed, ..Self::new(board) }
    }

    /// Carries out a task.
    pub(crate) fn carry_out(&mut self, task: &mut impl Task) -> Result<(), WireError> {
        // A new program has a tag of its own.
        let tag = self.random(128) as u8;
        converse(self, &mut Exchange::new(tag), task, |_| {})
    }

    /// Answer to a request.
    pub(crate) fn ask(&mut self, request: Request<'_>) -> Result<Answer<'static>, WireError> {
        let mut query = Query::new(request);
        self.carry_out(&mut query)?;
        Ok(query.answer().expect("the answer to a query has no borrowed bytes"))
    }

    /// Random number below a limit (splitmix64).
    pub(crate) fn random(&mut self, limit: u64) -> u64 {
        self.random = self.random.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.random;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        (z ^ (z >> 31)) % limit
    }

    /// Bytes that arrive for a message that is sent.
    fn arriving(&mut self, message: &[u8]) -> Vec<u8> {
        let Damage { dropped, doubled, cut, altered, interleaved } = self.damage;
        let mut bytes = message.to_vec();
        if self.random(100) < dropped {
            return Vec::new();
        }
        if self.random(100) < cut {
            bytes.truncate(self.random(message.len() as u64) as usize);
        }
        if self.random(100) < altered && bytes.len() > 1 {
            let place = 1 + self.random(bytes.len() as u64 - 1) as usize;
            bytes[place] ^= 1 << self.random(8);
        }
        if self.random(100) < doubled {
            bytes.extend_from_within(..);
        }
        if self.random(100) < interleaved {
            for _ in 0..3 {
                let place = self.random(bytes.len() as u64 + 1) as usize;
                bytes.insert(place, 0xF8 + self.random(8) as u8);
            }
            bytes.splice(0..0, [0x90, 60, 100]);
        }
        bytes
    }

    fn hear(&mut self, outcome: Outcome, answer: &Message) {
        if outcome != Outcome::Nothing {
            let bytes = self.arriving(answer.bytes());
            self.inbox.extend(bytes);
        }
    }
}

impl Link for Wire {
    type Error = WireError;

    fn send(&mut self, message: &[u8]) -> Result<(), WireError> {
        self.sends_left = self.sends_left.checked_sub(1).ok_or(WireError::Unplugged)?;
        self.sent += 1;
        let mut answer = Message::new();
        for byte in self.arriving(message) {
            let outcome = self.device.receive(byte, &mut self.board, &mut answer);
            self.hear(outcome, &answer);
            if self.device.job().is_some() {
                let outcome = self.device.work(&mut self.board, &mut answer);
                self.hear(outcome, &answer);
            }
        }
        Ok(())
    }

    fn receive(&mut self, until_ms: u64) -> Result<Option<u8>, WireError> {
        let byte = self.inbox.pop_front();
        if byte.is_none() {
            self.now_ms = self.now_ms.max(until_ms);
        }
        Ok(byte)
    }

    fn now_ms(&mut self) -> u64 {
        self.now_ms
    }
}
