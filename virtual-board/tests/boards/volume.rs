//! Volume of the headphones: the kit sets it, and holding the button changes it.

use virtual_board::{Board, Press, Report, Setup};

use crate::common;
use crate::played::heard_and_rendered_as_board;

/// Returns the levels in dB that the headphones had after a time, left and right being equal.
fn levels_after(report: &Report, from_s: f64) -> Vec<f64> {
    let mut levels = Vec::new();
    for change in report.volumes.iter().filter(|change| change.at_s >= from_s) {
        let [Some(left), Some(right)] = change.headphones_db else { panic!("mute: {:#?}", report.volumes) };
        // Left is written first.
        if left == right {
            levels.push(left);
        }
    }
    levels
}

fn strikes(report: &Report) -> usize {
    report.log.iter().filter(|line| line.message.starts_with("event ") && line.message.ends_with("strike")).count()
}

#[test]
fn the_kit_sets_the_volume_and_a_kit_without_it_plays_12_db_down() {
    let mut quiet = kit::open("demo").unwrap().kit;
    quiet.headphone_db = Some(-30.5);
    let quiet = kit::binary::build(&quiet).unwrap();
    for (kit, level) in [(quiet, -30.5), (kit::open("demo").unwrap().binary, -12.0)] {
        let running = common::run(Board::Stm32f407gDisc1, &Setup { kit, ..Setup::default() }, 0.35);
        let report = running.report().unwrap();
        let last = report.volumes.last().unwrap();
        assert_eq!(last.headphones_db, [Some(level); 2], "{:#?}", report.volumes);
        assert!(report.codec_complaints.is_empty(), "{:#?}", report.codec_complaints);
    }
}

/// The first press is short and strikes alone. The second is held for 1.7 s, the third for 1 s.
fn presses() -> Vec<Press> {
    let press = |(at_s, for_s)| Press { at_s, for_s, bounce_s: 5e-3 };
    [(0.4, 0.1), (0.8, 1.7), (2.9, 1.0)].map(press).to_vec()
}

#[test]
fn a_held_button_strikes_once_and_turns_the_headphones_down_then_up() {
    let setup = Setup { presses: presses(), ..Setup::default() };
    let report = common::run(Board::Stm32f407gDisc1, &setup, 4.1).report().unwrap();
    println!("{:?}", report.volumes);
    assert_eq!(levels_after(&report, 0.5), [-15.0, -18.0, -21.0, -24.0, -21.0, -18.0], "{:#?}", report.volumes);
    assert_eq!(strikes(&report), 3);
    let first_s = report.volumes.iter().find(|change| change.at_s > 0.5).unwrap().at_s;
    assert!((1.4..1.45).contains(&first_s), "{first_s}");
    assert!(report.codec_complaints.is_empty(), "{:#?}", report.codec_complaints);
}

/// The converter of this board has no volume, so the engine's level does it.
#[test]
fn a_held_button_turns_the_level_of_the_blackpill_down_and_up() {
    let setup = Setup { presses: presses(), ..Setup::default() };
    let running = common::run(Board::BlackpillF411, &setup, 4.1);
    let report = running.report().unwrap();
    let level = |message: &str| -> Option<f64> {
        let fields: Vec<&str> = message.strip_prefix("event ")?.split(',').collect();
        (*fields.last()? == "level").then(|| 20.0 * fields[2].parse::<f64>().unwrap().log10())
    };
    let levels: Vec<f64> = report.log.iter().filter_map(|line| level(&line.message)).collect();
    println!("{levels:.2?}");
    let expected = [-3.0, -6.0, -9.0, -12.0, -9.0, -6.0];
    assert!(levels.len() == expected.len(), "{levels:?}");
    assert!(levels.iter().zip(expected).all(|(level, expected)| (level - expected).abs() < 0.01), "{levels:?}");
    assert_eq!(strikes(&report), 3);
    let kit = kit::open("demo").unwrap().binary;
    let ([heard, rendered], _) = heard_and_rendered_as_board(&running, Board::BlackpillF411, &kit);
    let frames = heard.len().min(rendered.len());
    assert!(frames > 3 * 48_000);
    assert!(heard[..frames] == rendered[..frames], "the sound is not that of the events in the log");
}
