//! Images of both boards build, start, and play at the rate of their clock tree.

use crate::common;
use virtual_board::{Board, BoardError, Setup, VirtualBoard};

/// The button is pressed after the start. The sound of the strike must leave the I2S, and the log
/// must tell the strike.
#[test]
fn each_image_starts_and_plays_its_button() {
    for board in Board::ALL {
        let press = virtual_board::Press { at_s: 0.25, for_s: 0.05, bounce_s: 5e-3 };
        let setup = Setup { presses: vec![press], ..Setup::default() };
        let running = common::run(board, &setup, 0.4);
        let report = running.report().unwrap();
        assert!(report.resets.is_empty() && report.warnings.is_empty(), "{report:#?}");
        assert!(report.codec_complaints.is_empty(), "{:#?}", report.codec_complaints);
        assert_eq!((report.audio.late_halves, report.adc.lost_triggers), (0, 0));
        let strikes =
            report.log.iter().filter(|line| line.message.contains("event ") && line.message.contains("strike"));
        assert_eq!(strikes.count(), 1, "{}: {:#?}", board.name(), report.log);

        let streams = running.streams();
        assert_eq!(streams.len(), 1);
        let frames = &streams[0].frames;
        let pressed = ((press.at_s - streams[0].start_s) * streams[0].rate.as_f64()) as usize;
        assert!(frames[..pressed].iter().all(|frame| *frame == [0; 2]), "{}: sound before the strike", board.name());
        let peak = frames[pressed..].iter().flatten().map(|sample| sample.unsigned_abs()).max().unwrap();
        assert!(peak > 1 << 24, "{}: peak {peak}", board.name());
    }
}

#[test]
fn the_sample_rate_of_each_board_is_that_of_its_clock_tree() {
    for (board, ratio) in [(Board::Stm32f407gDisc1, (86_000_000, 1792)), (Board::BlackpillF411, (48_000, 1))] {
        let running = common::run(board, &Setup::default(), 0.25);
        let streams = running.streams();
        let rate = streams[0].rate;
        assert_eq!(rate.numerator() * ratio.1, ratio.0 * rate.denominator(), "{}: {rate}", board.name());
        // The number of frames that have left by then may differ by one.
        let expected = (0.25 - streams[0].start_s) * rate.as_f64();
        assert!(
            (streams[0].frames.len() as f64 - expected).abs() < 1.5,
            "{}: {}",
            board.name(),
            streams[0].frames.len()
        );
    }
}

/// A PCM5102A that is unmuted before its clocks run, or before its PLL has locked to them, pops.
#[test]
fn the_converter_of_the_blackpill_is_unmuted_1024_frames_behind_its_clocks() {
    let running = common::run(Board::BlackpillF411, &Setup::default(), 0.4);
    let report = running.report().unwrap();
    let [unmuted] = report.mutes.as_slice() else { panic!("{:#?}", report.mutes) };
    let clocks_s = running.streams()[0].start_s;
    println!("clocks from {clocks_s:.4} s on, unmuted at {:.4} s", unmuted.at_s);
    assert!(!unmuted.mute && unmuted.at_s > clocks_s + 1024.0 / 48_000.0);
}

#[test]
fn an_image_for_the_other_chip_is_refused() {
    let elf = common::application(Board::Stm32f407gDisc1);
    let refused = VirtualBoard::new(Board::BlackpillF411, &elf, &Setup::default()).unwrap_err();
    assert!(matches!(refused, BoardError::WrongChip { .. }), "{refused}");
}

#[test]
fn the_worst_cycles_are_more_than_the_nominal_ones() {
    let press = virtual_board::Press { at_s: 0.2, for_s: 0.05, bounce_s: 0.0 };
    let nominal = Setup { presses: vec![press], ..Setup::default() };
    let worst = Setup { cycles: virtual_board::CycleCase::Worst, flash_waits: true, ..nominal.clone() };
    let [nominal, worst] = [nominal, worst].map(|setup| common::run(Board::Stm32f407gDisc1, &setup, 0.3));
    let [a, b] = [&nominal, &worst].map(|running| running.report().unwrap());
    assert!(a.idle_share > b.idle_share, "{} {}", a.idle_share, b.idle_share);
    assert_eq!(b.audio.late_halves, 0);
}
