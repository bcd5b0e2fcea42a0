//! Bytes that are no messages, and messages that are not whole.

use cable::{Answer, Device, Heard, MESSAGE_BYTES, Message, Outcome, Receiver, Refusal, Request};
use proptest::prelude::*;

use crate::board::TestBoard;
use crate::uploads::demo;
use crate::wire::Wire;

fn identity() -> Vec<u8> {
    let mut message = Message::new();
    Request::Identity.write(5, &mut message);
    message.bytes().to_vec()
}

/// Message of bytes without checksum and end.
fn with_checksum(bytes: &[u8]) -> Vec<u8> {
    let crc = dsp_core::table::checksum(&bytes[1..]);
    let checksum = (0..5).map(|place| (crc >> (7 * place)) as u8 & 0x7F);
    bytes.iter().copied().chain(checksum).chain([0xF7]).collect()
}

/// Outcomes other than nothing, with the command and the tag of the answer.
fn outcomes(device: &mut Device, board: &mut TestBoard, bytes: &[u8]) -> Vec<(Outcome, u8, u8)> {
    let mut message = Message::new();
    let mut found = Vec::new();
    for &byte in bytes {
        let outcome = device.receive(byte, board, &mut message);
        if outcome != Outcome::Nothing {
            found.push((outcome, message.bytes()[4], message.bytes()[5]));
        }
    }
    found
}

#[test]
fn broken_messages_are_refused_by_name_and_the_next_one_is_answered() {
    let good = identity();
    let mut altered = good.clone();
    *altered.iter_mut().rev().nth(2).unwrap() ^= 1;
    // The version is told apart only if the checksum is right.
    let newer = with_checksum(&[0xF0, 0x7D, 0x4D, 2, 1, 5]);
    let lone_top_bits = with_checksum(&[0xF0, 0x7D, 0x4D, 1, 1, 5, 0]);
    let mut long = good[..6].to_vec();
    long.extend([0; MESSAGE_BYTES - 6]);
    long.push(0xF7);
    let mut endless = good[..6].to_vec();
    endless.extend([0x55; 100_000]);
    for (bytes, refusal) in [
        (altered, Refusal::DamagedMessage),
        (good[..8].to_vec(), Refusal::CutMessage),
        ([&good[..8], &[0x90, 60, 100]].concat(), Refusal::CutMessage),
        ([&good[..6], &[0xF7]].concat(), Refusal::DamagedMessage),
        (long, Refusal::LongMessage),
        (endless, Refusal::CutMessage),
        (newer, Refusal::OtherProtocol { found: 2 }),
        (lone_top_bits, Refusal::BadMessage),
    ] {
        let found = outcomes(&mut Device::new(), &mut TestBoard::new(), &[bytes, good.clone()].concat());
        assert_eq!(found, [(Outcome::Refused(refusal), 0x7F, 5), (Outcome::Answered, 0x41, 5)]);
    }
}

#[test]
fn real_time_bytes_inside_a_message_change_nothing() {
    let good = identity();
    for place in 0..=good.len() {
        for byte in 0xF8..=0xFF {
            let bytes = [&good[..place], &[byte], &good[place..]].concat();
            let found = outcomes(&mut Device::new(), &mut TestBoard::new(), &bytes);
            assert_eq!(found, [(Outcome::Answered, 0x41, 5)], "{byte:02X} at {place}");
        }
    }
}

#[test]
fn answers_and_sysex_of_others_are_passed_over_in_silence() {
    let good = identity();
    let mut answer = Message::new();
    Answer::Done.write(0x06, 5, &mut answer);
    let mut damaged_answer = answer.bytes().to_vec();
    damaged_answer[7] ^= 1;
    for bytes in [
        answer.bytes(),
        &damaged_answer,
        &[0xF0, 0x7E, 0x7F, 6, 1, 0xF7],
        &[0xF0, 0x7D, 0x4E, 1, 1, 1, 1, 1, 1, 1, 1, 1, 0xF7],
        &[0xF0, 0xF7],
        &[0xF0, 0x7D, 0xF7],
        &[0xF0, 0x7D, 0x4D, 0x01, 0x01],
        &[0xF7, 0xF7, 0x90, 60, 100, 60, 0],
    ] {
        let found = outcomes(&mut Device::new(), &mut TestBoard::new(), &[bytes, &good].concat());
        assert_eq!(found, [(Outcome::Answered, 0x41, 5)], "{bytes:02X?}");
    }
}

/// Random bytes, of which every eighth begins or ends something, with whole messages amid them.
fn garbage(count: usize, seed: u64) -> Vec<u8> {
    let mut wire = Wire::damaged(TestBoard::new(), crate::wire::Damage::default(), seed);
    let mut bytes = Vec::with_capacity(count + MESSAGE_BYTES);
    let kit = demo();
    while bytes.len() < count {
        match wire.random(40) {
            0 => {
                // Of requests at random, the ones with a right checksum go deepest.
                let mut message = Message::new();
                let header = *kit.first_chunk().unwrap();
                let (session, slot) = (wire.random(2) as u32, wire.random(3) as u8);
                let number = wire.random(4) as u16;
                match wire.random(9) {
                    0 => Request::Begin { session, slot, header },
                    1 | 2 => Request::Chunk { session, number, bytes: &kit[16..][..240] },
                    3 => Request::End { session },
                    4 => Request::Read { slot, offset: wire.random(1 << 32) as u32 },
                    5 => Request::Erase { slot },
                    6 => Request::Start { slot: Some(slot) },
                    7 => Request::Slot { slot },
                    _ => Request::Abandon,
                }
                .write(number as u8, &mut message);
                bytes.extend_from_slice(message.bytes());
            }
            1 => bytes.extend_from_slice(&[0xF0, 0x7D, 0x4D, 0x01]),
            2 => bytes.extend([0xF0, 0xF7]),
            3..8 => bytes.push(wire.random(256) as u8),
            _ => bytes.push(wire.random(128) as u8),
        }
    }
    bytes
}

#[test]
fn million_random_bytes_leave_the_board_ready_and_its_kit_playing() {
    let kit = demo();
    let mut device = Device::new();
    let mut board = TestBoard::playing(&kit);
    let mut answers = 0;
    let mut message = Message::new();
    for byte in garbage(1_000_000, 7) {
        if device.receive(byte, &mut board, &mut message) != Outcome::Nothing {
            answers += 1;
            assert!(message.bytes().len() <= MESSAGE_BYTES);
        }
        device.work(&mut board, &mut message);
    }
    assert!(answers > 1000, "only {answers} answers");
    assert!(board.erases > 10, "only {} erases", board.erases);
    device.reset_wire();
    assert_eq!(outcomes(&mut device, &mut board, &identity()), [(Outcome::Answered, 0x41, 5)]);
}

proptest! {
    #[test]
    fn receiver_never_gives_a_message_that_was_not_sent(seed: u64) {
        let mut receiver = Receiver::new();
        for byte in garbage(2_000, seed) {
            if let Heard::Message(frame) = receiver.receive(byte) {
                prop_assert!(Request::read(frame.command, frame.payload).is_ok(), "{frame:?}");
            }
        }
    }
}
