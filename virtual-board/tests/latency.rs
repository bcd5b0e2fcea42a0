//! From a piezo's onset at the ADC's pin to 10 % of the contact force on the I2S pin.
//!
//! The kit's one object has no modes, and an acceleration sound: what leaves the I2S is the contact force itself.

mod common;
#[path = "common/hits.rs"]
mod hits;

use hits::{SIGNAL_HZ, signal};
use virtual_board::{Board, PiezoSignal, Setup, VirtualBoard};

/// A pad whose sound is the force of a contact of 1 ms, and a pad that its piezo drives directly.
fn kit() -> Vec<u8> {
    let text = r#"
format = 1
name = "force"
[[object]]
name = "force"
acceleration = 1.0
modes = []
[[striker]]
name = "stick"
peak_force = 1.0
contact_time_s = 0.001
contact_exponent = 0.0
[[pad]]
name = "struck"
object = "force"
strikers = ["stick"]
trigger = { channel = 0 }
[[pad]]
name = "driven"
object = "force"
strikers = ["stick"]
trigger = { channel = 1, mode = "direct" }
"#;
    let folder = std::env::temp_dir().join(format!("malleus-latency-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    let path = folder.join("force.toml");
    std::fs::write(&path, text).unwrap();
    let kit = kit::open(path.to_str().unwrap()).unwrap().binary;
    std::fs::remove_dir_all(&folder).unwrap();
    kit
}

/// Seconds from each onset until the sound has 10 % of the peak that follows it.
fn latencies(running: &VirtualBoard, onsets: &[f64]) -> Vec<f64> {
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

/// Hits that begin within a sample, at places that walk through a block in 1/50 of a sample: five a second, so that the last one's ring is over.
fn fine_hits(piezo: usize, count: usize, peak: f32) -> (PiezoSignal, Vec<f64>) {
    // Finer than the ADC, so that an onset may lie between its samples.
    const FINE: f64 = 50.0;
    let onsets: Vec<f64> =
        (0..count).map(|n| 0.3 + 0.2 * n as f64 + 32.0 * n as f64 / count as f64 / SIGNAL_HZ).collect();
    let rate_hz = SIGNAL_HZ * FINE;
    let mut samples = vec![0.0f32; ((onsets.last().unwrap() + 0.03) * rate_hz) as usize];
    for onset in &onsets {
        let from = (onset * rate_hz).round() as usize;
        for n in 0..(0.02 * rate_hz) as usize {
            let t = n as f64 / rate_hz;
            samples[from + n] = peak * ((-t / 0.004).exp() * (std::f64::consts::TAU * 1100.0 * t).sin()) as f32;
        }
    }
    let onsets = onsets.iter().map(|onset| (onset * rate_hz).round() / rate_hz).collect();
    (PiezoSignal { piezo, start_s: 0.0, rate_hz, samples }, onsets)
}

fn measure(board: Board, piezo: usize, count: usize, peak: f32) -> (f64, f64) {
    let (signal, onsets) = fine_hits(piezo, count, peak);
    let setup = Setup { piezos: vec![signal], kit: kit(), ..Setup::default() };
    let running = common::run(board, &setup, onsets.last().unwrap() + 0.03);
    let latencies = latencies(&running, &onsets);
    let largest = latencies.iter().copied().fold(0.0, f64::max);
    let smallest = latencies.iter().copied().fold(f64::INFINITY, f64::min);
    println!(
        "{}: piezo {piezo}, peak {peak}: {:.3} to {:.3} ms over {count} places in a block",
        board.name(),
        1e3 * smallest,
        1e3 * largest
    );
    (smallest, largest)
}

#[test]
fn a_strike_sounds_within_three_milliseconds_wherever_it_falls_in_a_block() {
    let (smallest, largest) = measure(Board::Stm32f407gDisc1, 0, 40, 0.5);
    assert!(largest <= 3.0e-3 && largest - smallest < 0.05e-3);
}

#[test]
fn forty_decibels_of_velocity_are_hardly_earlier_or_later() {
    let spread: Vec<(f64, f64)> = [0.9, 0.09, 0.02].map(|peak| measure(Board::BlackpillF411, 0, 8, peak)).to_vec();
    assert!(spread.iter().all(|&(_, largest)| largest <= 3.0e-3), "{spread:?}");
}

#[test]
fn a_direct_force_is_on_the_pin_within_one_and_a_half_milliseconds() {
    for board in Board::ALL {
        let (smallest, largest) = measure(board, 1, 16, 0.5);
        assert!(largest <= 1.5e-3 && largest - smallest < 0.05e-3, "{}", board.name());
    }
}

#[test]
fn the_sound_of_a_strike_is_the_contact_of_the_kit() {
    // Half a sine of 1 ms, whatever the piezo rings.
    let setup = Setup { piezos: vec![signal(0, 0.5, &[(0.3, 0.5)])], kit: kit(), ..Setup::default() };
    let running = common::run(Board::BlackpillF411, &setup, 0.4);
    let streams = running.streams();
    let sounding = streams[0].frames.iter().filter(|frame| frame[0] != 0).count() as f64;
    let expected = 0.001 * streams[0].rate.as_f64();
    assert!((sounding - expected).abs() <= 2.0, "{sounding} frames");
}
