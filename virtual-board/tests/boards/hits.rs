//! Signals at piezos.

use std::path::Path;

use malleus::wave::read_force;
use virtual_board::PiezoSignal;

/// Sample rate of the signals in Hz.
pub(crate) const SIGNAL_HZ: f64 = 48_000.0;
/// Path of the recorded force that gives hits their shape, if the file exists.
const RECORDING: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../shared/data/hammer/hammer_ceramic.wav");
/// Time of a hit in the recording, in seconds.
const HIT_S: f64 = 0.4047;

/// Returns the signal of a piezo under a hit, of peak 1: a force that makes the disc ring.
///
/// The force is that of a recorded hammer. Without the recording it is a half-sine, and a printed
/// line says so.
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
    // A disc on a pad rings at 1.1 kHz and is silent after 30 ms.
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

/// Returns a piezo's signal of `seconds` seconds. A hit is a time in seconds and a peak.
pub(crate) fn signal(piezo: usize, seconds: f64, hits: &[(f64, f32)]) -> PiezoSignal {
    let shape = hit();
    let mut samples = vec![0.0f32; (seconds * SIGNAL_HZ) as usize];
    for &(at_s, peak) in hits {
        let from = (at_s * SIGNAL_HZ) as usize;
        samples[from..].iter_mut().zip(&shape).for_each(|(sample, x)| *sample += peak * x);
    }
    PiezoSignal { piezo, start_s: 0.0, rate_hz: SIGNAL_HZ, samples }
}
