//! MIDI packets: all of them arrive, in order, however many come.

use super::{CONFIGURED_S, assert_sound, host, notes, played, received, run};
use virtual_board::{Board, UsbAction};

fn send(at_s: f64, packets: &[[u8; 4]]) -> (f64, UsbAction) {
    (at_s, UsbAction::Send(packets.as_flattened().to_vec()))
}

#[test]
fn notes_of_any_transfers_sound_in_order() {
    for board in Board::ALL {
        // Single packets and transfers of 16, at different places in a half.
        let packets = notes(150);
        let mut actions = Vec::new();
        let (mut rest, mut at_s) = (packets.as_slice(), CONFIGURED_S);
        for count in [1, 16, 3].into_iter().cycle() {
            let (now, later) = rest.split_at(count.min(rest.len()));
            actions.push(send(at_s, now));
            (rest, at_s) = (later, at_s + 0.015_037);
            if rest.is_empty() {
                break;
            }
        }
        let (_, report) = run(board, host(actions), at_s + 0.05);
        assert_sound(board, &report);
        assert!(played(&report) == packets, "{}: {} notes were played", board.name(), played(&report).len());
    }
}

#[test]
fn board_answers_the_identity_request_of_midi_and_leaves_other_sysex_alone() {
    for board in Board::ALL {
        let unknown = [[0x04, 0xf0, 0x7d, 0x01], [0x04, 0x02, 0x03, 0x04], [0x05, 0xf7, 0, 0]];
        let request = [[0x04, 0xf0, 0x7e, 0x7f], [0x07, 0x06, 0x01, 0xf7]];
        let actions = vec![send(CONFIGURED_S, &unknown), send(CONFIGURED_S + 0.01, &request)];
        let (_, report) = run(board, host(actions), CONFIGURED_S + 0.05);
        assert_sound(board, &report);
        let packets = received(&report);
        let bytes: Vec<u8> = packets.iter().flat_map(|packet| packet[1..].iter().copied()).collect();
        // Identity reply: manufacturer, family, member, version.
        assert_eq!(bytes[..6], [0xf0, 0x7e, 0x7f, 0x06, 0x02, 0x7d], "{}: {bytes:x?}", board.name());
        assert_eq!((bytes.len(), bytes[14]), (15, 0xf7), "{}: {bytes:x?}", board.name());
        assert_eq!(packets.iter().map(|packet| packet[0]).collect::<Vec<_>>(), [4, 4, 4, 4, 7]);
    }
}
