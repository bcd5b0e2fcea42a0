//! Uploads of kits, while the board plays.

use cable::HostError;
use virtual_board::{Board, FlashTimes, Setup, UsbAction, UsbHost};

use super::{CONFIGURED_S, Session, kit_of, says, slots};

/// Time that a kit of 128 KB may take, in s.
const LONGEST_S: f64 = 12.0;
/// Bytes of a slot.
const SLOT_BYTES: usize = 128 << 10;

/// Sends a kit to a slot, reads it back, and plays it.
fn kit_is_sent_read_back_and_played(board: Board, bytes: usize) {
    let mut session = Session::start(board, Setup { flash_times: FlashTimes::Maximum, ..Setup::default() });
    let slot = slots(board) - 1;
    let kit = kit_of("sent", bytes);
    let began_s = session.board.now_s();
    session.send(slot, &kit).unwrap();
    session.play(Some(slot)).unwrap();
    let took_s = session.board.now_s() - began_s;
    println!("{}: {} bytes are sent and play within {took_s:.2} s", board.name(), kit.len());
    assert_eq!(session.read(slot), kit, "{}", board.name());
    let report = session.report();
    assert_eq!(says(&report, "sent plays").len(), 1, "{:#?}", report.log);
    assert!(report.resets.is_empty() && says(&report, "halves missed").is_empty(), "{:#?}", report.log);
    assert!(took_s <= LONGEST_S, "{}: {took_s} s", board.name());
}

#[test]
fn kit_is_sent_while_the_board_plays_reads_back_identical_and_plays() {
    for board in Board::ALL {
        kit_is_sent_read_back_and_played(board, 9_000);
    }
}

/// `cargo test -p virtual-board --test boards storage -- --ignored --nocapture`.
#[test]
#[ignore = "takes minutes; the test of a kit of 9 KB runs always"]
fn kit_of_128_kb_takes_at_most_12_s_with_the_longest_times_of_flash() {
    for board in Board::ALL {
        kit_is_sent_read_back_and_played(board, SLOT_BYTES);
    }
}

/// Pulls the cable `count` times, for 5 ms each, while kits are sent and notes played. Then a kit
/// is sent and plays.
fn cable_is_pulled_amid_uploads(board: Board, count: usize) {
    let pulls = (0..count).flat_map(|n| {
        let at_s = CONFIGURED_S + 0.1 + 0.33 * n as f64 + 0.0037 * (n % 29) as f64;
        [(at_s, UsbAction::Unplug), (at_s + 0.005, UsbAction::Plug)]
    });
    let setup = Setup { usb: UsbHost { actions: pulls.collect(), ..UsbHost::default() }, ..Setup::default() };
    let mut session = Session::start(board, setup);
    let end_s = CONFIGURED_S + 0.1 + 0.33 * count as f64 + 0.3;
    let kits = ["one", "two"].map(|name| kit_of(name, 9_000));
    let (mut whole, mut broken) = (0, 0);
    while session.board.now_s() < end_s {
        session.board.usb(UsbAction::Send(vec![0x09, 0x99, 60, 90]));
        match session.send(0, &kits[whole % 2]) {
            Ok(()) => whole += 1,
            Err(HostError::NoAnswer) => broken += 1,
            Err(error) => panic!("{}: {error}", board.name()),
        }
    }
    session.send(0, &kits[whole % 2]).unwrap();
    session.play(Some(0)).unwrap();
    assert_eq!(session.read(0), kits[whole % 2], "{}", board.name());
    let report = session.report();
    println!("{}: {count} pulls; {whole} kits were sent, {broken} given up", board.name());
    assert!(report.resets.is_empty() && says(&report, "halves missed").is_empty(), "{:#?}", report.log);
    assert!(whole > 0, "{}", board.name());
}

#[test]
fn upload_goes_on_behind_a_cable_that_is_pulled() {
    for board in Board::ALL {
        cable_is_pulled_amid_uploads(board, 4);
    }
}

/// `cargo test -p virtual-board --test boards storage -- --ignored --nocapture`.
#[test]
#[ignore = "takes minutes; the test of 4 pulls runs always"]
fn uploads_go_on_behind_a_cable_that_is_pulled_100_times() {
    for board in Board::ALL {
        cable_is_pulled_amid_uploads(board, 100);
    }
}
