//! The shipped kit `recorded`: real fits, playable, and near their recordings. Those lie beside the project, in `../shared/data/recordings`.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use dsp_core::SampleRate;
use dsp_core::engine::Skipping;
use dsp_core::event::{Event, Time};
use dsp_core::fixed::ONE_Q27;
use dsp_core::table::Kit;
use fit::distance::{log_spectral_distance_db, lsd_window};
use malleus::render::instrument::{Output, Settings};
use malleus::render::{Performance, instrument, law};

const RATE: SampleRate = SampleRate::HZ_48000;

fn recorded() -> kit::Loaded {
    kit::open("recorded").expect("the shipped kit is valid")
}

fn strike(pad: usize, frame: u64, velocity: f32) -> Event {
    Event { time: Time { frame, fraction: 0x5000_0000 }, pad: pad as u8, velocity, ..Event::default() }
}

/// The stereo bus, 1.0 = full scale, before it saturates.
fn play(loaded: &kit::Loaded, performance: &Performance, skipping: Skipping) -> Vec<[f64; 2]> {
    let table = Kit::parse(&loaded.binary).expect("a loaded kit is valid");
    let settings = Settings { rate: RATE, block: 128, skipping, budget_cycles: None };
    let bus = instrument::render(&table, performance, settings, Output::Bus, |_| {}).expect("the kit fits");
    bus.into_iter().map(|frame| frame.map(|x| f64::from(x) / f64::from(ONE_Q27))).collect()
}

fn decibels(power_ratio: f64) -> f64 {
    10.0 * power_ratio.log10()
}

fn peak_dbfs(sound: &[[f64; 2]]) -> f64 {
    decibels(sound.iter().flatten().fold(0.0, |peak: f64, x| peak.max(x * x)))
}

#[test]
fn it_holds_at_least_twelve_instruments_each_with_the_recording_and_a_licence_that_asks_for_no_credit() {
    let loaded = recorded();
    assert!(loaded.kit.pads.len() >= 12, "{}", loaded.kit.pads.len());
    let modes: usize = loaded.kit.objects.iter().map(|object| object.modes.len()).sum();
    assert!(modes <= 512, "{modes}");
    for object in &loaded.kit.objects {
        assert!(object.source.contains(".wav, strike at"), "{}: {}", object.name, object.source);
        assert!(["CC0-1.0", "MIT", "BSD-2-Clause"].contains(&object.licence.as_str()), "{}", object.licence);
    }
}

#[test]
fn a_full_strike_of_each_pad_neither_clips_nor_whispers_and_softer_ones_are_softer() {
    let loaded = recorded();
    for (index, pad) in loaded.kit.pads.iter().enumerate() {
        let peaks = [1.0, 0.8, 0.6, 0.4, 0.2, 0.1].map(|velocity| {
            let performance = Performance::new(vec![strike(index, 10, velocity)], None, &loaded.kit, RATE, Some(1.0));
            peak_dbfs(&play(&loaded, &performance, Skipping::On))
        });
        println!("{}: {peaks:.1?} dBFS", pad.name);
        assert!((-14.0..=-7.5).contains(&peaks[0]), "{}: {peaks:.1?}", pad.name);
        assert!(peaks.is_sorted_by(|louder, softer| louder > softer), "{}: {peaks:.1?}", pad.name);
    }
}

#[test]
fn all_pads_played_together_stay_below_full_scale() {
    let loaded = recorded();
    let all = |gap: u64| (0..loaded.kit.pads.len()).map(move |pad| strike(pad, 10 + gap * pad as u64, 1.0)).collect();
    // At once, and a fill of 30 strikes a second.
    for gap in [0, 1_600] {
        let performance = Performance::new(all(gap), None, &loaded.kit, RATE, Some(1.0));
        let peak = peak_dbfs(&play(&loaded, &performance, Skipping::On));
        println!("{gap} frames apart: {peak:.1} dBFS");
        assert!(peak < 0.0, "{gap} frames apart: {peak:.1} dBFS");
    }
}

#[test]
fn each_pad_leaves_at_least_90_db_to_the_law() {
    let loaded = recorded();
    for (index, pad) in loaded.kit.pads.iter().enumerate() {
        let strikes = [0.02, 0.9, 1.0, 0.4, 0.15, 0.7];
        let events = strikes.into_iter().enumerate().map(|(at, v)| strike(index, 100 + at as u64 * 7_001, v)).collect();
        let performance = Performance::new(events, None, &loaded.kit, RATE, Some(2.0));
        let expected = law::render(&loaded.kit, &performance, RATE, |_| {}).expect("the events are valid");
        let got = play(&loaded, &performance, Skipping::Off);
        let power: f64 = expected.iter().flatten().map(|x| x * x).sum();
        let error: f64 = expected.iter().flatten().zip(got.iter().flatten()).map(|(a, b)| (a - b).powi(2)).sum();
        println!("{}: {:.1} dB", pad.name, decibels(power / error));
        assert!(decibels(power / error) >= 90.0, "{}: {:.1} dB", pad.name, decibels(power / error));
    }
}

#[test]
fn each_table_is_within_3_5_db_of_its_recording() {
    let folder: PathBuf = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../shared/data/recordings");
    // The engine that renders a single table is built on the stack.
    let compared = std::thread::Builder::new().stack_size(64 << 20).spawn(move || {
        for object in recorded().kit.objects {
            let (file, _) = object.source.split_once(',').expect("the source begins with the file");
            let path = folder.join(file);
            if !path.exists() {
                println!("ABSENT: {} is not there; {} was not compared with it", path.display(), object.name);
                continue;
            }
            let recording = fit::audio::read(&path, None).expect("the recording is readable");
            let (found, _) = fit::segment::hits(&recording).expect("it holds a strike");
            let heard = &recording.samples[found[0].onset..found[0].end];
            let table = kit::load(&table_path(&object.name)).expect("the table is in the repository");
            let sound = fit::render::by_instrument(&table.kit, 0.0, recording.rate_hz, heard.len()).expect("it plays");
            let window = lsd_window(heard, recording.rate_hz);
            let lsd_db = log_spectral_distance_db(&heard[window.clone()], &sound[window]);
            println!("{}: LSD {lsd_db:.2} dB", object.name);
            assert!(lsd_db <= 3.5, "{}: {lsd_db:.2} dB", object.name);
        }
    });
    compared.expect("a thread starts").join().expect("every table is near its recording");
}

fn table_path(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../tables/recorded").join(format!("{name}.toml"))
}

#[test]
fn the_program_plays_it_by_name() {
    let folder = tempfile::tempdir().expect("a folder");
    let (strikes, sound) = (folder.path().join("s.csv"), folder.path().join("out.wav"));
    fs::write(&strikes, "time_s,pad,velocity\n0,tabla,1\n0.2,handbell,0.7\n").expect("it is written");
    let output = Command::new(env!("CARGO_BIN_EXE_malleus"))
        .args(["play", "--kit", "recorded", "--tail", "0.5", "--strikes"])
        .args([strikes.as_os_str(), "-o".as_ref(), sound.as_os_str()])
        .output()
        .expect("it runs");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let loudest = hound::WavReader::open(&sound).expect("a WAV file").into_samples::<i32>().map_while(Result::ok);
    assert!(loudest.map(i32::abs).max() > Some(1 << 20));
}
