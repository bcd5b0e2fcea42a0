//! Contact forces of the instrument against the reference: impulse, shape, and the limits of the
//! contact time.
//!
//! An object that radiates only its acceleration sound makes the force itself heard: the output is
//! the force.

use dsp_core::SampleRate;
use dsp_core::engine::Skipping;
use dsp_core::event::{Event, Time};
use host_tests::performance::{instrument, reference, snr_db};
use host_tests::scene::load;
use host_tests::snr::Random;
use kit::{Kit, Loaded, Object, Pad, Pulse, Striker};
use malleus::render::Performance;

/// Frames from one strike to the next.
const APART: usize = 64;
/// Number of onsets between two frames.
const ONSETS: usize = 16;

fn striker(pulse: Pulse, restitution: f32, contact_time_s: f32) -> Striker {
    Striker {
        name: "striker".into(),
        source: String::new(),
        licence: String::new(),
        pulse,
        peak_force: 1.0,
        peak_exponent: 1.2,
        contact_time_s,
        contact_exponent: -0.2,
        restitution,
        modes: Vec::new(),
        scrape: None,
        roll: None,
    }
}

/// Kit of one pad that sounds its force on the left, 1.0 for a newton.
fn force_alone(striker: Striker) -> Loaded {
    let object = Object {
        name: "force".into(),
        source: String::new(),
        licence: String::new(),
        reference_force: 1.0,
        acceleration: kit::Acceleration::Factor(1.0),
        modes: Vec::new(),
        residual: None,
        dynamic_filter: None,
        biquads: None,
        surface: None,
    };
    let pad = Pad {
        name: "force".into(),
        object: "force".into(),
        strikers: vec![striker.name.clone()],
        level_db: 0.0,
        pan: -1.0,
        striker_weight: 1.0,
        choke_t60_s: 0.0,
        midi_notes: Vec::new(),
        note_off: kit::NoteOff::Nothing,
        trigger: None,
    };
    load(Kit {
        name: "force".into(),
        objects: vec![object],
        strikers: vec![striker],
        pads: vec![pad],
        background: None,
        room: vec![],
        headphone_db: None,
        surfaces: Vec::new(),
    })
}

fn rate(hz: u32) -> SampleRate {
    SampleRate::new(hz, 1).expect("a legal rate")
}

fn strike(frame: u64, fraction: u32, velocity: f32) -> Event {
    Event { time: Time { frame, fraction }, velocity, ..Event::default() }
}

/// Area of the pulse over m τ, by summing the pulse's equation finely.
fn area(pulse: Pulse, restitution: f64) -> f64 {
    let shape: Box<dyn Fn(f64) -> f64> = match pulse {
        Pulse::Gaussian => return (std::f64::consts::PI / 6.0).sqrt(),
        Pulse::Hertz => {
            let slopes = restitution.powf(4.6);
            let skew = (1.0 - slopes) / (1.0 + slopes);
            Box::new(move |x: f64| (std::f64::consts::PI * x).sin() * (1.0 + skew * (std::f64::consts::PI * x).cos()))
        }
    };
    let values: Vec<f64> = (0..20_000).map(|n| shape((f64::from(n) + 0.5) / 20_000.0)).collect();
    values.iter().sum::<f64>() / 20_000.0 / values.iter().fold(0.0, |peak: f64, x| peak.max(*x))
}

fn decibels(ratio: f64) -> f64 {
    20.0 * ratio.log10()
}

#[test]
fn impulses_of_20_to_160_us_contacts_stay_within_0_2_db_at_any_onset() {
    let pulses = [
        (Pulse::Hertz, 0.1),
        (Pulse::Hertz, Striker::DEFAULT_RESTITUTION),
        (Pulse::Hertz, 0.8),
        (Pulse::Hertz, 1.0),
        (Pulse::Gaussian, Striker::DEFAULT_RESTITUTION),
    ];
    for (pulse, restitution) in pulses {
        let mut worst = [0.0f64; 2];
        for hz in [8_000, 44_100, 48_000, 96_000] {
            for contact_us in [20.0f32, 23.0, 30.0, 41.0, 55.0, 80.0, 110.0, 160.0] {
                let loaded = force_alone(striker(pulse, restitution, contact_us * 1e-6));
                let events = (0..ONSETS).map(|onset| {
                    strike((onset * APART) as u64 + 1, (onset as u32).wrapping_mul(u32::MAX / ONSETS as u32), 1.0)
                });
                let frames = ((ONSETS + 1) * APART) as f64 / f64::from(hz);
                let performance = Performance::new(events.collect(), None, &loaded.kit, rate(hz), Some(frames));
                let (bus, _) = instrument(&loaded, &performance, rate(hz), Skipping::Off);
                let expected = reference(&loaded, &performance, rate(hz));
                let impulse = f64::from(contact_us) * 1e-6 * f64::from(hz) * area(pulse, restitution.into());
                for (sound, worst) in [bus, expected].iter().zip(&mut worst) {
                    for strike in sound.chunks_exact(APART).take(ONSETS) {
                        let sum: f64 = strike.iter().map(|frame| frame[0]).sum();
                        *worst = worst.max(decibels(sum / impulse).abs());
                    }
                }
            }
        }
        println!("{pulse:?} {restitution}: instrument {:.4} dB, reference {:.4} dB", worst[0], worst[1]);
        let limit = if pulse == Pulse::Hertz { 1e-3 } else { 0.2 };
        assert!(worst.iter().all(|worst| *worst < limit), "{pulse:?} {restitution}: {worst:?} dB");
    }
}

#[test]
fn forces_of_any_striker_leave_100_db_to_the_reference() {
    let mut random = Random::new(5);
    let mut least = f64::INFINITY;
    for number in 0..60 {
        let gaussian = number % 4 == 3;
        let restitution = if gaussian { Striker::DEFAULT_RESTITUTION } else { random.between(0.1, 1.0) as f32 };
        let pulse = if gaussian { Pulse::Gaussian } else { Pulse::Hertz };
        let contact_time_s = 2e-5 * 2f64.powf(random.between(0.0, 9.0));
        let striker = Striker {
            peak_exponent: random.between(0.0, 2.0) as f32,
            contact_exponent: random.between(-0.5, 0.5) as f32,
            ..striker(pulse, restitution, contact_time_s as f32)
        };
        let loaded = force_alone(striker.clone());
        let hz = [8_000, 44_100, 48_000, 96_000, 192_000][number % 5];
        let events = (0..8)
            .map(|n| strike(5 + 700 * n, random.between(0.0, 4_294_967_295.0) as u32, random.between(0.3, 1.0) as f32));
        let performance =
            Performance::new(events.collect(), None, &loaded.kit, rate(hz), Some(7_000.0 / f64::from(hz)));
        let (bus, _) = instrument(&loaded, &performance, rate(hz), Skipping::Off);
        let snr = snr_db(&reference(&loaded, &performance, rate(hz)), &bus);
        least = least.min(snr);
        assert!(snr > 100.0, "{striker:?} at {hz} Hz: {snr:.1} dB");
    }
    println!("least {least:.1} dB");
}

#[test]
fn contact_times_are_held_between_10_us_and_a_quarter_of_a_second() {
    // Columns: τ1, b, velocity. Without the limits the contact times would be 2 µs and 20 s.
    for (contact_time_s, contact_exponent, velocity, held_s) in
        [(2e-5f32, 1.0f32, 0.1f32, 1e-5), (0.1, -1.0, 0.005, 0.25)]
    {
        for pulse in [Pulse::Hertz, Pulse::Gaussian] {
            let striker = Striker {
                contact_exponent,
                peak_exponent: 0.0,
                ..striker(pulse, Striker::DEFAULT_RESTITUTION, contact_time_s)
            };
            let loaded = force_alone(striker);
            for hz in [8_000, 48_000] {
                let performance =
                    Performance::new(vec![strike(3, 1 << 30, velocity)], None, &loaded.kit, rate(hz), Some(0.8));
                let (bus, _) = instrument(&loaded, &performance, rate(hz), Skipping::Off);
                let impulse = held_s * f64::from(hz) * area(pulse, 0.45);
                for sound in [bus, reference(&loaded, &performance, rate(hz))] {
                    let sum: f64 = sound.iter().map(|frame| frame[0]).sum();
                    let error_db = decibels(sum / impulse);
                    assert!(error_db.abs() < 0.2, "{pulse:?}, {held_s} s at {hz} Hz: {error_db:.3} dB");
                }
            }
        }
    }
}
