//! Losses of power: the next start plays the old kit or the new one whole, or says that neither is
//! there.

use cable::{Answer, Key, Request, Value};
use virtual_board::{Board, FlashHistory, FlashMemory, Setup};

use super::{Session, kit_of, says};
use crate::common;

/// Time at which a board has started and told its kit, in s.
const STARTED_S: f64 = 0.4;

/// Sends the kit `old` to slot 0, then `new` over it, and returns the flash's history of the second
/// upload.
fn uploads(board: Board) -> (FlashHistory, usize) {
    let mut session = Session::start(board, Setup::default());
    session.send(0, &kit_of("old", 3_000)).unwrap();
    let first = session.board.flash_history().operations.len();
    session.send(0, &kit_of("new", 3_000)).unwrap();
    (session.board.flash_history(), first)
}

/// Starts a board with this flash and returns the name of the kit that plays.
fn kit_after_start(board: Board, flash: FlashMemory) -> &'static str {
    let setup = Setup { flash: Some(flash), ..Setup::default() };
    let report = common::run(board, &setup, STARTED_S).report().unwrap();
    assert!(report.resets.is_empty(), "{:#?}", report.log);
    let plays = says(&report, " plays");
    assert_eq!(plays.len(), 1, "{:#?}", report.log);
    match plays[0] {
        "slot 0: old plays" => "old",
        "slot 0: new plays" => "new",
        line if line.ends_with("the built-in kit plays") => "built-in",
        line => panic!("{line}"),
    }
}

/// Loses power at places of an upload over an old kit, `within` operations and between them, and
/// counts the kits that the next starts play.
fn upload_loses_power_at(board: Board, places: usize) {
    let (history, first) = uploads(board);
    let count = history.operations.len() - first;
    let mut found = std::collections::BTreeMap::new();
    let mut newest = false;
    for place in 0..places {
        let nth = first + (place * (count - 1)) / (places - 1).max(1);
        let torn = history.torn(nth, place as u64).unwrap();
        let kit = kit_after_start(board, torn);
        *found.entry(kit).or_insert(0) += 1;
        assert!(kit != "built-in" || board == Board::BlackpillF411, "place {nth}");
        assert!(kit != "old" || !newest, "place {nth}: the new kit is gone again");
        newest |= kit == "new";
    }
    println!("{}: power lost at {places} places of an upload: {found:?}", board.name());
    assert_eq!(kit_after_start(board, history.before(usize::MAX)), "new");
    assert_eq!(kit_after_start(board, history.before(first)), "old");
}

#[test]
fn power_lost_within_an_upload_leaves_the_old_kit_or_the_new_one() {
    for board in Board::ALL {
        upload_loses_power_at(board, 5);
    }
}

/// `cargo test -p virtual-board --test boards storage -- --ignored --nocapture`.
#[test]
#[ignore = "takes minutes; the test of 5 places runs always"]
fn power_lost_at_500_places_of_an_upload_leaves_the_old_kit_or_the_new_one() {
    for board in Board::ALL {
        upload_loses_power_at(board, 500);
    }
}

/// Erases the flash of an upload, and loses power within that erase.
fn erase_loses_power(board: Board, seeds: u64) {
    let (history, first) = uploads(board);
    for seed in 0..seeds {
        let kit = kit_after_start(board, history.torn(first, seed).unwrap());
        let expected = if board == Board::Stm32f407gDisc1 { "old" } else { "built-in" };
        assert_eq!(kit, expected, "seed {seed}");
    }
}

#[test]
fn power_lost_within_an_erase_leaves_the_old_kit_or_says_it_is_gone() {
    for board in Board::ALL {
        erase_loses_power(board, 2);
    }
}

/// `cargo test -p virtual-board --test boards storage -- --ignored --nocapture`.
#[test]
#[ignore = "takes minutes; the test of 2 erases runs always"]
fn power_lost_in_100_erases_leaves_the_old_kit_or_says_it_is_gone() {
    for board in Board::ALL {
        erase_loses_power(board, 100);
    }
}

/// Writes the channel 1, 2, 3 ... and loses power at places of these writes.
fn settings_lose_power_at(places: usize) {
    let board = Board::BlackpillF411;
    let mut session = Session::start(board, Setup::default());
    let mut ends = Vec::new();
    for n in 0..16 {
        let value = Some(Value::Count(1 + n));
        assert_eq!(session.ask(Request::Set { key: Key::Channel, value }), Ok(Answer::Done));
        ends.push(session.board.flash_history().operations.len());
    }
    let history = session.board.flash_history();
    let first = ends[0];
    for place in 0..places {
        let nth = first + place % (history.operations.len() - first);
        let setup = Setup { flash: history.torn(nth, place as u64), ..Setup::default() };
        let mut again = Session::start(board, setup);
        let Ok(Answer::Setting { value: Some(Value::Count(channel)), .. }) =
            again.ask(Request::Get { key: Key::Channel })
        else {
            panic!("operation {nth}: the setting is gone")
        };
        // Writes that had ended, each of which counts by one.
        let old = ends.iter().filter(|&&end| end <= nth).count() as u8;
        assert!(channel == old || channel == old + 1, "operation {nth}: channel {channel} instead of {old}");
    }
    println!("power lost at {places} places of writes of a setting: the old value or the new one each time");
}

#[test]
fn power_lost_within_a_write_of_a_setting_leaves_the_old_value_or_the_new_one() {
    settings_lose_power_at(5);
}

/// `cargo test -p virtual-board --test boards storage -- --ignored --nocapture`.
#[test]
#[ignore = "takes minutes; the test of 5 places runs always"]
fn power_lost_at_500_places_of_writes_leaves_the_old_value_or_the_new_one() {
    settings_lose_power_at(500);
}
