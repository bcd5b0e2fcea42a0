//! Identity, slots, settings, starts, and the way into the bootloader.

use boards::{BlackpillF411, Board};
use cable::{Answer, Content, HostError, Key, Refusal, Request, SETTINGS_VERSION, Value};

use crate::board::{CAPACITY, TestBoard};
use crate::uploads::demo;
use crate::wire::{Wire, WireError};

#[test]
fn identity_names_firmware_board_rate_slots_and_the_playing_slot() {
    let mut wire = Wire::new(TestBoard::playing(&demo()));
    let Ok(Answer::Identity { identity, slots, playing }) = wire.ask(Request::Identity) else { panic!("no identity") };
    assert_eq!(identity.firmware.as_str(), "0.1.0");
    assert_eq!(identity.revision.as_str(), "74990db");
    assert_eq!(identity.board.as_str(), "blackpill-f411");
    assert_eq!(identity.rate.ratio(), (76_800_000, 1_600));
    assert_eq!((slots, playing), (2, Some(0)));
    wire.ask(Request::Start { slot: None }).unwrap();
    assert!(matches!(wire.ask(Request::Identity), Ok(Answer::Identity { playing: None, .. })));
}

#[test]
fn slot_tells_its_kit_and_each_stage_that_the_board_leaves_out() {
    let kit = kit::open("filters").unwrap().binary;
    let parsed = dsp_core::table::Kit::parse(&kit).unwrap();
    let mut reasons = Vec::new();
    BlackpillF411::plan(&parsed, &mut |reason| reasons.push(reason)).unwrap();
    assert!(!reasons.is_empty(), "the kit has stages that the BlackPill leaves out");
    let mut wire = Wire::new(TestBoard::playing(&kit));
    let Ok(Answer::Slot { slot: 0, capacity, content, left_out }) = wire.ask(Request::Slot { slot: 0 }) else {
        panic!("no content")
    };
    assert_eq!(capacity as usize, CAPACITY);
    let Content::Kit { name, length, crc } = content else { panic!("{content:?}") };
    assert_eq!((name.as_str(), length as usize), (parsed.name(), kit.len()));
    assert_eq!(crc.to_le_bytes(), kit[12..16]);
    assert_eq!(left_out.iter().collect::<Vec<_>>(), reasons.into_iter().map(Into::into).collect::<Vec<_>>());
    let Ok(Answer::Slot { content, .. }) = wire.ask(Request::Slot { slot: 1 }) else { panic!("no content") };
    assert_eq!(content, Content::Empty);
    wire.board.slots[1][..4].copy_from_slice(b"RIFF");
    let Ok(Answer::Slot { content, .. }) = wire.ask(Request::Slot { slot: 1 }) else { panic!("no content") };
    assert_eq!(content, Content::Refused(Refusal::NotAKit));
}

#[test]
fn settings_are_set_read_and_removed() {
    let mut wire = Wire::new(TestBoard::new());
    for (key, value) in [
        (Key::Threshold { piezo: 3 }, Value::Number(0.012)),
        (Key::Curve { piezo: 0 }, Value::Number(1.5)),
        (Key::Channel, Value::Count(10)),
        (Key::Level, Value::Number(-6.0)),
        (Key::StartSlot, Value::Count(1)),
    ] {
        assert_eq!(wire.ask(Request::Get { key }), Ok(Answer::Setting { key, value: None }));
        assert_eq!(wire.ask(Request::Set { key, value: Some(value) }), Ok(Answer::Done));
        assert_eq!(wire.ask(Request::Get { key }), Ok(Answer::Setting { key, value: Some(value) }));
        assert_eq!(wire.ask(Request::Set { key, value: None }), Ok(Answer::Done));
        assert_eq!(wire.ask(Request::Get { key }), Ok(Answer::Setting { key, value: None }));
    }
}

#[test]
fn settings_out_of_range_are_refused_and_leave_the_old_value() {
    let mut wire = Wire::new(TestBoard::new());
    let key = Key::Threshold { piezo: 0 };
    wire.ask(Request::Set { key, value: Some(Value::Number(0.1)) }).unwrap();
    let refused = |refusal| Err(WireError::Host(HostError::Refused(refusal)));
    for (key, value) in [
        (key, Value::Number(0.0)),
        (key, Value::Number(f32::NAN)),
        (Key::Threshold { piezo: 4 }, Value::Number(0.1)),
        (Key::Curve { piezo: 0 }, Value::Number(9.0)),
        (Key::Channel, Value::Count(0)),
        (Key::Channel, Value::Count(17)),
        (Key::Level, Value::Number(f32::INFINITY)),
    ] {
        let set = wire.ask(Request::Set { key, value: Some(value) });
        assert_eq!(set.map(drop), refused(Refusal::SettingRange { key: key.parts().0 }), "{key:?} {value:?}");
    }
    let kept = Answer::Setting { key, value: Some(Value::Number(0.1)) };
    assert_eq!(wire.ask(Request::Get { key }), Ok(kept));
}

#[test]
fn settings_that_are_unknown_or_too_new_are_refused_by_name() {
    for (payload, refusal) in [
        ([SETTINGS_VERSION, 6, 0], Refusal::UnknownSetting { key: 6 }),
        ([SETTINGS_VERSION + 1, 1, 0], Refusal::NewerSettings { found: SETTINGS_VERSION + 1 }),
    ] {
        assert_eq!(Request::read(0x0A, &payload), Err(refusal));
        assert_eq!(Request::read(0x0B, &[&payload[..], &[0; 4]].concat()), Err(refusal));
    }
    assert_eq!(Request::read(0x20, &[]), Err(Refusal::UnknownCommand { command: 0x20 }));
}

#[test]
fn bootloader_is_entered_after_the_answer() {
    let mut wire = Wire::new(TestBoard::new());
    assert_eq!(wire.ask(Request::EnterDfu), Ok(Answer::Done));
    assert!(wire.board.is_in_dfu);
}
