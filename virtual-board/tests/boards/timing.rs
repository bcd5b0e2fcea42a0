//! Time from a piezo's onset at the pin of the ADC to 10 % of the contact force on the I2S pin.
//!
//! The one object of the kit has an acceleration sound and no modes, so the I2S carries the contact
//! force itself.

use virtual_board::{Board, PiezoSignal, Setup, VirtualBoard};

use crate::common;

/// Sample rate of the signals in Hz.
const SIGNAL_HZ: f64 = 48_000.0;

/// Returns a kit with a pad whose sound is the force of a contact of `contact_time_s` seconds, and
/// a pad that its piezo drives directly.
pub(crate) fn kit(contact_time_s: f64) -> Vec<u8> {
    let text = format!(
        r#"
format = 1
name = "force"
[[object]]
name = "force"
acceleration = 1.0
modes = []
[[striker]]
name = "stick"
peak_force = 1.0
contact_time_s = {contact_time_s}
contact_exponent = 0.0
[[pad]]
name = "struck"
object = "force"
strikers = ["stick"]
midi_notes = [60]
trigger = {{ channel = 0 }}
[[pad]]
name = "driven"
object = "force"
strikers = ["stick"]
trigger = {{ channel = 1, mode = "direct" }}
"#
    );
    let folder =
        std::env::temp_dir().join(format!("malleus-latency-{}-{:?}", std::process::id(), std::thread::current().id()));
    std::fs::create_dir_all(&folder).unwrap();
    let path = folder.join("force.toml");
    std::fs::write(&path, text).unwrap();
    let kit = kit::open(path.to_str().unwrap()).unwrap().binary;
    std::fs::remove_dir_all(&folder).unwrap();
    kit
}

/// Returns the seconds from each onset until the sound has 10 % of the peak that follows it.
pub(crate) fn latencies(running: &VirtualBoard, onsets: &[f64]) -> Vec<f64> {
    let streams = running.streams();
    let stream = &streams[0];
    let rate_hz = stream.rate.as_f64();
    let level = |frame: usize| stream.frames.get(frame).map_or(0, |frame| (frame[0] >> 8).abs());
    let latency = |onset_s: &f64| {
        let from = ((onset_s - stream.start_s) * rate_hz).ceil() as usize;
        let window = from..from + (0.012 * rate_hz) as usize;
        let peak = window.clone().map(level).max().unwrap();
        assert!(peak > 1000, "no sound after {onset_s} s");
        let reached = window.clone().find(|&frame| level(frame) * 10 >= peak).unwrap();
        stream.start_s + reached as f64 / rate_hz - onset_s
    };
    onsets.iter().map(latency).collect()
}

/// Time between two hits, in seconds.
const SPACING_S: f64 = 0.05;
/// Time in which the ring of a hit falls to 1/e, in seconds. Of a hit of 0.5 it leaves 2 counts
/// when the next hit comes.
const RING_S: f64 = 0.008;

/// Returns hits of one waveform and their onsets in seconds, each at another place in a block and
/// within a sample.
fn hits(piezo: usize, count: usize, peak: f32) -> (Vec<PiezoSignal>, Vec<f64>) {
    // The board interpolates a signal linearly, so it is sampled ten times as densely here.
    let rate_hz = 10.0 * SIGNAL_HZ;
    let wave = |n: usize| {
        let t = n as f64 / rate_hz;
        peak * ((-t / RING_S).exp() * (std::f64::consts::TAU * 1100.0 * t).sin()) as f32
    };
    let samples: Vec<f32> = (0..(2.0 * SPACING_S * rate_hz) as usize).map(wave).collect();
    let golden = 0.5 * (5f64.sqrt() - 1.0);
    let place = |n: usize| 32.0 * (n as f64 * golden).fract() / SIGNAL_HZ;
    let onsets: Vec<f64> = (0..count).map(|n| 0.3 + SPACING_S * n as f64 + place(n)).collect();
    let signal = |&start_s: &f64| PiezoSignal { piezo, start_s, rate_hz, samples: samples.clone() };
    (onsets.iter().map(signal).collect(), onsets)
}

/// Returns the smallest and the largest latency in seconds.
pub(crate) fn measure(board: Board, piezo: usize, count: usize, peak: f32, contact_time_s: f64) -> (f64, f64) {
    let (piezos, onsets) = hits(piezo, count, peak);
    let setup = Setup { piezos, kit: kit(contact_time_s), ..Setup::default() };
    let running = common::run(board, &setup, onsets.last().unwrap() + 0.03);
    let strikes = running.report().unwrap().log.iter().filter(|line| line.message.ends_with("strike")).count();
    assert!(piezo != 0 || strikes == count, "{strikes} strikes of {count}");
    let latencies = latencies(&running, &onsets);
    let largest = latencies.iter().copied().fold(0.0, f64::max);
    let smallest = latencies.iter().copied().fold(f64::INFINITY, f64::min);
    println!(
        "{}: piezo {piezo}, peak {peak}, contact {contact_time_s} s: {:.3} to {:.3} ms over {count} places in a block",
        board.name(),
        1e3 * smallest,
        1e3 * largest
    );
    (smallest, largest)
}

/// A core that sleeps when a part of a run ends wakes in the next part by the interrupt of that
/// cycle. 1.4 ms, more than two halves, are run cycle by cycle, so that one part ends at that very
/// cycle.
#[test]
fn board_that_runs_in_parts_misses_no_interrupt_between_them() {
    let board = Board::Stm32f407gDisc1;
    let mut running = common::run(board, &Setup::default(), 0.4);
    let cycle_s = 1.0 / 168e6;
    for cycle in 1..=(1.4e-3 / cycle_s) as u32 {
        running.run_until(0.4 + f64::from(cycle) * cycle_s).unwrap();
    }
    running.run_until(0.5).unwrap();
    let report = running.report().unwrap();
    let missed: Vec<_> = report.log.iter().filter(|line| line.message.contains("missed")).collect();
    assert!(missed.is_empty(), "{missed:#?}");
}
