//! The commands, with a board in memory at the end of the cable.

#[path = "../../../../cable/tests/cable/board.rs"]
mod board;

use std::collections::VecDeque;

use cable::{Device, Link, Message, Outcome, Request};

use super::settings::{parse, settings_over};
use super::{PortArguments, SendArguments, ask, info_over, open, read_over, send_over};
use crate::commands::error::CommandError;
use board::TestBoard;

struct Memory {
    device: Device,
    board: TestBoard,
    answers: VecDeque<u8>,
}

impl Memory {
    fn new(board: TestBoard) -> Self {
        Self { device: Device::new(), board, answers: VecDeque::new() }
    }
}

impl Link for Memory {
    type Error = CommandError;

    fn send(&mut self, message: &[u8]) -> Result<(), CommandError> {
        let mut answer = Message::new();
        for &byte in message {
            if self.device.receive(byte, &mut self.board, &mut answer) != Outcome::Nothing {
                self.answers.extend(answer.bytes());
            }
        }
        if self.device.work(&mut self.board, &mut answer) != Outcome::Nothing {
            self.answers.extend(answer.bytes());
        }
        Ok(())
    }

    fn receive(&mut self, _until_ms: u64) -> Result<Option<u8>, CommandError> {
        Ok(self.answers.pop_front())
    }

    fn now_ms(&mut self) -> u64 {
        0
    }
}

fn to_slot(kit: &str, slot: u8) -> SendArguments {
    SendArguments { kit: kit.to_owned(), slot, abandon: false, port: PortArguments { port: String::new() } }
}

#[test]
fn kit_that_is_sent_plays_and_is_read_back_identical() {
    let mut link = Memory::new(TestBoard::new());
    let loaded = open("demo").unwrap();
    let told = send_over(&mut link, &loaded, &to_slot("demo", 1)).unwrap();
    assert!(told.contains("slot 1 of blackpill-f411"), "{told}");
    assert_eq!(link.board.playing, Some(1));
    assert!(link.board.holds(1, &loaded.binary));
    assert_eq!(read_over(&mut link, 1).unwrap(), loaded.binary);
    let info = info_over(&mut link).unwrap();
    assert!(info.contains("blackpill-f411: firmware 0.1.0 (74990db), 76800000/1600 Hz; slot 1 plays"), "{info}");
    assert!(info.contains(&format!("slot 1: {}, {} of 65536 bytes", loaded.kit.name, loaded.binary.len())), "{info}");
    assert!(info.contains("slot 0: empty"), "{info}");
    let empty = read_over(&mut link, 0).unwrap_err().to_string();
    assert!(empty.contains("slot 0 holds no kit"), "{empty}");
}

#[test]
fn info_names_what_the_board_leaves_out() {
    let mut link = Memory::new(TestBoard::playing(&open("filters").unwrap().binary));
    let info = info_over(&mut link).unwrap();
    assert!(info.contains("slot 0 leaves out: pad "), "{info}");
}

#[test]
fn kit_that_the_board_cannot_load_is_refused_before_anything_is_erased() {
    let mut link = Memory::new(TestBoard::new());
    let mut loaded = open("demo").unwrap();
    loaded.kit.pads.clear();
    loaded.binary = kit::binary::build(&loaded.kit).unwrap();
    let refused = send_over(&mut link, &loaded, &to_slot("demo", 0)).unwrap_err().to_string();
    assert!(refused.contains("blackpill-f411 cannot load it: the kit has no pads"), "{refused}");
    let missing = send_over(&mut link, &open("demo").unwrap(), &to_slot("demo", 2)).unwrap_err().to_string();
    assert!(missing.contains("there is no slot 2: the board has 2"), "{missing}");
    assert_eq!((link.board.erases, link.board.playing), (0, None));
}

#[test]
fn upload_that_another_program_left_is_ended_by_abandon_alone() {
    let mut link = Memory::new(TestBoard::new());
    let loaded = open("demo").unwrap();
    let header = *loaded.binary.first_chunk().unwrap();
    ask(&mut link, Request::Begin { session: 1, slot: 0, header }).unwrap();
    let refused = send_over(&mut link, &loaded, &to_slot("demo", 0)).unwrap_err().to_string();
    assert!(refused.contains("another upload (session 00000001) writes slot 0"), "{refused}");
    assert!(refused.contains("--abandon"), "{refused}");
    send_over(&mut link, &loaded, &SendArguments { abandon: true, ..to_slot("demo", 0) }).unwrap();
    assert!(link.board.holds(0, &loaded.binary));
}

#[test]
fn settings_are_changed_and_listed_by_name() {
    let mut link = Memory::new(TestBoard::new());
    let changes: Vec<_> =
        ["threshold.3=0.01", "channel=10", "level=-6.5"].map(|text| parse(text).unwrap()).into_iter().collect();
    assert_eq!(settings_over(&mut link, &changes).unwrap(), "threshold.3=0.01\nchannel=10\nlevel=-6.5\n");
    let all = settings_over(&mut link, &[]).unwrap();
    assert!(all.starts_with("channel=10\nlevel=-6.5\nstart-slot=\nthreshold.0=\ncurve.0=\n"), "{all}");
    assert!(all.ends_with("threshold.3=0.01\ncurve.3=\n"), "{all}");
    settings_over(&mut link, &[parse("channel=").unwrap()]).unwrap();
    assert!(settings_over(&mut link, &[]).unwrap().starts_with("channel=\n"));
}

#[test]
fn settings_that_make_no_sense_are_refused_with_what_is_allowed() {
    for (text, told) in [
        ("channel", "NAME=VALUE"),
        ("channel=17", "from 1 to 16"),
        ("threshold.0=0.6", "from 0.001 to 0.5"),
        ("threshold=0.1", "threshold.0"),
        ("channel.1=3", "no setting \"channel.1\""),
        ("volume=3", "no setting \"volume\""),
        ("curve.300=1", "no setting \"curve.300\""),
    ] {
        let refused = parse(text).unwrap_err();
        assert!(refused.contains(told), "{text}: {refused}");
    }
}
