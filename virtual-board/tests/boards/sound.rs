//! The sound that leaves the I2S is the sound that `malleus play` makes of the board's own log, bit for bit.

use crate::common;
use crate::hits::signal;
use crate::played::{events, rate};
use crate::replay::{assert_same_bits, strikes};
use dsp_core::event::Action;
use dsp_core::table::Kit;
use virtual_board::{Board, Press, Setup};

/// So many seconds of typical playing: four piezos, 20 dB of velocity, rolls, flams, and the button.
fn typical(seconds: f64) -> Setup {
    let mut hits = [const { Vec::new() }; 4];
    for beat in 0..(4.0 * seconds) as usize {
        let (at_s, piezo) = (0.3 + 0.25 * beat as f64, beat * 7 % 4);
        hits[piezo].push((at_s, 0.1 + 0.02 * (beat % 40) as f32));
        if beat % 8 == 3 {
            // A flam.
            hits[(piezo + 1) % 4].push((at_s + 0.02, 0.4));
        }
        if beat % 10 == 9 {
            // A roll.
            hits[piezo].extend((1..5).map(|stroke| (at_s + 0.04 * f64::from(stroke), 0.3)));
        }
    }
    let piezos = (0..).zip(&mut hits).map(|(piezo, hits)| {
        hits.sort_by(|a, b| a.0.total_cmp(&b.0));
        signal(piezo, seconds + 0.5, hits)
    });
    Setup {
        piezos: piezos.collect(),
        presses: vec![Press { at_s: 4.1, for_s: 0.1, bounce_s: 2e-3 }],
        ..Setup::default()
    }
}

/// Five seconds, or as many as `SECONDS` says.
fn play(board: Board) {
    let seconds = std::env::var("SECONDS").ok().and_then(|seconds| seconds.parse().ok()).unwrap_or(5.0);
    let running = common::run(board, &typical(seconds), seconds + 0.4);
    let kit = kit::open("demo").unwrap().binary;
    let same = assert_same_bits(&running, board, &kit);
    let played = events(&running, &Kit::parse(&kit).unwrap(), rate(board));
    println!("{}: {} strikes, {same} frames with the same bits", board.name(), strikes(&played));
    assert!(strikes(&played) as f64 >= 5.0 * seconds, "{} strikes", strikes(&played));
    assert!(same as f64 >= seconds * rate(board).hz());
}

#[test]
fn seconds_of_playing_on_the_disc1_replay_to_the_same_bits() {
    play(Board::Stm32f407gDisc1);
}

#[test]
fn seconds_of_playing_on_the_blackpill_replay_to_the_same_bits() {
    play(Board::BlackpillF411);
}

#[test]
fn a_second_as_dense_as_the_budget_allows_replays_to_the_same_bits() {
    for board in Board::ALL {
        let piezos = (0..4).map(|piezo| {
            let strokes = (0..30).map(|n| (0.3 + 0.035 * f64::from(n) + 0.003 * piezo as f64, 0.5));
            signal(piezo, 1.5, &strokes.collect::<Vec<_>>())
        });
        let setup = Setup { piezos: piezos.collect(), ..Setup::default() };
        let running = common::run(board, &setup, 1.35);
        let kit = kit::open("demo").unwrap().binary;
        let same = assert_same_bits(&running, board, &kit);
        let played = events(&running, &Kit::parse(&kit).unwrap(), rate(board));
        let sheds = played.iter().filter(|event| matches!(event.action, Action::Shed(_))).count();
        println!("{}: {} strikes, {sheds} sheds, {same} frames", board.name(), strikes(&played));
        assert!(strikes(&played) >= 100, "{}", strikes(&played));
    }
}
