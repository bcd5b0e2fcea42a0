//! Sound that leaves the I2S against the sound that `malleus play` makes of the board's log, bit
//! for bit.

use crate::common;
use crate::hits::signal;
use crate::played::{events, heard_and_decided_as_board, heard_and_rendered_as_board, rate};
use crate::replay::{assert_same, assert_same_bits, strikes};
use dsp_core::event::Action;
use dsp_core::table::Kit;
use virtual_board::{Board, Press, Setup};

/// Returns `seconds` seconds of typical playing: four piezos, 20 dB of velocity, rolls, flams, and
/// the button.
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

/// Plays for five seconds, or as many as the environment variable `SECONDS` says.
fn play(board: Board) {
    let seconds = std::env::var("SECONDS").ok().and_then(|seconds| seconds.parse().ok()).unwrap_or(5.0);
    let running = common::run(board, &typical(seconds), seconds + 1.4);
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

/// Returns a kit of four pads with 40 modes each, spread over the spectrum. No board has time for
/// all of them while all pads are struck.
fn four_large_pads() -> Vec<u8> {
    let demo = kit::open("demo").unwrap().kit;
    let object = |pad: u8| {
        let mode = |mode: u8| kit::Mode {
            frequency_hz: 150.0 + 180.0 * f32::from(mode) + 11.0 * f32::from(pad),
            decay_per_s: 6.0 + 0.2 * f32::from(mode),
            gains: vec![kit::Gain { sine: 40.0 / (1.0 + f32::from(mode)), cosine: 0.0 }],
        };
        kit::Object {
            name: format!("large {pad}"),
            source: String::new(),
            licence: String::new(),
            reference_force: 1.0,
            acceleration: kit::Acceleration::NONE,
            modes: (0..40).map(mode).collect(),
            residual: None,
            dynamic_filter: None,
            biquads: None,
            surface: None,
        }
    };
    let striker = kit::Striker { name: "stick".to_owned(), peak_force: 1.0, modes: vec![], ..demo.strikers[0].clone() };
    let pad = |object: &kit::Object| kit::Pad {
        name: object.name.clone(),
        object: object.name.clone(),
        strikers: vec![striker.name.clone()],
        midi_notes: vec![],
        note_off: kit::NoteOff::Nothing,
        choke_t60_s: 0.0,
        trigger: None,
        ..demo.pads[0].clone()
    };
    let objects: Vec<kit::Object> = (0..4).map(object).collect();
    let pads = objects.iter().map(pad).collect();
    let kit = kit::Kit { name: "large".to_owned(), objects, strikers: vec![striker.clone()], pads, ..demo.clone() };
    kit::binary::build(&kit).unwrap()
}

#[test]
fn a_board_that_sheds_plays_the_bits_and_decisions_of_play_board_on_the_pc() {
    for board in Board::ALL {
        let piezos = (0..4).map(|piezo| {
            let strokes = (0..6).map(|n| (0.4 + 0.07 * f64::from(n) + 0.003 * piezo as f64, 0.7));
            signal(piezo, 1.0, &strokes.collect::<Vec<_>>())
        });
        let kit = four_large_pads();
        let setup = Setup { piezos: piezos.collect(), kit: kit.clone(), ..Setup::default() };
        let running = common::run(board, &setup, 1.0);
        let (sounds, [told, decided]) = heard_and_decided_as_board(&running, board, &kit);
        let same = assert_same(board, sounds);
        let sheds = told.iter().filter(|event| matches!(event.action, Action::Shed(_))).count();
        println!("{}: {} strikes, {sheds} sheds, {same} frames with the same bits", board.name(), strikes(&told));
        assert!(sheds > 0 && strikes(&told) >= 20, "{}: {sheds} sheds", board.name());
        assert_eq!(told, decided, "{}", board.name());
        assert!(same > 20_000, "{}: {same} frames", board.name());
    }
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

/// Kit `shapes` with four of its pads before the piezos.
fn four_shapes(names: [&str; 4]) -> Vec<u8> {
    let mut kit = kit::open("shapes").unwrap().kit;
    kit.pads.retain(|pad| names.contains(&pad.name.as_str()));
    kit.pads.sort_by_key(|pad| names.iter().position(|name| *name == pad.name));
    assert_eq!(kit.pads.len(), 4);
    kit::binary::build(&kit).unwrap()
}

#[test]
fn bodies_by_finite_elements_sound_on_boards_with_the_bits_of_the_pc() {
    for (board, names) in [
        (Board::Stm32f407gDisc1, ["marimba", "bell", "glockenspiel", "drum"]),
        (Board::BlackpillF411, ["glass", "woodblock", "gong", "vibraphone"]),
    ] {
        let kit = four_shapes(names);
        let piezos = (0..4).map(|piezo| signal(piezo, 0.8, &[(0.4 + 0.06 * piezo as f64, 0.8)]));
        let setup = Setup { piezos: piezos.collect(), kit: kit.clone(), ..Setup::default() };
        let running = common::run(board, &setup, 0.8);
        let (sounds, _) = heard_and_rendered_as_board(&running, board, &kit);
        let same = assert_same(board, sounds);
        let played = events(&running, &Kit::parse(&kit).unwrap(), rate(board));
        println!("{}: {} strikes, {same} frames with the same bits", board.name(), strikes(&played));
        assert_eq!(strikes(&played), 4, "{}", board.name());
        assert!(same as f64 > 0.35 * rate(board).hz(), "{}: {same} frames", board.name());
    }
}
