//! A song over MIDI while piezos are played: bit for bit what the PC plays, each note in time, and
//! the host is told of the piezos.

use super::{CONFIGURED_S, assert_sound, host, received};
use crate::common;
use crate::hits::signal;
use crate::load::deadline;
use crate::played::heard_and_rendered_as_board;
use crate::replay::assert_same;
use crate::timing;
use virtual_board::{Board, CycleCase, LogLine, Setup, UsbAction};

fn send(at_s: f64, packets: &[[u8; 4]]) -> (f64, UsbAction) {
    (at_s, UsbAction::Send(packets.as_flattened().to_vec()))
}

/// Returns a song of `count` notes with positions, levels, hands and other messages between them,
/// and the time of its end in seconds.
fn song(count: usize) -> (Vec<(f64, UsbAction)>, f64) {
    let notes = [60u8, 81, 53, 49, 76, 75, 36, 52, 12];
    let mut random = 12_345u32;
    let mut below = |limit: u32| {
        random = random.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (random >> 8) % limit
    };
    let (mut actions, mut at_s) = (Vec::new(), CONFIGURED_S);
    for n in 0..count {
        let key = notes[below(notes.len() as u32) as usize];
        let mut packets = vec![[0x09, 0x99, key, 1 + below(127) as u8]];
        match n % 11 {
            3 => packets.insert(0, [0x0b, 0xb9, 16, below(128) as u8]),
            5 => packets.push([0x0a, 0xa9, key, 64 + below(64) as u8]),
            7 => packets.push([0x0a, 0xa9, key, below(64) as u8]),
            8 => packets.push([0x0b, 0xb9, 7, 64 + below(64) as u8]),
            9 => packets.extend([[0x0f, 0xf8, 0, 0], [0x0e, 0xe9, 0, 64]]),
            10 if n % 33 == 32 => packets.push([0x0b, 0xb9, 120, 0]),
            _ => packets.push([0x08, 0x89, key, 0]),
        }
        actions.push(send(at_s, &packets));
        at_s += 0.02 + 0.03 * f64::from(below(1000)) / 1000.0;
    }
    (actions, at_s)
}

/// Plays a song of `count` notes with two piezos, and asserts that the board plays the bits of the
/// PC for the events of its log.
fn plays_the_bits_of_the_pc(count: usize) {
    for board in Board::ALL {
        let (actions, end_s) = song(count);
        let piezos = (0..2).map(|piezo| {
            let hits = (0..).map(|n| (CONFIGURED_S + 0.1 + 0.31 * f64::from(n) + 0.1 * piezo as f64, 0.4));
            signal(piezo, end_s, &hits.take_while(|(at_s, _)| *at_s < end_s - 0.05).collect::<Vec<_>>())
        });
        let setup = Setup { usb: host(actions), piezos: piezos.collect(), ..Setup::default() };
        let running = common::run(board, &setup, end_s + 0.3);
        let report = running.report().unwrap();
        assert_sound(board, &report);
        let events = |action: &str| report.log.iter().filter(|line| line.message.ends_with(action)).count();
        println!(
            "{}: {} strikes, {} chokes, {} levels, {} silences",
            board.name(),
            events(",strike"),
            events(",choke"),
            events(",level"),
            events(",silence")
        );
        assert!(events(",strike") * 10 > count * 8 && events(",level") > 0 && events(",silence") > 0);
        let told = received(&report).iter().filter(|packet| packet[0] == 0x09).count();
        assert!(told > 0, "{}: the host is told of no hit", board.name());
        let demo = kit::open("demo").unwrap().binary;
        let (sound, _) = heard_and_rendered_as_board(&running, board, &demo);
        let same = assert_same(board, sound);
        println!("{}: {same} frames with the same bits; the host was told of {told} hits", board.name());
    }
}

#[test]
fn song_and_piezos_together_sound_with_the_bits_of_the_pc() {
    plays_the_bits_of_the_pc(120);
}

/// `cargo test -p virtual-board --test boards usb::song -- --ignored --nocapture`.
#[test]
#[ignore = "takes minutes; the test of 120 notes runs always"]
fn song_of_2000_notes_and_piezos_sound_with_the_bits_of_the_pc() {
    plays_the_bits_of_the_pc(2000);
}

/// Notes of ten pads of the demo kit.
fn ten_notes() -> Vec<[u8; 4]> {
    [60, 81, 53, 49, 51, 76, 77, 75, 36, 41].map(|key| [0x09, 0x99, key, 30]).to_vec()
}

/// On the BlackPill three strikes fit into a half, and two behind others: the rest follow in the
/// next halves. With four a storm of notes misses halves.
#[test]
fn ten_notes_of_one_transfer_sound_in_one_frame_or_within_four_halves() {
    for board in Board::ALL {
        let running = common::run(
            board,
            &Setup { usb: host(vec![send(CONFIGURED_S + 0.000_3, &ten_notes())]), ..Setup::default() },
            CONFIGURED_S + 0.1,
        );
        let report = running.report().unwrap();
        assert_sound(board, &report);
        let frame =
            |message: &str| message.strip_prefix("event ")?.strip_suffix(",strike")?.split(',').next()?.parse().ok();
        let frames: Vec<u64> = report.log.iter().filter_map(|line| frame(&line.message)).collect();
        println!("{}: {frames:?}", board.name());
        assert_eq!(frames.len(), 10, "{}: {frames:?}", board.name());
        let (at_once, within) = if board == Board::Stm32f407gDisc1 { (10, 0) } else { (3, 128) };
        assert!(frames.iter().take(at_once).all(|frame| *frame == frames[0]), "{}: {frames:?}", board.name());
        assert!(frames[9] - frames[0] <= within, "{}: {frames:?}", board.name());
    }
}

#[test]
fn ten_notes_of_one_transfer_leave_a_tenth_of_a_half_at_the_worst_pace() {
    // A half takes longer with the notes' frame within it than with that at its beginning.
    let phases = [0.0, 0.25, 0.5, 0.75].map(|share| 0.000_3 + share * 32.0 / 48_000.0);
    for board in Board::ALL {
        let load_of = |after_s: f64| {
            let usb = host(vec![send(CONFIGURED_S + after_s, &ten_notes())]);
            let setup = Setup { usb, cycles: CycleCase::Worst, flash_waits: true, ..Setup::default() };
            let report = common::run(board, &setup, CONFIGURED_S + 0.02).report().unwrap();
            // The BlackPill misses the half with which sound starts, at 0.32 s and this pace.
            let is_missed = |line: &LogLine| line.at_s > 0.4 && line.message.contains("halves missed");
            assert!(!report.log.iter().any(is_missed), "{}: {:#?}", board.name(), report.log);
            assert!(report.audio.late_halves == 0 && report.resets.is_empty(), "{}", board.name());
            report.audio.worst_load.unwrap() / deadline(board)
        };
        let loads = phases.map(load_of);
        println!("{}: the dearest half takes {loads:.3?} of its time", board.name());
        assert!(loads.iter().all(|&load| load <= 0.9), "{}: {loads:?}", board.name());
    }
}

#[test]
fn notes_sound_within_1_5_ms_of_their_transfer_and_0_05_ms_of_each_other() {
    for board in Board::ALL {
        // The places in a half move by the golden section.
        let golden = 0.5 * (5f64.sqrt() - 1.0);
        let place = |n: usize| 32.0 / 48_000.0 * (n as f64 * golden).fract();
        let at_s = |n: usize| CONFIGURED_S + 0.03 * n as f64 + place(n);
        let actions = (0..60).map(|n| send(at_s(n), &[[0x09, 0x99, 60, 64]])).collect();
        let setup = Setup { usb: host(actions), kit: timing::kit(0.001), ..Setup::default() };
        let running = common::run(board, &setup, at_s(60));
        let report = running.report().unwrap();
        assert_sound(board, &report);
        let ended: Vec<f64> = report.usb.sent.iter().map(|transfer| transfer.ended_s).collect();
        assert_eq!(ended.len(), 60);
        let latencies = timing::latencies(&running, &ended);
        let largest = latencies.iter().copied().fold(0.0, f64::max);
        let smallest = latencies.iter().copied().fold(f64::INFINITY, f64::min);
        println!("{}: notes sound {:.3} to {:.3} ms after their transfer", board.name(), 1e3 * smallest, 1e3 * largest);
        assert!(largest <= 1.5e-3 && largest - smallest < 0.05e-3, "{}: {smallest} to {largest} s", board.name());
    }
}

#[test]
fn hits_reach_the_host_within_the_half_in_which_they_are_decided() {
    for board in Board::ALL {
        let hits: Vec<(f64, f32)> = (0..20).map(|n| (CONFIGURED_S + 0.05 + 0.050_13 * f64::from(n), 0.5)).collect();
        let setup = Setup { usb: host(vec![]), piezos: vec![signal(0, 1.7, &hits)], ..Setup::default() };
        let running = common::run(board, &setup, 1.7);
        let report = running.report().unwrap();
        assert_sound(board, &report);
        let told: Vec<f64> = report.usb.received.iter().map(|transfer| transfer.ended_s).collect();
        assert_eq!(told.len(), hits.len(), "{}", board.name());
        // A hit is decided 1.5 ms after its onset, which lies up to 1 ms behind the start of the
        // recording.
        let late = told.iter().zip(&hits).map(|(told, hit)| told - hit.0);
        let (least, most) = late.fold((f64::INFINITY, 0.0f64), |(least, most), x| (least.min(x), most.max(x)));
        println!("{}: the host is told {:.2} to {:.2} ms after a hit begins", board.name(), 1e3 * least, 1e3 * most);
        // A half, and a poll each millisecond.
        assert!(most - least < 1.0e-3 + 32.0 / 48_000.0 + 0.3e-3, "{}: {least} to {most} s", board.name());
    }
}
