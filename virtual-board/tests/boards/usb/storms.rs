//! Storms: full transfers as fast as the bus goes. The sound goes on, and each message is played or
//! counted.

use super::{CONFIGURED_S, assert_sound, host, note, notes, played, received, run};
use crate::common;
use virtual_board::{Board, Report, Setup, UsbAction};

/// Numbers of the last line of the log about USB: transfers, messages, unknown, lost, unsent.
fn counts(report: &Report) -> [u64; 5] {
    let line = report.log.iter().rfind(|line| line.message.starts_with("USB:")).unwrap();
    let numbers = line.message.split(", ").filter_map(|part| part.rsplit(' ').next()?.parse().ok());
    numbers.collect::<Vec<_>>().try_into().unwrap()
}

#[test]
fn each_note_of_a_storm_is_taken_or_counted_as_lost_and_no_half_is_missed() {
    for board in Board::ALL {
        let storm = UsbAction::Storm { packets: notes(160).as_flattened().to_vec(), for_s: 0.6 };
        // The board counts once a second.
        let (_, report) = run(board, host(vec![(CONFIGURED_S, storm)]), CONFIGURED_S + 1.8);
        assert_sound(board, &report);
        let [transfers, messages, unknown, lost, _] = counts(&report);
        println!("{}: {transfers} transfers; {messages} messages, {unknown} unknown, {lost} lost", board.name());
        let sent: usize = report.usb.sent.iter().map(|transfer| transfer.bytes.len() / 4).sum();
        assert_eq!((unknown, messages + lost), (0, sent as u64), "{}", board.name());
        // Notes that sound take most of the time.
        assert!(transfers > 1200 && messages > 500 && lost > 0, "{}", board.name());
    }
}

/// Returns packets of one kind of storm: notes of all pads with hands and positions, garbage, a
/// SysEx without an end, requests of MIDI and of the cable without a pause.
fn packets_of(kind: usize, random: &mut impl FnMut() -> u8) -> Vec<[u8; 4]> {
    const KEYS: [u8; 9] = [60, 81, 53, 49, 76, 75, 36, 52, 12];
    let mut one = |n: usize| match kind {
        0 => {
            let (key, value) = (KEYS[usize::from(random()) % KEYS.len()], random() & 0x7f);
            match random() % 8 {
                0 => [0x0b, 0xb9, 16, value],
                1 => [0x0a, 0xa9, key, value],
                2 => [0x08, 0x89, key, 0],
                _ => [0x09, 0x99, key, value.max(1)],
            }
        }
        1 => [random(), random(), random(), random()],
        2 if n == 0 => [0x04, 0xf0, 0x7d, random() & 0x7f],
        2 => [0x04, random() & 0x7f, random() & 0x7f, random() & 0x7f],
        _ => [[0x04, 0xf0, 0x7e, 0x7f], [0x07, 0x06, 0x01, 0xf7]][n % 2],
    };
    (0..512).map(&mut one).collect()
}

/// Lets the four kinds of storm come by turns, `rounds` times, each for `turn_s`. Then the board
/// answers and plays. The messages follow from `seed`.
fn storms_by_turns(rounds: usize, turn_s: f64, seed: u32) {
    for board in Board::ALL {
        let mut state = seed;
        let mut random = || {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (state >> 24) as u8
        };
        let mut actions = Vec::new();
        let mut at_s = CONFIGURED_S;
        for turn in 0..4 * rounds {
            let packets = packets_of(turn % 4, &mut random).as_flattened().to_vec();
            actions.push((at_s, UsbAction::Storm { packets, for_s: turn_s }));
            at_s += turn_s;
        }
        // Garbage may have asked for a kit, which takes a while.
        at_s += 1.0;
        let level = [0x0b, 0xb9, 7, 100];
        let request = [[0x04, 0xf0, 0x7e, 0x7f], [0x07, 0x06, 0x01, 0xf7]];
        actions.push((
            at_s,
            UsbAction::Send([[level].as_slice(), &request, &[note(99)]].concat().as_flattened().to_vec()),
        ));
        let running = common::run(board, &Setup { usb: host(actions), ..Setup::default() }, at_s + 1.1);
        let report = running.report().unwrap();
        assert_sound(board, &report);
        println!("{}: {:?} transfers, messages, unknown, lost, unsent", board.name(), counts(&report));
        println!("{}: the dearest half takes {:.3} of its time", board.name(), report.audio.worst_load.unwrap());
        assert_eq!(played(&report).last(), Some(&note(99)), "{}", board.name());
        let replies = received(&report).iter().filter(|packet| packet[..3] == [0x04, 0xf0, 0x7e]).count();
        assert!(replies > 10, "{}: {replies} replies", board.name());
        assert_eq!(received(&report).last().map(|packet| packet[0]), Some(0x07), "{}", board.name());
    }
}

#[test]
fn notes_garbage_and_endless_sysex_by_turns_miss_no_half() {
    storms_by_turns(1, 0.15, 99);
}

/// `cargo test -p virtual-board --test boards usb::storms -- --ignored --nocapture`.
#[test]
#[ignore = "takes minutes; the test of 0.6 s runs always"]
fn notes_garbage_and_endless_sysex_by_turns_for_10_s_miss_no_half() {
    [99, 1, 5].iter().for_each(|&seed| storms_by_turns(10, 0.25, seed));
}
