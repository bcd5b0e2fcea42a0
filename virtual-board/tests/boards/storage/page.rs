//! Example of docs/midi-sysex.md, as an image answers it.

use cable::Link;
use virtual_board::{Board, Setup};

use super::Session;
use crate::usb::link::BoardLink;

const PAGE: &str = include_str!("../../../../docs/midi-sysex.md");

/// Returns a message without the git revision of an identity, bytes 24 to 47 of its payload, and
/// without the checksum over it.
fn without_revision(mut message: Vec<u8>) -> Vec<u8> {
    if message[4] == 0x41 {
        // Before each seven bytes of the payload stands one of their top bits.
        (24..48).for_each(|byte| message[6 + byte + byte / 7 + 1] = 0);
        let end = message.len() - 1;
        message[end - 5..end].fill(0);
    }
    message
}

#[test]
fn example_of_the_page_is_what_a_blackpill_answers() {
    let mut session = Session::start(Board::BlackpillF411, Setup::default());
    let mut link = BoardLink::new(&mut session.board);
    let lines: Vec<_> = PAGE.lines().filter_map(|line| line.split_once(" F0 ")).collect();
    assert_eq!(lines.len(), 7);
    for (sender, bytes) in lines {
        let bytes = bytes.split(' ').map(|byte| u8::from_str_radix(byte, 16).unwrap());
        let message: Vec<u8> = std::iter::once(0xf0).chain(bytes).collect();
        if sender == "computer" {
            link.send(&message).unwrap();
            continue;
        }
        let until_ms = link.now_ms() + 1000;
        let mut answer = Vec::new();
        while answer.last() != Some(&0xf7) {
            answer.push(link.receive(until_ms).unwrap().expect("the board answers within a second"));
        }
        assert_eq!(without_revision(answer), without_revision(message));
    }
}
