//! A thousand modes in frames and a hundred bands of noise on the F407 board.

use dsp_core::trigger::Settings;
use virtual_board::{Board, CycleCase, Press, Setup};

use crate::common;
use crate::hits::signal;
use crate::load::{STACK_RESERVE, deadline};
use crate::played::heard_and_rendered_as_board;
use crate::replay::assert_same;

/// Returns a kit of one pad with modes at even distances, T60 0.2 to 2 s, and bands of noise.
fn prior(modes: u32, bands: u32) -> kit::Kit {
    let share = |n: u32| f64::from(n.wrapping_mul(2_654_435_761)) / f64::from(u32::MAX);
    let modes = (0..modes).map(|n| {
        let turn = std::f64::consts::TAU * share(n + 77);
        kit::Mode {
            frequency_hz: (21.0 + f64::from(n) * 21.4 + 9.0 * share(n)) as f32,
            decay_per_s: (1000f64.ln() / (0.2 + 1.8 * share(n + 999))) as f32,
            gains: vec![kit::Gain { sine: (2_000.0 * turn.sin()) as f32, cosine: (2_000.0 * turn.cos()) as f32 }],
        }
    });
    let edge = |band: u32| (40.0 * 500f64.powf(f64::from(band) / f64::from(bands))) as f32;
    let mut kit =
        kit::load(std::path::Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/tests/boards/stages.toml"))).unwrap().kit;
    kit.room.clear();
    kit.background = None;
    kit.pads.truncate(1);
    let name = kit.pads[0].object.clone();
    kit.objects.retain(|object| object.name == name);
    let object = &mut kit.objects[0];
    object.modes = modes.collect();
    object.dynamic_filter = None;
    object.biquads = None;
    object.residual = (bands > 0).then(|| kit::Residual {
        seed: 1,
        edges_hz: (0..=bands).map(edge).collect(),
        weight: vec![0.001; bands as usize],
        decay_db_per_s: vec![30.0; bands as usize],
    });
    kit.pads[0].choke_t60_s = 0.0;
    kit
}

/// Plays three strikes of a prior on a board with the worst cycles and the waits of flash, and
/// asserts that no half is missed and that the bits are those of the PC.
///
/// With a hand, a button chokes the pad from the second strike on.
fn plays_whole(board: Board, (modes, bands): (u32, u32), has_hand: bool, most: f64) {
    let strokes = [(1.4, 0.9), (1.8, 0.5), (2.2013, 0.2)];
    let mut kit = prior(modes, bands);
    if has_hand {
        // So slow that all modes ring throughout.
        kit.pads[0].choke_t60_s = 2.0;
        kit.pads[0].trigger = Some(Settings { button: None, choke_button: Some(0), ..Settings::of_unset_pad(0) });
    }
    let kit = kit::binary::build(&kit).unwrap();
    let press = Press { at_s: 1.7, for_s: 0.7, bounce_s: 0.0 };
    let setup = Setup {
        cycles: CycleCase::Worst,
        flash_waits: true,
        piezos: vec![signal(0, 2.5, &strokes)],
        presses: if has_hand { vec![press] } else { vec![] },
        kit: kit.clone(),
        ..Setup::default()
    };
    let running = common::run(board, &setup, 2.5);
    let report = running.report().unwrap();
    let load = report.audio.worst_load.unwrap() / deadline(board);
    let (used, room) = (report.stack_bytes.unwrap(), report.stack_room_bytes.unwrap());
    println!(
        "{}, {modes} modes, {bands} bands: the dearest half took {:.1} % of the time to its deadline; {used} of {room} bytes of stack",
        board.name(),
        100.0 * load
    );
    let (sound, work) = heard_and_rendered_as_board(&running, board, &kit);
    let same = assert_same(board, sound);
    println!("{same} frames with the same bits, {work:?}");
    assert!(
        report.log.iter().all(|line| !line.message.contains("left out") && !line.message.contains("halves missed")),
        "{:#?}",
        report.log
    );
    assert_eq!(report.log.iter().filter(|line| line.message.ends_with(",strike")).count(), 3);
    let hands = if has_hand { 2 } else { 0 };
    let is_of_hand = |message: &str| message.ends_with(",choke") || message.ends_with(",release");
    assert_eq!(report.log.iter().filter(|line| is_of_hand(&line.message)).count(), hands);
    assert_eq!(work[0] > 0, bands > 0);
    assert!(load <= most, "{load:.3} of the time to the deadline");
    assert_eq!((report.audio.late_halves, report.resets.len()), (0, 0));
    assert!(used + STACK_RESERVE <= room, "{used} of {room} bytes of stack");
}

#[test]
fn the_disc1_plays_a_thousand_modes_and_a_hundred_bands_whole() {
    plays_whole(Board::Stm32f407gDisc1, (1025, 100), false, 0.77);
}

#[test]
fn the_disc1_plays_a_thousand_modes_and_fifty_bands_under_a_hand() {
    plays_whole(Board::Stm32f407gDisc1, (1025, 50), true, 0.98);
}

#[test]
fn the_blackpill_plays_five_hundred_modes_whole() {
    plays_whole(Board::BlackpillF411, (500, 0), false, 0.99);
}

#[test]
fn the_blackpill_plays_three_hundred_modes_under_a_hand() {
    plays_whole(Board::BlackpillF411, (300, 0), true, 0.99);
}

#[test]
fn the_blackpill_plays_two_hundred_and_fifty_modes_and_a_hundred_bands_whole() {
    plays_whole(Board::BlackpillF411, (250, 100), false, 0.94);
}
