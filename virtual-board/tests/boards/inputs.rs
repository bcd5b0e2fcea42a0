//! Inputs to which no piezo is wired: the one piezo plays its own pad, and no other pad sounds.

use virtual_board::{Board, PiezoPin, Setup};

use crate::common;
use crate::hits::signal;

/// Time of the first hit, in s from power-on.
const FIRST_S: f64 = 0.5;
/// Time from a hit to the next one, in s.
const APART_S: f64 = 0.075;

/// Plays `hits` hits of all velocities on a piezo whose neighbours are other things, with noise of
/// 2 to 6 counts, and gives the names of the pads that were struck.
fn pads_struck(board: Board, piezo: usize, others: [PiezoPin; 3], hits: usize, noise: f64) -> Vec<String> {
    let seconds = FIRST_S + hits as f64 * APART_S;
    let peak = |hit: usize| 0.06 * (0.9f32 / 0.06).powf((hit * 7 % hits) as f32 / hits as f32);
    let times: Vec<(f64, f32)> = (0..hits).map(|hit| (FIRST_S + hit as f64 * APART_S, peak(hit))).collect();
    let mut pins = others.to_vec();
    pins.insert(piezo, PiezoPin::Circuit);
    let setup =
        Setup { piezos: vec![signal(piezo, seconds, &times)], pins, adc_noise_counts: noise, ..Setup::default() };
    let report = common::run(board, &setup, seconds).report().unwrap();
    for line in report.log.iter().filter(|line| line.message.starts_with("piezo ")) {
        println!("piezo {piezo} beside {others:?}: {}", line.message);
    }
    let strikes = report.log.iter().filter_map(|line| line.message.strip_prefix("event ")?.strip_suffix(",strike"));
    strikes.map(|strike| strike.split(',').nth(1).unwrap_or("").to_owned()).collect()
}

/// Asserts that a piezo alone plays, on each input and beside all kinds of neighbours.
fn its_pad_alone_sounds(hits: usize) {
    use PiezoPin::{Grounded, Open, Wire};
    let pads = kit::open("demo").unwrap().kit.pads;
    let neighbours = [[Open, Grounded, Wire], [Wire, Open, Open], [Grounded, Wire, Open], [Open, Open, Open]];
    for board in Board::ALL {
        for ((piezo, others), noise) in neighbours.into_iter().enumerate().zip([2.0, 6.0, 4.0, 3.0]) {
            let struck = pads_struck(board, piezo, others, hits, noise);
            let own = struck.iter().filter(|pad| **pad == pads[piezo].name).count();
            let case = format!("{}, piezo {piezo} beside {others:?}", board.name());
            println!("{case}: {own} of {} strikes on its pad, {hits} hits", struck.len());
            assert_eq!((own, struck.len()), (hits, hits), "{case}");
        }
    }
}

#[test]
fn a_piezo_beside_open_grounded_and_hanging_inputs_sounds_its_pad_alone() {
    its_pad_alone_sounds(12);
}

/// `cargo test -p virtual-board --test boards inputs -- --ignored --nocapture`: 1000 hits a
/// board.
#[test]
#[ignore = "takes minutes; the test of 48 hits a board runs always"]
fn a_piezo_beside_other_inputs_sounds_its_pad_alone_over_1000_strikes() {
    its_pad_alone_sounds(250);
}
