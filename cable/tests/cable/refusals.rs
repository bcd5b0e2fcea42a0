//! Each refusal by name, while the old kit goes on playing.

use cable::{Answer, CHUNK_BYTES, Content, HostError, Refusal, Request, Upload};

use crate::board::{CAPACITY, TestBoard};
use crate::uploads::{demo, session_of};
use crate::wire::{Wire, WireError};

/// Kit with another header word, and a right checksum where the body is not touched.
fn with_word(index: usize, word: u32) -> Vec<u8> {
    let mut kit = demo();
    kit[4 * index..][..4].copy_from_slice(&word.to_le_bytes());
    kit
}

/// Kit that breaks a rule behind a right checksum: its name begins with a space.
fn with_bad_name() -> Vec<u8> {
    let mut kit = demo();
    let meta = kit.windows(4).position(|tag| tag == b"META").unwrap();
    let offset = u32::from_le_bytes(*kit[meta + 8..].first_chunk().unwrap());
    kit[offset as usize] = b' ';
    let crc = dsp_core::table::checksum(&kit[16..]);
    kit[12..16].copy_from_slice(&crc.to_le_bytes());
    kit
}

/// Kit with more pads than a board has queues for.
fn with_17_pads() -> Vec<u8> {
    let mut kit = kit::open("demo").unwrap().kit;
    while kit.pads.len() < 17 {
        let mut pad = kit.pads[0].clone();
        pad.name = format!("pad {}", kit.pads.len());
        pad.midi_notes.clear();
        kit.pads.push(pad);
    }
    kit::binary::build(&kit).unwrap()
}

fn refused(refusal: Refusal) -> Result<(), WireError> {
    Err(WireError::Host(HostError::Refused(refusal)))
}

#[test]
fn kits_that_the_board_cannot_take_are_refused_by_name_and_the_old_kit_plays_on() {
    let (good, damaged) = (demo(), with_word(3, 0x1234_5678));
    let computed = dsp_core::table::checksum(&good[16..]);
    let length = CAPACITY as u32 + 1;
    for (kit, refusal, erases) in [
        (with_word(0, 0), Refusal::NotAKit, 0),
        (with_word(1, 2), Refusal::NewerKit { found: 2, newest: 1 }, 0),
        (with_word(2, length), Refusal::TooLong { length, capacity: CAPACITY as u32 }, 0),
        (with_word(2, 12), Refusal::NotAKit, 0),
        (damaged, Refusal::WrongCrc { stored: 0x1234_5678, computed }, 1),
        (with_bad_name(), Refusal::NotAKit, 1),
        (with_17_pads(), Refusal::NotLoadable, 1),
    ] {
        let mut wire = Wire::new(TestBoard::playing(&good));
        assert_eq!(wire.carry_out(&mut Upload::new(&kit, 1).unwrap()), refused(refusal));
        assert_eq!(wire.board.erases, erases, "{refusal}");
        assert_eq!(wire.board.playing, Some(0), "{refusal}");
        assert!(wire.board.holds(0, &good), "{refusal}");
        assert_eq!(wire.ask(Request::Status), Ok(Answer::Upload(None)), "{refusal}");
        assert!(wire.ask(Request::Start { slot: Some(1) }).is_err(), "{refusal}");
        assert_eq!(wire.board.playing, Some(0), "{refusal}");
        // The next kit goes in.
        wire.carry_out(&mut Upload::new(&good, 1).unwrap()).unwrap();
    }
}

#[test]
fn kit_with_a_wrong_checksum_never_gets_a_header() {
    let mut wire = Wire::new(TestBoard::new());
    wire.carry_out(&mut Upload::new(&with_word(3, 1), 0).unwrap()).unwrap_err();
    assert_eq!(wire.board.slots[0][..16], [0xFF; 16]);
    let Ok(Answer::Slot { content, .. }) = wire.ask(Request::Slot { slot: 0 }) else { panic!("no content") };
    assert_eq!(content, Content::Unfinished);
}

#[test]
fn slots_that_are_missing_or_empty_are_refused_by_name() {
    let kit = demo();
    let mut wire = Wire::new(TestBoard::playing(&kit));
    let missing = Refusal::NoSuchSlot { slot: 2, slots: 2 };
    assert_eq!(wire.carry_out(&mut Upload::new(&kit, 2).unwrap()), refused(missing));
    for request in [
        Request::Slot { slot: 2 },
        Request::Read { slot: 2, offset: 0 },
        Request::Erase { slot: 2 },
        Request::Start { slot: Some(2) },
    ] {
        assert_eq!(wire.ask(request).map(drop), refused(missing), "{request:?}");
    }
    assert_eq!(wire.ask(Request::Start { slot: Some(1) }).map(drop), refused(Refusal::EmptySlot { slot: 1 }));
    assert_eq!(wire.board.playing, Some(0));
}

#[test]
fn write_while_another_goes_on_is_refused_until_it_is_abandoned() {
    let kit = demo();
    let mut other = kit.clone();
    other[100] ^= 1;
    let mut wire = Wire::new(TestBoard::new());
    wire.sends_left = 5;
    let mut first = Upload::new(&kit, 1).unwrap();
    wire.carry_out(&mut first).unwrap_err();
    wire.sends_left = usize::MAX;
    let session = session_of(&first);
    let under_way = Refusal::WriteUnderWay { session, slot: 1 };
    assert_eq!(wire.carry_out(&mut Upload::new(&other, 1).unwrap()), refused(under_way));
    assert_eq!(wire.carry_out(&mut Upload::new(&kit, 0).unwrap()), refused(under_way));
    assert_eq!(wire.ask(Request::Erase { slot: 1 }).map(drop), refused(under_way));
    assert_eq!(wire.ask(Request::Erase { slot: 0 }), Ok(Answer::Done));
    let stranger = Request::Chunk { session: session ^ 1, number: 4, bytes: &kit[..CHUNK_BYTES] };
    assert_eq!(wire.ask(stranger).map(drop), refused(Refusal::NoUpload));
    assert_eq!(wire.ask(Request::End { session: session ^ 1 }).map(drop), refused(Refusal::NoUpload));
    wire.carry_out(&mut first).unwrap();
    assert!(wire.board.holds(1, &kit), "the upload under way was not disturbed");

    wire.sends_left = 5;
    let mut third = Upload::new(&other, 1).unwrap();
    wire.carry_out(&mut third).unwrap_err();
    wire.sends_left = usize::MAX;
    assert_eq!(wire.ask(Request::Abandon), Ok(Answer::Upload(None)));
    wire.carry_out(&mut Upload::new(&kit, 1).unwrap()).unwrap();
    assert!(wire.board.holds(1, &kit));
}

#[test]
fn upload_that_is_ended_early_is_refused_with_the_chunk_that_is_missing() {
    let kit = demo();
    let mut wire = Wire::new(TestBoard::new());
    wire.sends_left = 4;
    let mut upload = Upload::new(&kit, 0).unwrap();
    wire.carry_out(&mut upload).unwrap_err();
    wire.sends_left = usize::MAX;
    let chunks = (kit.len() - 16).div_ceil(CHUNK_BYTES) as u32;
    let early = wire.ask(Request::End { session: session_of(&upload) });
    assert_eq!(early.map(drop), refused(Refusal::ChunksMissing { expected: 3, chunks }));
    let short = Request::Chunk { session: session_of(&upload), number: 3, bytes: &kit[..CHUNK_BYTES - 1] };
    assert_eq!(wire.ask(short).map(drop), refused(Refusal::BadMessage));
    wire.carry_out(&mut upload).unwrap();
    assert!(wire.board.holds(0, &kit));
}

#[test]
fn flash_that_fails_at_any_write_ends_the_upload_by_name() {
    let (good, kit) = (demo(), demo());
    let chunks = (kit.len() - 16).div_ceil(CHUNK_BYTES);
    for writes in 0..chunks + 2 {
        let mut wire = Wire::new(TestBoard::playing(&good));
        wire.board.writes_left = Some(writes);
        let failed = wire.carry_out(&mut Upload::new(&kit, 1).unwrap()).unwrap_err();
        assert!(matches!(failed, WireError::Host(HostError::Refused(Refusal::Flash { .. }))), "{failed:?}");
        assert_eq!(wire.board.playing, Some(0));
        let Ok(Answer::Slot { content, .. }) = wire.ask(Request::Slot { slot: 1 }) else { panic!("no content") };
        // The magic is the last write.
        let is_last = writes == chunks + 1;
        let expected = if is_last { Content::Refused(Refusal::NotAKit) } else { Content::Unfinished };
        assert_eq!(content, expected, "after {writes} writes");
        assert!(wire.ask(Request::Start { slot: Some(1) }).is_err(), "after {writes} writes there is no kit");
        wire.board.writes_left = None;
        wire.carry_out(&mut Upload::new(&kit, 1).unwrap()).unwrap();
        assert!(wire.board.holds(1, &kit));
    }
}

#[test]
fn requests_are_refused_while_the_board_works() {
    let mut board = TestBoard::new();
    let mut device = cable::Device::new();
    let mut message = cable::Message::new();
    let mut send = |device: &mut cable::Device, board: &mut TestBoard, request: Request<'_>| {
        request.write(1, &mut message);
        let mut answer = cable::Message::new();
        message.bytes().iter().map(|&byte| device.receive(byte, board, &mut answer)).last().unwrap()
    };
    assert_eq!(send(&mut device, &mut board, Request::Erase { slot: 0 }), cable::Outcome::Answered);
    let refused = send(&mut device, &mut board, Request::Identity);
    assert_eq!(refused, cable::Outcome::Refused(Refusal::Working));
    assert_eq!(device.job(), Some(cable::Job::Erase(0)));
    assert_eq!(board.erases, 0, "the flash is erased only when the caller is ready");
    assert_eq!(device.work(&mut board, &mut cable::Message::new()), cable::Outcome::Answered);
    assert_eq!((board.erases, device.job()), (1, None));
    assert_eq!(send(&mut device, &mut board, Request::Identity), cable::Outcome::Answered);
}

#[test]
fn each_refusal_comes_back_from_its_parts_and_has_a_sentence_of_its_own() {
    let mut sentences = std::collections::BTreeSet::new();
    for code in 1..=23 {
        let refusal = Refusal::from_parts(code, 1, 2).unwrap();
        assert_eq!(refusal.parts().0, code);
        let (code, first, second) = refusal.parts();
        assert_eq!(Refusal::from_parts(code, first, second), Some(refusal));
        assert!(sentences.insert(refusal.to_string()), "{refusal}");
    }
    assert_eq!((Refusal::from_parts(0, 0, 0), Refusal::from_parts(24, 0, 0)), (None, None));
}
