//! Signals at piezos, and what a board's log says was played.

use std::path::Path;

use dsp_core::SampleRate;
use dsp_core::engine::Skipping;
use dsp_core::event::{Action, Event};
use dsp_core::table::Kit;
use malleus::events::csv;
use malleus::render::{Output, Performance, Settings, render};
use malleus::wave::read_force;
use virtual_board::{Board, PiezoSignal, VirtualBoard};

/// The rate of the signals, Hz.
pub(crate) const SIGNAL_HZ: f64 = 48_000.0;
/// The recorded force that gives hits their shape, where it is there.
const RECORDING: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../shared/data/hammer/hammer_ceramic.wav");
/// A hit in it, in seconds.
const HIT_S: f64 = 0.4047;

/// What a piezo gives under a hit of peak 1: the shape of a hammer's force, as recorded or (said plainly) a half-sine, that makes the disc ring.
pub(crate) fn hit() -> Vec<f32> {
    let force = match Path::new(RECORDING).exists() {
        true => {
            let recorded = read_force(Path::new(RECORDING), 1).unwrap();
            let from = ((HIT_S - 0.001) * recorded.rate.hz()) as usize;
            recorded.samples[from..from + 200].iter().map(|&sample| sample as f32).collect()
        }
        false => {
            println!("ABSENT: {RECORDING}: hits have the shape of a half-sine");
            (0..24).map(|n| (std::f32::consts::PI * n as f32 / 24.0).sin()).collect::<Vec<f32>>()
        }
    };
    // A disc on a pad: 1.1 kHz, gone after 30 ms.
    let ring: Vec<f32> = (0..1500)
        .map(|n| (-(n as f32) / 280.0).exp() * (std::f32::consts::TAU * 1100.0 * n as f32 / SIGNAL_HZ as f32).sin())
        .collect();
    let mut hit = vec![0.0f32; force.len() + ring.len()];
    for (at, force) in force.iter().enumerate() {
        hit[at..].iter_mut().zip(&ring).for_each(|(hit, ring)| *hit += force * ring);
    }
    let peak = hit.iter().fold(0.0f32, |peak, x| peak.max(x.abs()));
    hit.iter().map(|x| x / peak).collect()
}

/// A piezo's signal of so many seconds: hits (time in seconds, peak).
pub(crate) fn signal(piezo: usize, seconds: f64, hits: &[(f64, f32)]) -> PiezoSignal {
    let shape = hit();
    let mut samples = vec![0.0f32; (seconds * SIGNAL_HZ) as usize];
    for &(at_s, peak) in hits {
        let from = (at_s * SIGNAL_HZ) as usize;
        samples[from..].iter_mut().zip(&shape).for_each(|(sample, x)| *sample += peak * x);
    }
    PiezoSignal { piezo, start_s: 0.0, rate_hz: SIGNAL_HZ, samples }
}

/// A board's true rate.
pub(crate) fn rate(board: Board) -> SampleRate {
    match board {
        Board::Stm32f407gDisc1 => SampleRate::new(86_000_000, 1792).unwrap(),
        Board::BlackpillF411 => SampleRate::HZ_48000,
    }
}

/// The events that the log tells, as an events file's.
pub(crate) fn events(running: &VirtualBoard, kit: &Kit<'_>, rate: SampleRate) -> Vec<Event> {
    let mut file = String::from("sample,pad,velocity,position,striker,action\n");
    for line in running.report().unwrap().log {
        if let Some(event) = line.message.strip_prefix("event ") {
            file += event;
            file.push('\n');
        }
    }
    csv::parse(file.as_bytes(), kit, rate).unwrap().events
}

pub(crate) fn strikes(events: &[Event]) -> usize {
    events.iter().filter(|event| event.action == Action::Strike).count()
}

/// What leaves the I2S against what `malleus play` renders for the log's events: the frames that were compared, all of which must be the
/// same. The stream begins before the engine does: both are laid over each other at their first sound.
pub(crate) fn assert_same_bits(running: &VirtualBoard, board: Board, kit: &[u8]) -> usize {
    let (kit, rate) = (Kit::parse(kit).unwrap(), rate(board));
    let streams = running.streams();
    let [stream] = streams.as_slice() else { panic!("{} streams", streams.len()) };
    assert_eq!((stream.underruns, stream.unconnected_frames), (0, 0));
    // The last ones may have been played before they were logged.
    let played: Vec<[i32; 2]> = stream.frames.iter().map(|frame| frame.map(|slot| slot >> 8)).collect();
    assert!(stream.frames.iter().flatten().all(|slot| slot & 0xFF == 0), "24 bits at the top of 32");
    let events = events(running, &kit, rate);
    let performance = Performance { events, direct: None, frames: played.len() };
    let settings = Settings { rate, block: 32, skipping: Skipping::On, budget_cycles: None };
    let expected = render(&kit, &performance, settings, Output::Samples24, |_| {}).unwrap();
    let first = |frames: &[[i32; 2]]| frames.iter().position(|frame| *frame != [0; 2]);
    let (Some(heard), Some(rendered)) = (first(&played), first(&expected)) else { panic!("silence") };
    let same = played[heard..].iter().zip(&expected[rendered..]).take_while(|(a, b)| a == b).count();
    let compared = played.len() - heard;
    // A strike whose line was still under way at the end is missing in the log.
    let margin = (0.01 * rate.hz()) as usize;
    assert!(same + margin >= compared, "{}: frame {same} of {compared} differs", board.name());
    same
}
