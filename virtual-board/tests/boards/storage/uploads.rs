//! Uploads of kits, while the board plays.

use virtual_board::{Board, FlashTimes, Setup};

use super::{Session, kit_of, says, slots};

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
#[ignore = "takes minutes; the test of a kit of 17 KB runs always"]
fn kit_of_128_kb_takes_at_most_12_s_with_the_longest_times_of_flash() {
    for board in Board::ALL {
        kit_is_sent_read_back_and_played(board, SLOT_BYTES);
    }
}
