//! The shipped kit `priors`: whole physical priors, which play in frames and resemble their
//! recordings.
//!
//! The recordings lie in `../shared/data/recordings`, beside the project. If they are absent, the
//! test that compares with them is ignored.

use std::path::Path;

use dsp_core::SampleRate;
use dsp_core::engine::{Setup, Skipping};
use dsp_core::event::{Event, Time};
use dsp_core::fixed::ONE_Q27;
use dsp_core::table::Kit;
use malleus::render::instrument::{self, Output, Settings};
use malleus::render::{Performance, reference};

use crate::recorded::{distance_db, on_a_large_stack};

const RATE: SampleRate = SampleRate::HZ_48000;

fn priors() -> kit::Kit {
    kit::open("priors").expect("the shipped kit is valid").kit
}

/// Stereo bus of a performance by the instrument, 1.0 = full scale. No mode is retired.
fn play(kit: &kit::Kit, performance: &Performance) -> Vec<[f64; 2]> {
    let binary = kit::binary::build(kit).expect("a valid kit");
    let table = Kit::parse(&binary).expect("a built kit is valid");
    let settings =
        Settings { setup: Setup { skipping: Skipping::Off, ..Setup::new(RATE) }, block: 128, budget_cycles: None };
    let bus = instrument::render(&table, performance, settings, Output::Bus, |_| {}).expect("the kit fits");
    bus.into_iter().map(|frame| frame.map(|x| f64::from(x) / f64::from(ONE_Q27))).collect()
}

fn strike(pad: usize, frame: u64, velocity: f32) -> Event {
    Event { time: Time { frame, fraction: 0x5000_0000 }, pad: pad as u8, velocity, ..Event::default() }
}

#[test]
fn each_prior_has_a_mode_for_most_bins_and_100_bands() {
    let kit = priors();
    assert_eq!(kit.pads.len(), 3);
    for object in &kit.objects {
        assert!((900..=1025).contains(&object.modes.len()), "{}: {}", object.name, object.modes.len());
        assert_eq!(object.residual.as_ref().map(|residual| residual.weight.len()), Some(100), "{}", object.name);
        assert_eq!(object.licence, "CC0-1.0", "{}", object.name);
    }
}

#[test]
fn modes_of_each_prior_have_95_db_of_snr_to_the_reference() {
    let mut kit = priors();
    kit.objects.iter_mut().for_each(|object| object.residual = None);
    for (index, pad) in kit.pads.iter().enumerate() {
        let events = vec![strike(index, 100, 0.9), strike(index, 5_003, 0.3), strike(index, 9_007, 1.0)];
        let performance = Performance::new(events, None, &kit, RATE, Some(0.3));
        let expected = reference::render(&kit, &performance, RATE, |_| {}).expect("the events are valid");
        let got = play(&kit, &performance);
        let power: f64 = expected.iter().flatten().map(|x| x * x).sum();
        let error: f64 = expected.iter().flatten().zip(got.iter().flatten()).map(|(a, b)| (a - b).powi(2)).sum();
        let snr_db = 10.0 * (power / error).log10();
        println!("{}: {snr_db:.1} dB", pad.name);
        assert!(snr_db >= 95.0, "{}: {snr_db:.1} dB", pad.name);
    }
}

#[test]
#[cfg_attr(not(has_shared_data), ignore = "needs the recordings in ../shared/data")]
fn each_prior_is_nearer_to_its_own_recording_than_the_others_are() {
    on_a_large_stack(|| {
        let kit = priors();
        let tables: Vec<kit::Kit> = kit
            .objects
            .iter()
            .zip(&kit.strikers)
            .map(|(object, striker)| kit::Kit {
                objects: vec![object.clone()],
                strikers: vec![striker.clone()],
                pads: Vec::new(),
                ..kit.clone()
            })
            .collect();
        for (index, object) in kit.objects.iter().enumerate() {
            let (file, _) = object.source.split_once(',').expect("the source begins with the file");
            let path = Path::new(env!("SHARED_DATA")).join("recordings").join(file);
            let recording = fit::audio::read(&path, None).expect("the recording is readable");
            let distances: Vec<f64> = tables.iter().map(|table| distance_db(&recording, table)).collect();
            println!("{}: LSD {distances:.2?} dB", object.name);
            let others = distances.iter().enumerate().filter(|(other, _)| *other != index);
            assert!(
                others.into_iter().all(|(_, other)| *other > distances[index] + 2.0),
                "{}: {distances:.2?}",
                object.name
            );
            assert!(distances[index] < 9.5, "{}: {distances:.2?}", object.name);
        }
    });
}
