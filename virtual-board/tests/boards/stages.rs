//! Residuals, filters and the room on the boards: the bits of the PC, no missed deadline, no time
//! spent in silence, and a start before the watchdog bites.

use std::path::Path;

use virtual_board::{Board, CycleCase, Report, Setup};

use crate::common;
use crate::hits::signal;
use crate::load::{STACK_RESERVE, busy, deadline};
use crate::played::heard_and_rendered_as_board;
use crate::replay::assert_same;

/// Returns a kit with a pad of a residual, one of loops round a dynamic filter, one of biquads, and
/// a room.
fn stages() -> kit::Kit {
    kit::load(Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/tests/boards/stages.toml"))).unwrap().kit
}

/// Plays a storm of strikes with the worst cycles and the waits of flash, and asserts that no
/// deadline is missed and that the bits are those of the PC.
///
/// Each piezo is struck every 35 ms, 3 ms after the piezo before it. Then all rings. Returns the
/// work of the board's engine on the PC: frames of residuals, dynamic filters, loops, biquads and
/// the room, and the number of stages that were refused.
fn storm(board: Board, kit: &kit::Kit) -> [u32; 6] {
    let piezos = (0..4).map(|piezo| {
        let strokes = (0..12).map(|n| (0.4 + 0.035 * f64::from(n) + 0.003 * piezo as f64, 0.9));
        signal(piezo, 1.0, &strokes.collect::<Vec<_>>())
    });
    let kit = kit::binary::build(kit).unwrap();
    let setup = Setup {
        cycles: CycleCase::Worst,
        flash_waits: true,
        piezos: piezos.collect(),
        kit: kit.clone(),
        ..Setup::default()
    };
    let running = common::run(board, &setup, 1.0);
    let report = running.report().unwrap();
    let load = report.audio.worst_load.unwrap() / deadline(board);
    let (sound, work) = heard_and_rendered_as_board(&running, board, &kit);
    let same = assert_same(board, sound);
    let (used, room) = (report.stack_bytes.unwrap(), report.stack_room_bytes.unwrap());
    println!(
        "{}: the dearest half took {:.1} % of the time to its deadline; loaded in {:.3} s; {used} of {room} bytes of stack; {same} frames with the same bits, {work:?}",
        board.name(),
        100.0 * load,
        loaded_at_s(&report)
    );
    assert!(load <= 0.95, "{}: {load:.3} of the time to the deadline", board.name());
    assert!(
        !says(&report, "missed")
            || report.log.iter().all(|line| line.level != "warn" || !line.message.contains("missed"))
    );
    assert_eq!((report.audio.late_halves, report.resets.len()), (0, 0), "{}", board.name());
    assert!(used + STACK_RESERVE <= room, "{}: {used} of {room} bytes of stack", board.name());
    assert!(same as f64 > 0.5 * 47_000.0);
    work
}

fn says(report: &Report, words: &str) -> bool {
    report.log.iter().any(|line| line.message.contains(words))
}

/// Returns the time at which the kit of the sector was ready, in seconds.
fn loaded_at_s(report: &Report) -> f64 {
    let line = report.log.iter().find(|line| line.message.starts_with("slot 0: ") && line.message.ends_with(" plays"));
    line.unwrap_or_else(|| panic!("{:#?}", report.log)).at_s
}

#[test]
fn the_disc1_plays_residual_loops_and_room_in_a_storm_with_the_bits_of_the_pc() {
    let [residual, filters, loops, biquads, room, _] = storm(Board::Stm32f407gDisc1, &stages());
    assert!(residual > 0 && filters > 0 && loops > 0 && room > 0);
    // The board has no time for the biquads beside these stages.
    assert_eq!(biquads, 0);
}

#[test]
fn the_disc1_plays_loops_and_biquads_in_a_storm_with_the_bits_of_the_pc() {
    let mut kit = stages();
    kit.pads.remove(0);
    kit.room.clear();
    let [_, _, loops, biquads, _, refused] = storm(Board::Stm32f407gDisc1, &kit);
    assert!(loops > 0 && biquads > 0 && refused == 0);
}

#[test]
fn the_blackpill_plays_a_residual_in_a_storm_with_the_bits_of_the_pc() {
    let [residual, ..] = storm(Board::BlackpillF411, &stages());
    assert!(residual > 0);
}

#[test]
fn the_blackpill_plays_loops_in_a_storm_with_the_bits_of_the_pc() {
    let mut kit = stages();
    kit.pads.truncate(2);
    (kit.objects[0].residual, kit.room) = (None, Vec::new());
    let [_, filters, loops, ..] = storm(Board::BlackpillF411, &kit);
    assert!(filters > 0 && loops > 0);
}

#[test]
fn a_board_with_stages_is_busy_for_at_most_a_twentieth_of_time_in_silence() {
    let kit = kit::binary::build(&stages()).unwrap();
    for board in Board::ALL {
        let silent = busy(board, &Setup { kit: kit.clone(), ..Setup::default() });
        println!("{}: busy for {:.2} % of its time in silence", board.name(), 100.0 * silent);
        assert!(silent <= 0.05, "{}: {silent}", board.name());
    }
}

/// Two pads have as many loops and breakpoints as a fit writes, round a filter of the second order.
#[test]
fn the_longest_tables_are_derived_before_the_watchdog_bites() {
    let mut kit = stages();
    let looped = &mut kit.objects[1];
    let filter = looped.dynamic_filter.as_mut().unwrap();
    let point = |n: u8| {
        let t = f32::from(n) / 31.0;
        // The poles are a conjugate pair that moves slowly. The loops pass so little that all is
        // stable.
        kit::Breakpoint { time_s: 2.0 * t, noise: 1.0, a1: -1.2 - 0.2 * t, a2: 0.72, b0: 0.1, b1: 0.02, b2: 0.01 }
    };
    filter.order = kit::Order::Second;
    filter.path = (0..32).map(point).collect();
    filter.loops = (0..10u8)
        .map(|n| {
            let frequency_hz = 150.0 * 1.5f32.powi(n.into());
            kit::Loop { frequency_hz, bandwidth_hz: 4.0, gain: 0.09, delay_s: 1.0 / frequency_hz.min(1_000.0) }
        })
        .collect();
    let pad = kit::Pad { name: "again".to_owned(), midi_notes: Vec::new(), ..kit.pads[1].clone() };
    kit.pads.push(pad);
    let kit = kit::binary::build(&kit).unwrap();
    for board in Board::ALL {
        let setup = Setup { cycles: CycleCase::Worst, flash_waits: true, kit: kit.clone(), ..Setup::default() };
        let report = common::run(board, &setup, 3.0).report().unwrap();
        println!("{}: two pads with ten loops and 32 breakpoints each: {:.2} s", board.name(), loaded_at_s(&report));
        assert!(report.resets.is_empty(), "{:#?}", report.resets);
        // Five such pads must load within the watchdog's shortest time on silicon, 5.6 s.
        assert!(loaded_at_s(&report) < 5.6 * 2.0 / 5.0, "{:.2} s", loaded_at_s(&report));
    }
}
