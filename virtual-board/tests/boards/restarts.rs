//! Restarts of the sampler and of the I2S at any phase: each piezo goes on to play its own pad, and
//! each half-word leaves in its own slot.

use virtual_board::{Board, Fault, Setup, Stream};

use crate::common;
use crate::hits::signal;

/// Time of the first stall, in s from power-on.
const FIRST_S: f64 = 0.3;
/// Time in which a half plays, in s. A half is 0.12 us longer than 32 frames of the ADC, so that a
/// scan, of which the first begins at a restart, moves by as much against the halves.
const HALF_S: f64 = 32.0 * 1792.0 / 86e6;

/// Times of stalls, each farther from the last one than the one before, until a scan of the ADC and
/// the halves have met at all phases.
fn stalls(count: usize) -> Vec<f64> {
    let mut at_s = FIRST_S;
    let distance = |stall: usize| 70 + 168 * stall / count;
    let next = |stall: usize| {
        let now = at_s;
        at_s += distance(stall) as f64 * HALF_S;
        now
    };
    (0..=count).map(next).collect()
}

/// Plays piezo 1 after each of a number of stalls, and gives the pads that were struck.
///
/// In a stall no half is rendered for 3 ms, so that the ADC goes round its ring, and is started
/// anew. Where its scan is at that moment differs from stall to stall.
fn pads_after_stalls(count: usize) -> Vec<String> {
    let times = stalls(count);
    let (stalls, seconds) = (&times[..count], times[count]);
    let hits: Vec<(f64, f32)> = stalls.iter().map(|at_s| (at_s + 0.02, 0.4)).collect();
    let setup = Setup {
        piezos: vec![signal(1, seconds, &hits)],
        faults: stalls.iter().map(|&at_s| Fault::AudioInterruptLost { at_s, for_s: 3e-3 }).collect(),
        ..Setup::default()
    };
    let report = common::run(Board::Stm32f407gDisc1, &setup, seconds).report().unwrap();
    let restarts = report.log.iter().filter(|line| line.message.contains("halves missed")).count();
    assert!(restarts >= count && report.resets.is_empty(), "{restarts} stalls were noticed: {:#?}", report.resets);
    let strikes = report.log.iter().filter_map(|line| line.message.strip_prefix("event ")?.strip_suffix(",strike"));
    strikes.map(|strike| strike.split(',').nth(1).unwrap_or("").to_owned()).collect()
}

#[test]
fn a_piezo_plays_its_own_pad_after_restarts_of_the_adc_at_any_phase() {
    let demo = kit::open("demo").unwrap().kit;
    let pads = pads_after_stalls(16);
    let own = pads.iter().filter(|pad| **pad == demo.pads[1].name).count();
    println!("{own} of {} strikes play pad 1: {pads:?}", pads.len());
    assert_eq!((own, pads.len()), (16, 16));
}

/// Plays piezo 1 after each of a number of errors of the ADC's DMA and overruns of the ADC, and
/// gives the pads that were struck. Each error comes at another place in a scan and in a half.
fn pads_after_errors(board: Board, count: usize) -> Vec<String> {
    let golden = 0.5 * (5f64.sqrt() - 1.0);
    let at_s = |error: usize| FIRST_S + 0.1 + 0.075 * error as f64 + HALF_S * (error as f64 * golden).fract();
    let seconds = at_s(count);
    let hits: Vec<(f64, f32)> = (0..count).map(|error| (at_s(error) + 0.02, 0.4)).collect();
    let fault = |error: usize| match error % 2 {
        0 => Fault::AdcDmaError { at_s: at_s(error) },
        _ => Fault::AdcOverrun { at_s: at_s(error) },
    };
    let setup =
        Setup { piezos: vec![signal(1, seconds, &hits)], faults: (0..count).map(fault).collect(), ..Setup::default() };
    let report = common::run(board, &setup, seconds).report().unwrap();
    let restarts = report.log.iter().filter(|line| line.message.starts_with("ADC: overrun or DMA error")).count();
    assert!(restarts == count && report.resets.is_empty(), "{restarts} restarts: {:#?}", report.resets);
    let strikes = report.log.iter().filter_map(|line| line.message.strip_prefix("event ")?.strip_suffix(",strike"));
    strikes.map(|strike| strike.split(',').nth(1).unwrap_or("").to_owned()).collect()
}

/// Asserts that the piezo plays its own pad after each of `count` errors.
fn own_pad_plays_after_errors(count: usize) {
    let demo = kit::open("demo").unwrap().kit;
    for board in Board::ALL {
        let pads = pads_after_errors(board, count);
        let own = pads.iter().filter(|pad| **pad == demo.pads[1].name).count();
        println!("{}: {own} of {} strikes play pad 1, {count} errors", board.name(), pads.len());
        assert_eq!((own, pads.len()), (count, count), "{}", board.name());
    }
}

#[test]
fn a_piezo_plays_its_own_pad_after_errors_of_the_adc_and_its_dma_at_any_phase() {
    own_pad_plays_after_errors(16);
}

/// `cargo test -p virtual-board --test boards restarts -- --ignored --nocapture`.
#[test]
#[ignore = "takes minutes; the test of 16 phases runs always"]
fn a_piezo_plays_its_own_pad_after_errors_of_the_adc_and_its_dma_at_1000_phases() {
    own_pad_plays_after_errors(1000);
}

/// Restarts the I2S `count` times while pads ring, each time at another place in a frame, and
/// asserts that each half-word leaves in its own slot.
///
/// Samples have 24 bits, so the low byte of each slot is 0 unless half-words have changed places.
fn half_words_stay_in_their_slots(count: usize) {
    let golden = 0.5 * (5f64.sqrt() - 1.0);
    let at_s = |restart: usize| FIRST_S + 0.1 + 0.01 * restart as f64 + (restart as f64 * golden).fract() / 48_000.0;
    let seconds = at_s(count);
    let hits: Vec<(f64, f32)> =
        (0..).map(|n| (0.38 + 0.25 * f64::from(n), 0.9)).take_while(|(at_s, _)| *at_s < seconds - 0.05).collect();
    for board in Board::ALL {
        let setup = Setup {
            piezos: vec![signal(0, seconds, &hits)],
            faults: (0..count).map(|restart| Fault::AudioDmaError { at_s: at_s(restart) }).collect(),
            ..Setup::default()
        };
        let running = common::run(board, &setup, seconds);
        let streams = running.streams();
        // From the error to the restart the last half-word is sent in all slots.
        let fed = |stream: &Stream| stream.frames.len().saturating_sub(stream.underruns as usize / 4 + 2);
        let is_wrong = |stream: &&Stream| stream.frames[..fed(stream)].iter().flatten().any(|slot| slot & 0xff != 0);
        let wrong = streams.iter().filter(is_wrong).count();
        let sounding = streams.iter().filter(|stream| stream.frames.iter().any(|frame| *frame != [0; 2])).count();
        println!("{}: {wrong} of {} streams have half-words in wrong slots", board.name(), streams.len());
        assert!(streams.len() > count && sounding * 10 > count * 9, "{sounding} of {} streams sound", streams.len());
        assert_eq!(wrong, 0, "{}", board.name());
    }
}

#[test]
fn half_words_stay_in_their_slots_after_restarts_of_the_i2s_at_any_phase() {
    half_words_stay_in_their_slots(20);
}

/// `cargo test -p virtual-board --test boards restarts -- --ignored --nocapture`.
#[test]
#[ignore = "takes minutes; the test of 20 phases runs always"]
fn half_words_stay_in_their_slots_after_restarts_of_the_i2s_at_1000_phases() {
    half_words_stay_in_their_slots(1000);
}

/// `cargo test -p virtual-board --test boards restarts -- --ignored --nocapture`.
#[test]
#[ignore = "takes minutes; the test of 16 phases runs always"]
fn a_piezo_plays_its_own_pad_after_restarts_of_the_adc_at_1000_phases() {
    let demo = kit::open("demo").unwrap().kit;
    let pads = pads_after_stalls(1000);
    let own = pads.iter().filter(|pad| **pad == demo.pads[1].name).count();
    println!("{own} of {} strikes play pad 1", pads.len());
    assert_eq!((own, pads.len()), (1000, 1000));
}
