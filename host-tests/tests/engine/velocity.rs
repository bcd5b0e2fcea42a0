//! A harder strike on every shipped pad: each mode gets louder, and no sound gets duller.

use std::f64::consts::TAU;

use dsp_core::SampleRate;
use dsp_core::engine::Skipping;
use dsp_core::event::{Event, Time};
use host_tests::performance::{instrument, reference};
use malleus::render::Performance;

const RATE: SampleRate = SampleRate::HZ_48000;
const KITS: [&str; 3] = ["demo", "recorded", "filters"];
/// Number of frames whose centroid is measured: 50 ms.
const FRAMES: usize = 2_400;

fn open(name: &str) -> kit::Loaded {
    kit::open(name).expect("the shipped kit is valid")
}

/// Velocities from 0.05 to 1, evenly in decibels.
fn velocities(count: usize) -> impl Iterator<Item = f64> {
    (0..count).map(move |step| 0.05f64.powf(1.0 - step as f64 / (count - 1) as f64))
}

/// Energy of a mode under a force, over all phases of its gain: the energy of the complex
/// `Σ F[m] e^{p (n-m)}`.
fn energy(frequency_hz: f64, decay_per_s: f64, force: &[f64]) -> f64 {
    let (radius, angle) = ((-decay_per_s / RATE.hz()).exp(), TAU * frequency_hz / RATE.hz());
    let (pole_re, pole_im) = (radius * angle.cos(), radius * angle.sin());
    let (mut re, mut im, mut energy) = (0.0f64, 0.0f64, 0.0);
    for force in force {
        (re, im) = (re * pole_re - im * pole_im + force, re * pole_im + im * pole_re);
        energy += re * re + im * im;
    }
    // The second term is the energy that rings after the contact.
    energy + (re * re + im * im) * radius * radius / (1.0 - radius * radius)
}

/// Largest ratio by which a series falls below its largest value so far.
fn largest_fall(values: impl Iterator<Item = f64>) -> f64 {
    values.fold((0.0f64, 1.0f64), |(most, fall), value| (most.max(value), fall.max(most / value))).1
}

#[test]
fn every_mode_of_every_shipped_pad_gets_louder_with_velocity() {
    for name in KITS {
        let loaded = open(name);
        let pads = malleus::render::reference::pads(&loaded.kit, RATE);
        for (pad, prepared) in loaded.kit.pads.iter().zip(&pads) {
            for (striker, striker_name) in prepared.strikers.iter().zip(&pad.strikers) {
                let mut worst_db = 0.0f64;
                for onset in [0.0, 0.37, 0.71] {
                    let forces: Vec<Vec<f64>> = velocities(80)
                        .map(|velocity| {
                            let impact = striker.strike(velocity, onset).expect("a velocity above 0");
                            let rate = reference::SampleRate { numerator: 48_000, denominator: 1 };
                            (0..)
                                .take_while(|&sample| !impact.is_over(sample, rate))
                                .map(|n| impact.force(n, rate))
                                .collect()
                        })
                        .collect();
                    let audible = prepared.object.modes.iter().filter(|mode| mode.frequency_hz < RATE.hz() / 2.0);
                    for mode in audible {
                        let fall =
                            largest_fall(forces.iter().map(|force| energy(mode.frequency_hz, mode.decay_per_s, force)));
                        worst_db = worst_db.max(10.0 * fall.log10());
                    }
                }
                println!("{name}, {} with {striker_name}: {worst_db:.2} dB", pad.name);
                assert!(worst_db <= 0.5, "{name}, {} with {striker_name}: {worst_db:.2} dB", pad.name);
            }
        }
    }
}

/// Energy of left and right together, and the centroid of their power spectrum in Hz.
fn energy_and_centroid_hz(sound: &[[f64; 2]]) -> (f64, f64) {
    let size = 8_192;
    let transform = fourier::forward(size);
    let (mut energy, mut moment) = (0.0, 0.0);
    for channel in 0..2 {
        let (mut input, mut output) = (transform.make_input_vec(), transform.make_output_vec());
        input.iter_mut().zip(sound).for_each(|(slot, frame)| *slot = frame[channel]);
        transform.process(&mut input, &mut output).expect("lengths fit");
        for (bin, value) in output.iter().enumerate() {
            energy += value.norm_sqr();
            moment += value.norm_sqr() * bin as f64 * RATE.hz() / size as f64;
        }
    }
    (energy, moment / energy)
}

fn one_strike(pad: usize, striker: usize, velocity: f64, position: f32) -> Event {
    Event {
        time: Time { frame: 0, fraction: 0x6000_0000 },
        pad: pad as u8,
        velocity: velocity as f32,
        position,
        striker: striker as u8,
        ..Event::default()
    }
}

#[test]
fn no_shipped_pad_gets_duller_or_softer_under_a_harder_strike() {
    for name in KITS {
        let loaded = open(name);
        for (index, pad) in loaded.kit.pads.iter().enumerate() {
            for striker in 0..pad.strikers.len() {
                // The reference plays every velocity, the instrument every third.
                let (mut by_reference, mut by_instrument) = (Vec::new(), Vec::new());
                for (step, velocity) in velocities(16).enumerate() {
                    let events = vec![one_strike(index, striker, velocity, 0.3)];
                    let seconds = FRAMES as f64 / RATE.hz();
                    let performance = Performance::new(events, None, &loaded.kit, RATE, Some(seconds));
                    by_reference.push(energy_and_centroid_hz(&reference(&loaded, &performance, RATE)));
                    if step % 3 == 0 {
                        let (bus, _) = instrument(&loaded, &performance, RATE, Skipping::On);
                        by_instrument.push(energy_and_centroid_hz(&bus));
                    }
                }
                let struck = format!("{name}, {} with {}", pad.name, pad.strikers[striker]);
                for (player, series) in [("reference", by_reference), ("instrument", by_instrument)] {
                    let softer = largest_fall(series.iter().map(|(energy, _)| *energy));
                    let duller = largest_fall(series.iter().map(|(_, centroid)| *centroid));
                    println!(
                        "{struck}, {player}: energy falls by {:.2} dB, centroid by {:.2} %",
                        10.0 * softer.log10(),
                        100.0 * (1.0 - 1.0 / duller)
                    );
                    assert!(softer < 1.122, "{struck}, {player}: energy falls by a factor of {softer}");
                    assert!(duller < 1.0 / 0.97, "{struck}, {player}: centroid falls by a factor of {duller}");
                }
            }
        }
    }
}
