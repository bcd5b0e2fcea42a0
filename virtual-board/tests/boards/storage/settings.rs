//! Settings: they hold at once, outlive a restart, and wear the flash little.

use cable::{Answer, Key, Request, Value};
use virtual_board::{Board, Chip, Fault, FlashMemory, Setup};

use super::{CONFIGURED_S, Session, says};

/// Numbers of the two sectors that hold the settings.
const SECTORS: [usize; 2] = [1, 2];

fn get(session: &mut Session, key: Key) -> Option<Value> {
    match session.ask(Request::Get { key }).unwrap() {
        Answer::Setting { value, .. } => value,
        other => panic!("{other:?}"),
    }
}

fn set(session: &mut Session, key: Key, value: Option<Value>) {
    assert_eq!(session.ask(Request::Set { key, value }), Ok(Answer::Done), "{key:?}");
}

#[test]
fn settings_outlive_a_restart_and_removed_ones_are_gone() {
    let values = [
        (Key::Threshold { piezo: 3 }, Value::Number(0.02)),
        (Key::Curve { piezo: 0 }, Value::Number(1.5)),
        (Key::Channel, Value::Count(3)),
        (Key::Level, Value::Number(-6.0)),
    ];
    for board in Board::ALL {
        let mut session = Session::start(board, Setup::default());
        for (key, value) in values {
            assert_eq!(get(&mut session, key), None, "{}: {key:?}", board.name());
            set(&mut session, key, Some(value));
        }
        set(&mut session, Key::Channel, None);
        let flash = session.board.flash();
        let mut again = Session::start(board, Setup { flash: Some(flash), ..Setup::default() });
        for (key, value) in values {
            let expected = Some(value).filter(|_| key != Key::Channel);
            assert_eq!(get(&mut again, key), expected, "{}: {key:?}", board.name());
        }
        assert!(again.report().resets.is_empty());
    }
}

/// `cargo test -p virtual-board --test boards storage -- --ignored --nocapture`.
#[test]
#[ignore = "takes minutes; a sector is full after 1160 writes, so that no smaller test erases one"]
fn settings_written_2000_times_wear_no_sector_more_than_100_erases() {
    let mut session = Session::start(Board::BlackpillF411, Setup::default());
    let mut longest_s = 0.0f64;
    for n in 0..2000 {
        let asked_s = session.board.now_s();
        set(&mut session, Key::StartSlot, Some(Value::Count(0)).filter(|_| n % 2 == 0));
        longest_s = longest_s.max(session.board.now_s() - asked_s);
    }
    let (flash, report) = (session.board.flash(), session.report());
    let erases = SECTORS.map(|sector| flash.erases()[sector]);
    println!("2000 writes: {erases:?} erases, the slowest answer within {:.0} ms", 1e3 * longest_s);
    assert!(report.resets.is_empty() && says(&report, "halves missed").is_empty(), "{:#?}", report.log);
    // A write that finds its sector full moves the values to the other one, and erases.
    assert!(erases.iter().all(|&count| count <= 4) && longest_s <= 1.0);
}

#[test]
fn sectors_with_other_content_are_erased_and_the_board_plays() {
    let mut flash = FlashMemory::erased(Chip::Stm32F411);
    let code: Vec<u8> = (0..0x8000u32).map(|n| (n.wrapping_mul(2_654_435_761) >> 13) as u8).collect();
    flash.write(0x0800_4000, &code).unwrap();
    let mut session = Session::start(Board::BlackpillF411, Setup { flash: Some(flash), ..Setup::default() });
    set(&mut session, Key::Channel, Some(Value::Count(5)));
    assert_eq!(get(&mut session, Key::Channel), Some(Value::Count(5)));
    assert!(session.report().resets.is_empty());
}

#[test]
fn flash_that_fails_refuses_a_setting_by_name_and_the_old_value_holds() {
    let setup = Setup { faults: vec![Fault::FlashError { nth: 12 }], ..Setup::default() };
    let mut session = Session::start(Board::BlackpillF411, setup);
    let mut refused = 0;
    let mut holds = None;
    for n in 0..10u8 {
        let value = Some(Value::Count(1 + n));
        match session.ask(Request::Set { key: Key::Channel, value }) {
            Ok(_) => holds = value,
            Err(error) => {
                println!("refused: {error}");
                refused += 1;
            }
        }
        assert_eq!(get(&mut session, Key::Channel), holds);
    }
    assert_eq!(refused, 1);
    assert!(session.board.now_s() > CONFIGURED_S);
}
