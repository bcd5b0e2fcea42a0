//! The computer's patience: lost answers, boards that work, and streams of other bytes.

use cable::{
    Answer, CHUNK_BYTES, Exchange, HEADER_BYTES, HostError, Link, Message, Next, Progress, Query, Request, Task, Turn,
    Upload, converse,
};

use crate::uploads::{demo, session_of};

/// Cable on which nothing comes but clock bytes, one each millisecond, or nothing at all.
struct Deaf {
    has_clock: bool,
    now_ms: u64,
    sent: usize,
}

impl Link for Deaf {
    type Error = HostError;

    fn send(&mut self, _message: &[u8]) -> Result<(), HostError> {
        self.sent += 1;
        Ok(())
    }

    fn receive(&mut self, until_ms: u64) -> Result<Option<u8>, HostError> {
        assert!(self.now_ms < 60_000, "the computer waits for ever");
        self.now_ms = if self.has_clock { self.now_ms + 1 } else { until_ms };
        Ok(self.has_clock.then_some(0xF8))
    }

    fn now_ms(&mut self) -> u64 {
        self.now_ms
    }
}

/// Gives an answer to an exchange.
fn hear(exchange: &mut Exchange, task: &mut impl Task, tag: u8, answer: &Answer<'_>) -> Result<Turn, HostError> {
    let mut message = Message::new();
    answer.write(task.request().command(), tag, &mut message);
    let (last, rest) = message.bytes().split_last().unwrap();
    for &byte in rest {
        assert_eq!(exchange.receive(byte, task), Ok(Turn::Listen));
    }
    exchange.receive(*last, task)
}

#[test]
fn computer_gives_up_a_silent_board_after_eight_tries_and_eight_seconds() {
    for has_clock in [false, true] {
        let mut link = Deaf { has_clock, now_ms: 0, sent: 0 };
        let ended = converse(&mut link, &mut Exchange::new(0), &mut Query::new(Request::Identity), |_| {});
        assert_eq!(ended, Err(HostError::NoAnswer), "clock: {has_clock}");
        assert_eq!((link.sent, link.now_ms), (8, 8000), "clock: {has_clock}");
    }
}

#[test]
fn computer_waits_as_long_as_the_board_asks_for() {
    let mut exchange = Exchange::new(3);
    let mut query = Query::new(Request::Erase { slot: 0 });
    let mut message = Message::new();
    exchange.ask(&query, &mut message);
    assert_eq!(exchange.wait_ms(), 1000);
    assert_eq!(hear(&mut exchange, &mut query, 3, &Answer::Working { ms: 2000 }), Ok(Turn::Wait));
    assert_eq!(exchange.wait_ms(), 3000);
    assert_eq!(hear(&mut exchange, &mut query, 3, &Answer::Done), Ok(Turn::Done));
}

#[test]
fn answers_with_other_tags_or_to_other_requests_are_passed_over() {
    let mut exchange = Exchange::new(3);
    let mut query = Query::new(Request::Erase { slot: 0 });
    assert_eq!(hear(&mut exchange, &mut query, 2, &Answer::Done), Ok(Turn::Listen));
    let mut message = Message::new();
    Answer::Upload(None).write(Request::Status.command(), 3, &mut message);
    for &byte in message.bytes() {
        assert_eq!(exchange.receive(byte, &mut query), Ok(Turn::Listen));
    }
    // The request itself may come back from a board with a loop.
    query.request().write(3, &mut message);
    for &byte in message.bytes() {
        assert_eq!(exchange.receive(byte, &mut query), Ok(Turn::Listen));
    }
}

#[test]
fn acknowledgement_of_other_bytes_than_those_sent_ends_the_upload() {
    let kit = demo();
    let begun = |upload: &mut Upload<'_>| {
        let session = session_of(upload);
        upload.answer(Answer::Upload(Some(Progress { session, slot: 0, next: 0, chunks: 38 })))
    };
    let crc = dsp_core::table::checksum(&kit[HEADER_BYTES..][..CHUNK_BYTES]);
    for (answer, expected) in [
        (Answer::Written { number: 0, crc }, Ok(Next::Ask)),
        (Answer::Written { number: 0, crc: crc ^ 1 }, Err(HostError::BadAnswer)),
        (Answer::Written { number: 1, crc }, Err(HostError::BadAnswer)),
        (Answer::Done, Err(HostError::BadAnswer)),
    ] {
        let mut upload = Upload::new(&kit, 0).unwrap();
        assert_eq!(begun(&mut upload), Ok(Next::Ask));
        assert_eq!(upload.answer(answer), expected, "{answer:?}");
    }
}
