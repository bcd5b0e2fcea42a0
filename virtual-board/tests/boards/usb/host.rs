//! Hosts that come and go, sleep, or do not care: sound goes on, and the board is there again.

use super::{CONFIGURED_S, NOTE, assert_sound, host, note, notes, played, received, run};
use crate::common;
use crate::hits::signal;
use virtual_board::{Board, Fault, Setup, UsbAction, UsbHost};

/// Time from a plug to the end of the enumeration, with a reserve.
const ENUMERATION_S: f64 = 0.2;

fn send(packets: &[[u8; 4]]) -> UsbAction {
    UsbAction::Send(packets.as_flattened().to_vec())
}

/// Replugs the cable 20 times amid notes, or as often as the environment variable `REPLUGS` says,
/// at different places of frames and transfers.
#[test]
fn cable_replugged_amid_notes_misses_no_half_and_is_heard_again_each_time() {
    let times = std::env::var("REPLUGS").ok().and_then(|times| times.parse().ok()).unwrap_or(20);
    for board in Board::ALL {
        replug(board, times);
    }
}

fn replug(board: Board, times: usize) {
    let mut actions = vec![(CONFIGURED_S, send(&notes(16)))];
    let mut at_s = CONFIGURED_S;
    for n in 0..times {
        // Some of these notes are on the way when the cable is pulled.
        actions.push((at_s + 0.01, send(&notes(40))));
        let pulled_s = at_s + 0.01 + 0.000_173 * (n % 23) as f64;
        actions.push((pulled_s, UsbAction::Unplug));
        actions.push((pulled_s + 0.005, UsbAction::Plug));
        at_s = pulled_s + 0.005 + ENUMERATION_S;
        actions.push((at_s, send(&[note(64 + (n % 63) as u8)])));
    }
    let (_, report) = run(board, host(actions), at_s + 0.02);
    assert_sound(board, &report);
    assert_eq!(report.usb.configured_s.len(), times + 1, "{}", board.name());
    // After each plug the note sounds.
    let played = played(&report);
    for n in 0..times {
        assert!(played.contains(&note(64 + (n % 63) as u8)), "{}: no note after plug {n}", board.name());
    }
}

#[test]
fn host_that_fetches_nothing_is_given_up_and_told_again_after_a_replug() {
    for board in Board::ALL {
        let actions = vec![
            (CONFIGURED_S, UsbAction::Ignore),
            (CONFIGURED_S + 0.5, UsbAction::Unplug),
            (CONFIGURED_S + 0.51, UsbAction::Plug),
            (CONFIGURED_S + 0.51, UsbAction::Listen),
        ];
        let last_s = CONFIGURED_S + 0.51 + ENUMERATION_S;
        let mut hits: Vec<(f64, f32)> = (0..8).map(|n| (CONFIGURED_S + 0.05 * f64::from(n), 0.3)).collect();
        hits.push((last_s, 0.6));
        let piezos = vec![signal(0, last_s + 0.05, &hits)];
        let running = common::run(board, &Setup { usb: host(actions), piezos, ..Setup::default() }, last_s + 0.05);
        let report = running.report().unwrap();
        assert_sound(board, &report);
        // Old notes are gone.
        let [told] = received(&report)[..] else { panic!("{}: {:?}", board.name(), received(&report)) };
        assert_eq!((told[..3].to_vec(), played(&report).last()), (vec![0x09, 0x99, NOTE], Some(&told)));
    }
}

#[test]
fn suspended_bus_resumes_where_it_was() {
    for board in Board::ALL {
        let (before, after) = (notes(3), [note(7)]);
        let actions = vec![
            (CONFIGURED_S, send(&before)),
            (CONFIGURED_S + 0.02, UsbAction::Suspend),
            (CONFIGURED_S + 0.12, UsbAction::Resume),
            (CONFIGURED_S + 0.15, send(&after)),
        ];
        let (_, report) = run(board, host(actions), CONFIGURED_S + 0.18);
        assert_sound(board, &report);
        assert_eq!(report.usb.resets, 1, "{}", board.name());
        assert_eq!(played(&report), [before.as_slice(), &after].concat(), "{}", board.name());
    }
}

#[test]
fn reset_and_request_that_is_broken_off_are_survived() {
    for board in Board::ALL {
        let actions = vec![
            (CONFIGURED_S, UsbAction::BreakOff),
            (CONFIGURED_S + 0.1, send(&notes(1))),
            (CONFIGURED_S + 0.15, UsbAction::Reset),
            (CONFIGURED_S + 0.25, send(&[note(7)])),
        ];
        let (_, report) = run(board, host(actions), CONFIGURED_S + 0.3);
        assert_sound(board, &report);
        assert_eq!(report.usb.configured_s.len(), 3, "{}: {:?}", board.name(), report.usb);
        assert_eq!(played(&report), [notes(1)[0], note(7)], "{}", board.name());
    }
}

#[test]
fn board_that_restarts_is_enumerated_anew() {
    for board in Board::ALL {
        let usb = host(vec![(CONFIGURED_S + 0.5, send(&[note(7)]))]);
        let faults = vec![Fault::Panic { at_s: CONFIGURED_S }];
        let running = common::run(board, &Setup { usb, faults, ..Setup::default() }, CONFIGURED_S + 0.52);
        let report = running.report().unwrap();
        assert_eq!((report.resets.len(), report.usb.configured_s.len()), (1, 2), "{}", board.name());
        assert_eq!(played(&report), [note(7)], "{}", board.name());
    }
}

#[test]
fn load_with_an_idle_host_is_within_one_percent_of_that_without_one() {
    /// Returns the share of time in which the core is awake, from 0.7 to 1.2 s.
    fn busy(board: Board, usb: UsbHost) -> f64 {
        let mut running = common::run(board, &Setup { usb, ..Setup::default() }, 0.7);
        let before = running.report().unwrap();
        running.run_until(1.2).unwrap();
        let after = running.report().unwrap();
        assert_sound(board, &after);
        1.0 - (after.idle_cycles - before.idle_cycles) as f64 / (after.cycles - before.cycles) as f64
    }
    for board in Board::ALL {
        // A charger has no host: nothing happens on the bus.
        let charger = busy(board, UsbHost::default());
        let idle = busy(board, host(vec![]));
        let suspended = busy(board, host(vec![(0.6, UsbAction::Suspend)]));
        let never = busy(board, UsbHost { configures: false, ..host(vec![]) });
        println!(
            "{}: busy for {:.2} % at a charger, {:.2} % with a host, {:.2} % suspended, {:.2} % not configured",
            board.name(),
            100.0 * charger,
            100.0 * idle,
            100.0 * suspended,
            100.0 * never
        );
        for load in [idle, suspended, never] {
            assert!((load - charger).abs() < 0.01, "{}: {load} and {charger}", board.name());
        }
    }
}
