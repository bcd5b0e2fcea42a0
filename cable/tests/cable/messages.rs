//! Requests and answers as bytes and back.

use cable::{
    Answer, CHUNK_BYTES, Content, Heard, Identity, Key, Lack, LeftOut, LeftOuts, MESSAGE_BYTES, Message, Progress,
    Receiver, Refusal, Request, Text, Value,
};
use dsp_core::SampleRate;
use dsp_core::engine::Stage;
use proptest::prelude::*;

/// Command, tag and payload of a message, after the checks that hold for each message.
fn arrived(message: &Message) -> (u8, u8, Vec<u8>) {
    let bytes = message.bytes();
    assert!(bytes.len() <= MESSAGE_BYTES, "{} bytes", bytes.len());
    let (last, rest) = bytes.split_last().unwrap();
    assert_eq!((rest[0], *last), (0xF0, 0xF7));
    assert!(rest[1..].iter().all(|&byte| byte < 0x80), "{bytes:02X?}");
    let mut receiver = Receiver::new();
    for &byte in rest {
        assert_eq!(receiver.receive(byte), Heard::Nothing);
    }
    match receiver.receive(*last) {
        Heard::Message(frame) => (frame.command, frame.tag, frame.payload.to_vec()),
        other => panic!("{other:?}"),
    }
}

fn keys() -> impl Strategy<Value = (Key, Option<Value>)> {
    prop_oneof![
        (0..16u8, 0.001..0.5f32).prop_map(|(piezo, value)| (Key::Threshold { piezo }, Value::Number(value))),
        (0..16u8, 0.1..8.0f32).prop_map(|(piezo, value)| (Key::Curve { piezo }, Value::Number(value))),
        (1..=16u8).prop_map(|value| (Key::Channel, Value::Count(value))),
        (-60.0..0.0f32).prop_map(|value| (Key::Level, Value::Number(value))),
        any::<u8>().prop_map(|value| (Key::StartSlot, Value::Count(value))),
    ]
    .prop_flat_map(|(key, value)| (Just(key), prop::option::of(Just(value))))
}

fn left_outs() -> impl Strategy<Value = LeftOuts> {
    let stage = prop_oneof![
        Just(None),
        any::<u8>().prop_map(|pad| Some(Stage::Residual(pad))),
        any::<u8>().prop_map(|pad| Some(Stage::Modes(pad))),
        any::<u8>().prop_map(|pad| Some(Stage::DynamicFilter(pad))),
        any::<u8>().prop_map(|pad| Some(Stage::Biquads(pad))),
        prop::sample::select(vec![Some(Stage::Room), Some(Stage::Background), Some(Stage::Engine)]),
    ];
    let lack = prop::sample::select(vec![Lack::Memory, Lack::Time, Lack::Rate, Lack::Code]);
    prop::collection::vec((stage, lack), 0..=LeftOuts::MOST + 1).prop_map(|stages| {
        let mut list = LeftOuts::new();
        stages.into_iter().for_each(|(stage, lack)| list.push(LeftOut { stage, lack }));
        list
    })
}

fn refusals() -> impl Strategy<Value = Refusal> {
    (1..=23u8, any::<(u32, u32)>())
        .prop_map(|(code, (first, second))| Refusal::from_parts(code, first, second).unwrap())
}

fn answers() -> impl Strategy<Value = Answer<'static>> {
    let slot = || prop::option::of(0..255u8);
    let text = || ".{0,30}".prop_map(|text| Text::new(text.trim_matches('\0')));
    let content = prop_oneof![
        Just(Content::Empty),
        Just(Content::Unfinished),
        (text(), any::<(u32, u32)>()).prop_map(|(name, (length, crc))| Content::Kit { name, length, crc }),
        refusals().prop_map(Content::Refused),
    ];
    let identity = (text(), text(), text(), 8_000..192_000u32).prop_map(|(firmware, revision, board, hz)| Identity {
        firmware,
        revision,
        board,
        rate: SampleRate::new(hz, 1).unwrap(),
    });
    let bytes = prop::collection::vec(any::<u8>(), 0..=CHUNK_BYTES);
    let progress = any::<(u32, u8, u16, u16)>();
    let progress = progress.prop_map(|(session, slot, next, chunks)| Progress { session, slot, next, chunks });
    prop_oneof![
        (identity, any::<u8>(), slot()).prop_map(|(identity, slots, playing)| Answer::Identity {
            identity,
            slots,
            playing
        }),
        (any::<(u8, u32)>(), content, left_outs()).prop_map(|((slot, capacity), content, left_out)| Answer::Slot {
            slot,
            capacity,
            content,
            left_out
        }),
        (any::<(u8, u32)>(), bytes).prop_map(|((slot, offset), bytes)| Answer::Bytes {
            slot,
            offset,
            bytes: bytes.leak()
        }),
        prop::option::of(progress).prop_map(Answer::Upload),
        any::<(u16, u32)>().prop_map(|(number, crc)| Answer::Written { number, crc }),
        keys().prop_map(|(key, value)| Answer::Setting { key, value }),
        Just(Answer::Done),
        any::<u16>().prop_map(|ms| Answer::Working { ms }),
        refusals().prop_map(Answer::Refused),
    ]
}

/// Number of the request that an answer fits.
fn command(answer: &Answer<'_>) -> u8 {
    match answer {
        Answer::Identity { .. } => 1,
        Answer::Slot { .. } => 2,
        Answer::Bytes { .. } => 3,
        Answer::Upload(_) => 4,
        Answer::Written { .. } => 5,
        Answer::Setting { .. } => 10,
        Answer::Done | Answer::Working { .. } | Answer::Refused(_) => 6,
    }
}

proptest! {
    #[test]
    fn request_comes_back_from_its_bytes(
        bytes in prop::collection::vec(any::<u8>(), 0..=CHUNK_BYTES),
        header in any::<[u8; 16]>(),
        (session, offset, number) in any::<(u32, u32, u16)>(),
        slot in 0..255u8,
        playing in prop::option::of(0..255u8),
        (key, value) in keys(),
        tag in 0..128u8,
    ) {
        for request in [
            Request::Identity,
            Request::Slot { slot },
            Request::Read { slot, offset },
            Request::Begin { session, slot, header },
            Request::Chunk { session, number, bytes: &bytes },
            Request::End { session },
            Request::Status,
            Request::Abandon,
            Request::Erase { slot },
            Request::Get { key },
            Request::Set { key, value },
            Request::Start { slot: playing },
            Request::EnterDfu,
        ] {
            let mut message = Message::new();
            request.write(tag, &mut message);
            let (command, arrived_tag, payload) = arrived(&message);
            prop_assert_eq!((command, arrived_tag), (request.command(), tag));
            prop_assert_eq!(Request::read(command, &payload), Ok(request));
            for short in 0..payload.len() {
                let cut = Request::read(command, &payload[..short]);
                prop_assert_ne!(cut, Ok(request), "{} bytes of {}", short, payload.len());
            }
        }
    }

    #[test]
    fn answer_comes_back_from_its_bytes(answer in answers(), tag in 0..128u8) {
        let mut message = Message::new();
        answer.write(command(&answer), tag, &mut message);
        let (command, arrived_tag, payload) = arrived(&message);
        prop_assert_eq!(arrived_tag, tag);
        prop_assert_eq!(Answer::read(command, &payload), Some(answer));
    }

    #[test]
    fn text_keeps_its_first_24_bytes_at_a_boundary_of_characters(text in "[^\0]{0,40}") {
        let held = Text::new(&text);
        prop_assert!(text.starts_with(held.as_str()));
        prop_assert!(held.as_str().len() + 3 >= text.len().min(Text::BYTES));
        prop_assert_eq!(Text::from_bytes(*held.bytes()), Some(held));
    }
}
