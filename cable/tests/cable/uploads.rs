//! Uploads and downloads: whole, after breaks, after resets, and over a wire that damages messages.

use std::sync::LazyLock;

use cable::{Answer, CHUNK_BYTES, Content, Device, Download, HEADER_BYTES, HostError, Refusal, Request, Task, Upload};
use proptest::prelude::*;

use crate::board::TestBoard;
use crate::wire::{Damage, Wire, WireError};

/// Bytes of the kit `demo`.
pub(crate) fn demo() -> Vec<u8> {
    static DEMO: LazyLock<Vec<u8>> = LazyLock::new(|| kit::open("demo").unwrap().binary);
    DEMO.clone()
}

fn other() -> Vec<u8> {
    static OTHER: LazyLock<Vec<u8>> = LazyLock::new(|| kit::open("priors").unwrap().binary);
    OTHER.clone()
}

fn chunks(kit: &[u8]) -> usize {
    (kit.len() - HEADER_BYTES).div_ceil(CHUNK_BYTES)
}

fn download(wire: &mut Wire, slot: u8) -> Vec<u8> {
    let Answer::Slot { content, .. } = wire.ask(Request::Slot { slot }).unwrap() else { panic!("no content") };
    let mut kit = vec![0; Download::length(slot, content).unwrap()];
    wire.carry_out(&mut Download::new(slot, &mut kit, 0)).unwrap();
    kit
}

#[test]
fn uploaded_kit_is_in_the_slot_and_reads_back_identical() {
    let kit = demo();
    let mut wire = Wire::new(TestBoard::playing(&other()));
    let mut upload = Upload::new(&kit, 1).unwrap();
    wire.carry_out(&mut upload).unwrap();
    assert_eq!(upload.written(), kit.len());
    assert_eq!(wire.sent, chunks(&kit) + 2, "one message for the begin, each chunk, and the end");
    assert!(wire.board.holds(1, &kit));
    assert_eq!(wire.board.erases, 1);
    assert_eq!(download(&mut wire, 1), kit);
    assert_eq!(wire.board.playing, Some(0), "the old kit plays until another is started");
    assert_eq!(wire.ask(Request::Start { slot: Some(1) }), Ok(Answer::Done));
    assert_eq!(wire.board.playing, Some(1));
}

#[test]
fn kit_sent_twice_is_written_once() {
    let kit = demo();
    let mut wire = Wire::new(TestBoard::new());
    for _ in 0..2 {
        wire.carry_out(&mut Upload::new(&kit, 0).unwrap()).unwrap();
    }
    assert_eq!(wire.board.erases, 1);
    assert_eq!(wire.ask(Request::Erase { slot: 0 }), Ok(Answer::Done));
    wire.carry_out(&mut Upload::new(&kit, 0).unwrap()).unwrap();
    assert_eq!(wire.board.erases, 3);
    assert!(wire.board.holds(0, &kit));
}

#[test]
fn upload_goes_on_after_a_break_at_every_message() {
    let kit = demo();
    for sends in 0..chunks(&kit) + 2 {
        let mut wire = Wire::new(TestBoard::new());
        wire.sends_left = sends;
        assert_eq!(wire.carry_out(&mut Upload::new(&kit, 0).unwrap()), Err(WireError::Unplugged), "{sends}");
        wire.device.reset_wire();
        wire.sends_left = usize::MAX;
        wire.sent = 0;
        wire.carry_out(&mut Upload::new(&kit, 0).unwrap()).unwrap();
        assert!(wire.board.holds(0, &kit), "{sends}");
        assert_eq!(wire.board.erases, 1, "{sends}");
        let left = chunks(&kit) - sends.saturating_sub(1);
        assert_eq!(wire.sent, left + 2, "after {sends} messages only the rest is sent");
    }
}

#[test]
fn download_goes_on_after_a_break_at_every_chunk() {
    let kit = demo();
    let mut wire = Wire::new(TestBoard::playing(&kit));
    for sends in 0..kit.len().div_ceil(CHUNK_BYTES) {
        let mut bytes = vec![0; kit.len()];
        wire.sends_left = sends;
        let mut first = Download::new(0, &mut bytes, 0);
        assert_eq!(wire.carry_out(&mut first), Err(WireError::Unplugged));
        let read = first.read();
        assert_eq!(read, sends * CHUNK_BYTES);
        wire.sends_left = usize::MAX;
        wire.carry_out(&mut Download::new(0, &mut bytes, read)).unwrap();
        assert_eq!(bytes, kit);
    }
}

#[test]
fn reset_of_the_board_within_an_upload_leaves_no_kit_and_the_upload_begins_anew() {
    let kit = demo();
    for chunk in [0, 1, 17, chunks(&kit) - 1, chunks(&kit)] {
        let mut wire = Wire::new(TestBoard::playing(&other()));
        wire.sends_left = 1 + chunk;
        let mut upload = Upload::new(&kit, 1).unwrap();
        assert_eq!(wire.carry_out(&mut upload), Err(WireError::Unplugged));
        wire.device = Device::new();
        wire.sends_left = usize::MAX;
        let Ok(Answer::Slot { content, .. }) = wire.ask(Request::Slot { slot: 1 }) else { panic!("no content") };
        let expected = if chunk == 0 { Content::Empty } else { Content::Unfinished };
        assert_eq!(content, expected, "after {chunk} chunks");
        wire.carry_out(&mut upload).unwrap();
        assert!(wire.board.holds(1, &kit));
        assert_eq!(wire.board.erases, 2);
    }
}

#[test]
fn chunk_whose_acknowledgement_is_lost_is_acknowledged_again() {
    let kit = demo();
    let mut wire = Wire::new(TestBoard::new());
    wire.sends_left = 3;
    let mut upload = Upload::new(&kit, 0).unwrap();
    assert_eq!(wire.carry_out(&mut upload), Err(WireError::Unplugged));
    wire.sends_left = usize::MAX;
    // The board has chunks 0 and 1. A second task asks from the first on.
    let session = session_of(&upload);
    let bytes = |number: u16| kit[HEADER_BYTES..].chunks(CHUNK_BYTES).nth(number.into()).unwrap();
    let request = |number| Request::Chunk { session, number, bytes: bytes(number) };
    let Ok(Answer::Written { number: 1, crc }) = wire.ask(request(1)) else { panic!("chunk 1 is not acknowledged") };
    assert_eq!(crc, dsp_core::table::checksum(bytes(1)));
    let twice = HostError::Refused(Refusal::ChunkTwice { found: 0, expected: 2 });
    assert_eq!(wire.ask(request(0)), Err(WireError::Host(twice)));
    let altered = Request::Chunk { session, number: 1, bytes: bytes(2) };
    let other = HostError::Refused(Refusal::ChunkTwice { found: 1, expected: 2 });
    assert_eq!(wire.ask(altered), Err(WireError::Host(other)), "the last chunk with other bytes is refused");
    let early = HostError::Refused(Refusal::ChunkOutOfOrder { found: 3, expected: 2 });
    assert_eq!(wire.ask(request(3)), Err(WireError::Host(early)));
    wire.carry_out(&mut upload).unwrap();
    assert!(wire.board.holds(0, &kit));
}

pub(crate) fn session_of(upload: &Upload<'_>) -> u32 {
    match upload.request() {
        Request::Begin { session, .. } | Request::Chunk { session, .. } | Request::End { session } => session,
        request => panic!("{request:?} is not a request of an upload"),
    }
}

#[test]
fn upload_over_a_poor_wire_ends_with_identical_bytes() {
    let kit = demo();
    for seed in 0..500 {
        let share = |place| if seed % 5 == place { 4 } else { 1 };
        let [dropped, doubled, cut, altered, interleaved] = [0, 1, 2, 3, 4].map(share);
        let damage = Damage { dropped, doubled, cut, altered, interleaved: 20 * interleaved };
        let mut wire = Wire::damaged(TestBoard::playing(&other()), damage, seed);
        assert_eq!(wire.carry_out(&mut Upload::new(&kit, 1).unwrap()), Ok(()), "{seed}: {damage:?}");
        assert!(wire.board.holds(1, &kit) && wire.board.holds(0, &other()), "{seed}: {damage:?}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]

    #[test]
    fn upload_over_a_broken_wire_ends_with_identical_bytes_or_a_named_refusal(
        seed: u64, dropped in 0..60u64, doubled in 0..60u64, cut in 0..60u64, altered in 0..60u64,
    ) {
        let damage = Damage { dropped, doubled, cut, altered, interleaved: 20 };
        let kit = demo();
        let mut wire = Wire::damaged(TestBoard::playing(&other()), damage, seed);
        let ended = wire.carry_out(&mut Upload::new(&kit, 1).unwrap());
        match ended {
            Ok(()) => prop_assert!(wire.board.holds(1, &kit)),
            Err(WireError::Host(error)) => prop_assert!(
                matches!(
                    error,
                    HostError::NoAnswer
                        | HostError::Refused(Refusal::DamagedMessage)
                ),
                "{error}"
            ),
            Err(WireError::Unplugged) => prop_assert!(false, "nobody pulled the cable"),
        }
        prop_assert_eq!(wire.board.playing, Some(0));
        prop_assert!(wire.board.holds(0, &other()));
        // A better cable goes on with what is there.
        wire.damage = Damage::default();
        wire.device.reset_wire();
        prop_assert_eq!(wire.carry_out(&mut Upload::new(&kit, 1).unwrap()), Ok(()));
        prop_assert!(wire.board.holds(1, &kit));
    }
}
