//! Sweeps of the engine's stability: resonance, strikes, and a very long run.

use dsp_core::SampleRate;
use dsp_core::engine::{Skipping, TickReport};
use dsp_core::event::Event;
use dsp_core::fixed::ONE_Q27;
use dsp_core::resonator::TICK_FRAMES;
use malleus::render::Performance;

use super::Extent;
use crate::performance::{reference, snr_db};
use crate::scene::{load, mode, one_pad, play, strike};

const RATE: SampleRate = SampleRate::HZ_48000;

/// Samples of the bus, 1.0 = full scale.
pub fn real(bus: &[[i32; 2]]) -> Vec<[f64; 2]> {
    bus.iter().map(|frame| frame.map(|x| f64::from(x) / f64::from(ONE_Q27))).collect()
}

/// Performance of events, and optionally of a force on the first pad.
pub fn performance(events: Vec<Event>, force: Option<Vec<i32>>, frames: usize) -> Performance {
    Performance { events, direct: force.map(|force| (0, force)), frames }
}

/// Drives modes of T60 60 s with a full-scale sine at resonance for 30 s.
///
/// The bus saturates without wrapping, then decays as the reference does.
///
/// # Panics
/// If the limit is broken.
pub fn resonance(extent: Extent) {
    let sines: &[(f64, f64)] =
        extent.pick(&[(7_000.0, 48_000.0)], &[(440.0, 500.0), (7_000.0, 48_000.0), (20_000.0, 5.0)]);
    for &(frequency_hz, gain) in sines {
        let loaded = load(one_pad(vec![mode(frequency_hz, 60.0, gain, 0.0)]));
        let driven = 30 * 48_000;
        let force: Vec<i32> = (0..driven)
            .map(|n| {
                let turns = (frequency_hz * f64::from(n) / 48_000.0).fract();
                ((std::f64::consts::TAU * turns).sin() * f64::from(ONE_Q27 - 1)) as i32
            })
            .collect();
        let frames = (driven + 10 * 48_000) as usize;
        let (bus, reports) = play(&loaded, RATE, Skipping::On, &[], Some(&force), (frames, &[128]));
        assert!(reports.iter().all(|report| report.refused_inputs == 0));
        let expected = reference(&loaded, &performance(Vec::new(), Some(force), frames), RATE);
        // The bus clips at 16, the reference does not. The allowed difference is relative to the
        // amplitude, which grows for half a minute.
        let mut amplitude = 1.0f64;
        for (index, ([got, _], [expected, _])) in real(&bus).iter().zip(&expected).enumerate() {
            let clipped = expected.clamp(-16.0, 16.0);
            amplitude = (amplitude * 0.999).max(expected.abs()).max(1.0);
            let allowed = 1e-3 * amplitude;
            assert!((got - clipped).abs() <= allowed, "{frequency_hz} Hz, frame {index}: {got}, not {clipped}");
        }
    }
}

/// Strikes every pad of the demo kit a thousand times a second, for a minute.
///
/// The sound is bounded, and silent in the end.
///
/// # Panics
/// If the limit is broken.
pub fn strikes(extent: Extent) {
    let seconds = extent.pick(6, 60u64);
    let kit = kit::open("demo").expect("the shipped kit is valid").kit;
    let (pads, loaded) = (kit.pads.len(), load(kit));
    let mut events = Vec::new();
    for step in 0..1_000 * seconds {
        for pad in 0..pads {
            let mut event = strike(step * 48, 1.0);
            event.pad = pad as u8;
            event.position = (step % 101) as f32 / 100.0;
            events.push(event);
        }
    }
    let mut driven = 0;
    let (bus, reports) = play(&loaded, RATE, Skipping::On, &events, None, (48_000 * (seconds as usize + 40), &[128]));
    reports.iter().for_each(|report| driven += u64::from(report.driven_mode_frames));
    assert!(driven > 1_000_000 && reports.iter().all(|report| report.refused_inputs == 0));
    // Clipping must not wrap: the bus must not jump from end to end within a frame.
    let wraps = bus.windows(2).filter(|pair| pair[0][0].abs_diff(pair[1][0]) > 3 << 30).count();
    assert_eq!(wraps, 0);
    assert!(bus.last() == Some(&[0, 0]) && reports.last().is_some_and(|report| report.ringing_pads == 0));
}

/// Runs a thousand million samples of modes of T60 60 s. Level and phase of the one loud mode
/// follow the reference.
///
/// # Panics
/// If the limit is broken.
pub fn drift(extent: Extent) {
    let (frames, seconds): (usize, &[usize]) = extent.pick((200_000, &[0, 3]), (2_000_000, &[0, 10, 20, 30, 40]));
    // One of the 500 modes of T60 60 s is heard; the others together stay below -60 dB of it.
    let mut modes: Vec<_> = (0..499).map(|n| mode(100.0 + 40.0 * f64::from(n), 60.0, 0.05, 0.0)).collect();
    modes.push(mode(333.0, 60.0, 2_000.0, 0.0));
    let loaded = load(one_pad(modes));
    let frames = frames / TICK_FRAMES * TICK_FRAMES;
    let (bus, reports) = play(&loaded, RATE, Skipping::Off, &[strike(0, 1.0)], None, (frames, &[128]));
    let run: u64 = reports.iter().map(|report: &TickReport| u64::from(report.run_mode_frames())).sum();
    assert!(run >= 999 * frames as u64 / 2, "{run}");
    let expected = reference(&loaded, &performance(vec![strike(0, 1.0)], None, frames), RATE);
    let bus = real(&bus);
    for &second in seconds {
        let window = second * 48_000..(second + 1) * 48_000;
        let snr = snr_db(&expected[window.clone()], &bus[window.clone()]);
        let level = |sound: &[[f64; 2]]| sound.iter().map(|frame| frame[0] * frame[0]).sum::<f64>();
        let drift_db = 10.0 * (level(&bus[window.clone()]) / level(&expected[window])).log10();
        println!("after {second} s: {snr:.1} dB, envelope {drift_db:+.5} dB");
        // The phase may drift by 0.01 cent, which limits the SNR. The envelope may not drift.
        assert!(drift_db.abs() < 0.01 && snr > 60.0, "after {second} s: {snr:.1} dB, {drift_db} dB");
    }
}
