//! Flash outlives runs, and a loss of power leaves operations torn.

use script::{Line, UNLOCK, erase, insert, program, read, run};
use virtual_board::{Board, Fault, FlashEnding, Setup};

use crate::script;
use Line::{Read, Write};

/// Address in sector 6.
const ADDRESS: u32 = 0x0804_0000;

/// Lines of an erase between words.
fn lines() -> Vec<Line> {
    let parts = [&program(ADDRESS, 0x1111), &program(ADDRESS + 4, 0x2222), &erase(6), &program(ADDRESS, 0x3333)];
    [UNLOCK.as_slice(), &parts.map(|part| part.as_slice()).concat()].concat()
}

#[test]
fn flash_of_one_run_is_that_of_the_next_with_its_wear() {
    for board in Board::ALL {
        let flash = Some(script::flash(board, &lines()));
        let mut first = script::board(board, &Setup { flash, ..Setup::default() }).unwrap();
        first.run_until(1.5).unwrap();
        let mut flash = first.flash();
        assert_eq!(flash.read(ADDRESS, 8), Some(&[0x33, 0x33, 0, 0, 0xff, 0xff, 0xff, 0xff][..]));
        insert(&mut flash, &[UNLOCK.as_slice(), &[Read(ADDRESS)], &erase(6)].concat());
        let mut second = script::board(board, &Setup { flash: Some(flash), ..Setup::default() }).unwrap();
        second.run_until(1.5).unwrap();
        assert_eq!(read(&second), [0x3333]);
        assert_eq!(second.flash().erases()[6], 2);
        assert_eq!(second.report().unwrap().flash.erases[6], 2);
        assert_eq!(second.flash().read(ADDRESS, 4), Some(&[0xff; 4][..]));
    }
}

#[test]
fn flash_is_kept_over_a_reset_of_the_chip() {
    // The script asks for a reset at its end, and so again and again.
    let reset = [Read(ADDRESS), Write(0xe000_ed0c, 0x05fa_0004)];
    let lines = [UNLOCK.as_slice(), &program(ADDRESS, 0x77), &reset].concat();
    let running = run(&lines, &Setup::default(), 0.05).unwrap();
    let report = running.report().unwrap();
    assert!(report.resets.len() > 1 && report.resets.iter().all(|reset| reset.cause == "software"));
    assert_eq!(running.flash().read(ADDRESS, 4), Some(&[0x77, 0, 0, 0][..]));
    assert!(report.warnings.is_empty(), "the same word again changes nothing: {:?}", report.warnings);
}

#[test]
fn history_of_one_run_tells_what_a_loss_of_power_in_another_leaves() {
    let whole = run(&lines(), &Setup::default(), 1.5).unwrap();
    let history = whole.flash_history();
    assert_eq!(history.operations.len(), 4);
    assert!(history.before(4) == whole.flash());
    for (nth, operation) in history.operations.iter().enumerate() {
        for (share, seed) in [(0.0, 1), (0.5, 2), (0.99, 3)] {
            let faults = vec![Fault::PowerLostInFlash { nth: nth as u64, share, seed }];
            let mut lost = run(&lines(), &Setup { faults, ..Setup::default() }, 1.5).unwrap();
            let time_s = if nth == 2 { 1.0 } else { 16e-6 };
            let at_s = lost.power_lost_s().unwrap();
            assert!((at_s - operation.at_s - share * time_s).abs() < 1e-6, "{nth}: {at_s}");
            assert!(lost.flash() == history.torn(nth, seed).unwrap(), "{nth} {seed}");
            let report = lost.report().unwrap();
            assert_eq!((report.power_lost_s, report.flash.torn), (Some(at_s), 1));
            assert_eq!(lost.flash_history().operations[nth].ending, FlashEnding::Torn { seed });
            // Without power nothing happens.
            lost.run_until(3.0).unwrap();
            assert_eq!((lost.power_lost_s(), lost.now_s()), (Some(at_s), at_s));
        }
    }
}

#[test]
fn power_lost_at_a_time_tears_the_operation_that_goes_on_if_there_is_one() {
    let history = run(&lines(), &Setup::default(), 1.5).unwrap().flash_history();
    for (at_s, torn) in [(0.7, true), (1.2, false)] {
        let setup = Setup { faults: vec![Fault::PowerLost { at_s, seed: 9 }], ..Setup::default() };
        let lost = run(&lines(), &setup, 1.5).unwrap();
        assert!((lost.power_lost_s().unwrap() - at_s).abs() < 1e-6);
        let left = if torn { history.torn(2, 9).unwrap() } else { history.before(4) };
        assert!(lost.flash() == left, "{at_s}");
        assert_eq!(lost.report().unwrap().flash.torn, usize::from(torn));
    }
}

#[test]
fn history_replayed_in_steps_is_that_before_each_operation() {
    let history = run(&lines(), &Setup::default(), 1.5).unwrap().flash_history();
    let mut memory = history.start.clone();
    for nth in 0..history.operations.len() {
        assert!(memory == history.before(nth));
        history.replay(&mut memory, nth, nth + 1);
    }
    assert!(memory == history.before(history.operations.len()));
}
