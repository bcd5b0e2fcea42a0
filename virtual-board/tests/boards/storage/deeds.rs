//! Kits by program change, kits that are erased while they play, and the bootloader.

use cable::{Answer, Content, Key, Request, Value};
use virtual_board::{Board, Chip, FlashMemory, Setup, UsbAction};

use super::{Session, kit_of, says};

/// Returns the flash of a board with a kit in each slot.
fn flash_with(kits: &[(u32, &[u8])]) -> FlashMemory {
    let mut flash = FlashMemory::erased(Chip::Stm32F407);
    for (address, kit) in kits {
        flash.write(*address, kit).unwrap();
    }
    flash
}

/// Returns the largest step between two neighbouring samples of the last stream from a frame on.
fn largest_step(session: &Session, from_s: f64, to_s: f64) -> f64 {
    let stream = session.board.streams().pop().unwrap();
    let place = |at_s: f64| (((at_s - stream.start_s) * 48_000.0) as usize).min(stream.frames.len());
    let frames = &stream.frames[place(from_s)..place(to_s)];
    let steps = frames.windows(2).map(|pair| (f64::from(pair[1][0]) - f64::from(pair[0][0])).abs());
    steps.fold(0.0, f64::max) / f64::from(i32::MAX)
}

#[test]
fn program_change_plays_the_kit_of_its_slot_after_a_fade_without_a_click() {
    let (first, second) = (kit_of("first", 0), kit_of("second", 0));
    let flash = flash_with(&[(0x080e_0000, &first), (0x080c_0000, &second)]);
    let mut session = Session::start(Board::Stm32f407gDisc1, Setup { flash: Some(flash), ..Setup::default() });
    session.board.usb(UsbAction::Send(vec![0x09, 0x99, 60, 127]));
    session.run_for(0.1);
    let sounding = largest_step(&session, session.board.now_s() - 0.05, session.board.now_s());
    let asked_s = session.board.now_s();
    for program in [1, 127, 0, 5] {
        session.board.usb(UsbAction::Send(vec![0x0c, 0xc9, program, 0]));
        session.run_for(0.3);
    }
    let ending = largest_step(&session, asked_s, asked_s + 0.05);
    println!("largest step: {sounding:.5} sounding, {ending:.5} in the fade");
    assert!(ending <= 1.05 * sounding && sounding > 0.0);
    let report = session.report();
    let plays: Vec<&str> = says(&report, " plays");
    let expected = ["slot 0: first plays", "slot 1: second plays", "the built-in kit plays", "slot 0: first plays"];
    assert_eq!(plays, expected, "{:#?}", report.log);
    assert!(report.resets.is_empty() && says(&report, "halves missed").is_empty(), "{:#?}", report.log);
}

#[test]
fn kit_that_is_erased_while_it_plays_gives_way_to_the_built_in_kit() {
    let flash = flash_with(&[(0x080e_0000, &kit_of("first", 0))]);
    let mut session = Session::start(Board::Stm32f407gDisc1, Setup { flash: Some(flash), ..Setup::default() });
    assert_eq!(session.ask(Request::Erase { slot: 0 }), Ok(Answer::Done));
    assert_eq!(session.content(0), Content::Empty);
    let report = session.report();
    assert_eq!(says(&report, " plays"), ["slot 0: first plays", "the built-in kit plays"]);
    assert!(report.resets.is_empty(), "{:#?}", report.log);
}

#[test]
fn start_slot_and_level_hold_after_a_restart() {
    let flash = flash_with(&[(0x080e_0000, &kit_of("first", 0)), (0x080c_0000, &kit_of("second", 0))]);
    let mut session = Session::start(Board::Stm32f407gDisc1, Setup { flash: Some(flash), ..Setup::default() });
    for (key, value) in [(Key::StartSlot, Value::Count(1)), (Key::Level, Value::Number(-20.0))] {
        assert_eq!(session.ask(Request::Set { key, value: Some(value) }), Ok(Answer::Done));
    }
    let flash = Some(session.board.flash());
    let mut again = Session::start(Board::Stm32f407gDisc1, Setup { flash, ..Setup::default() });
    again.board.usb(UsbAction::Send(vec![0x09, 0x99, 60, 127]));
    again.run_for(0.1);
    let report = again.report();
    assert_eq!(says(&report, " plays"), ["slot 1: second plays"]);
    assert!(says(&report, ",,0.1,,,level").len() == 1, "{:#?}", report.log);
}

#[test]
fn bootloader_of_the_rom_is_entered_behind_the_answer() {
    for board in Board::ALL {
        let mut session = Session::start(board, Setup::default());
        assert_eq!(session.ask(Request::EnterDfu), Ok(Answer::Done), "{}", board.name());
        let until_s = session.board.now_s() + 0.1;
        let error = session.board.run_until(until_s).unwrap_err().to_string();
        println!("{}: {error}", board.name());
        assert!(error.contains("0x1fff0000"), "{}: {error}", board.name());
    }
}
