//! `malleus fit --events --report`: the page of a recording of many strikes.

use std::fs;
use std::path::Path;
use std::process::Command;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use tempfile::TempDir;

use crate::page::{assert_well_formed_and_self_contained, read, tags};
use crate::report::malleus;

/// Writes a sound as 24-bit WAV.
pub(crate) fn write_recording(path: &Path, sound: &[f64]) {
    let spec = hound::WavSpec {
        channels: 1,
        sample_rate: 44_100,
        bits_per_sample: 24,
        sample_format: hound::SampleFormat::Int,
    };
    let mut writer = hound::WavWriter::create(path, spec).expect("can be written");
    sound.iter().for_each(|x| writer.write_sample((x * 8_388_608.0).round() as i32).expect("written"));
    writer.finalize().expect("written");
}

/// Samples of a sound that a page holds as data.
fn in_page(uri: &str) -> Vec<i32> {
    let data = uri.strip_prefix("data:audio/wav;base64,").expect("a sound");
    let bytes = STANDARD.decode(data).expect("base64");
    let reader = hound::WavReader::new(bytes.as_slice()).expect("a WAV file");
    reader.into_samples::<i32>().map(|sample| sample.expect("a sample")).collect()
}

#[test]
fn page_of_many_strikes_has_its_parts_and_the_sound_that_play_makes() {
    let folder = TempDir::new().expect("a folder");
    let path = |name: &str| folder.path().join(name);
    let text = |name: &str| path(name).to_string_lossy().into_owned();
    let sound = fit::multi_strike::synthetic::at_places(1, 15.0, 25);
    write_recording(&path("taps.wav"), &sound.samples);
    let (table, events, pages) = (text("taps.toml"), text("taps.csv"), text("pages"));
    let flags =
        ["-o", &table, "--events", &events, "--positions", "8", "--strikers", "2", "--report", &pages, "--json"];
    let output = malleus(&[&path("taps.wav")], &flags);
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    let html = read(&path("pages/taps.html"));
    assert_well_formed_and_self_contained(&html);
    let tags = tags(&html);
    assert_eq!(tags.iter().filter(|tag| tag.name == "svg" && !tag.closes).count(), 7);
    for title in
        ["Strikes over the recording", "Peak of each force", "Contact time of each force", "What is left over time"]
            .into_iter()
            .chain(["Contact law", "Decay of the modes", "Gains along the object", "striker 2", "All strikes", " ± "])
    {
        assert!(html.contains(title), "{title} is missing");
    }
    let index = read(&path("pages/index.html"));
    assert!(index.contains("./taps.html") && index.contains("1 recording<"), "{index}");

    let sounds: Vec<Vec<i32>> = tags
        .iter()
        .filter(|tag| tag.name == "audio" && !tag.closes)
        .filter_map(|tag| tag.attributes.iter().find(|(key, _)| key == "src"))
        .map(|(_, uri)| in_page(uri))
        .collect();
    assert_eq!(sounds.len(), 3, "recording, replay, and what is left");
    assert!(sounds.iter().all(|samples| samples.len() == sound.samples.len()));
    let played = Command::new(env!("CARGO_BIN_EXE_malleus"))
        .args(["play", "--kit", &table, "--strikes", &events, "-o", &text("again.wav"), "--rate", "44100"])
        .output()
        .expect("the program runs");
    assert!(played.status.success(), "{}", String::from_utf8_lossy(&played.stderr));
    let again: Vec<f64> = hound::WavReader::open(path("again.wav"))
        .expect("a WAV file")
        .into_samples::<i32>()
        .step_by(2)
        .map(|sample| f64::from(sample.expect("a sample")) / 8_388_608.0)
        .collect();
    let peak = sound.samples.iter().fold(0.0, |peak: f64, x| peak.max(x.abs()));
    let of_play = again.iter().map(|x| 32_767.0 * 0.9 / peak * x);
    let worst = sounds[1].iter().zip(of_play).map(|(page, play)| (f64::from(*page) - play).abs()).fold(0.0, f64::max);
    // Half a step of 16 bits, and the rounding of 24 bits and of `f32`.
    assert!(worst < 0.51, "{worst} steps");
    assert!(sounds[1].iter().any(|x| x.abs() > 20_000), "the replay sounds");
    assert!(fs::metadata(path("pages/taps.html")).expect("a page").len() < 12_000_000);
}

/// Other ways read 120 s of a recording; strikes are fitted together in up to 30 minutes.
#[test]
fn strikes_behind_the_first_two_minutes_are_fitted() {
    let folder = TempDir::new().expect("a folder");
    let path = |name: &str| folder.path().join(name);
    let text = |name: &str| path(name).to_string_lossy().into_owned();
    let sound = fit::multi_strike::synthetic::plain(8, 125.0, 12, -60.0);
    write_recording(&path("taps.wav"), &sound.samples);
    let (table, events) = (text("taps.toml"), text("taps.csv"));
    let output = malleus(&[&path("taps.wav")], &["-o", &table, "--events", &events]);
    let printed = String::from_utf8_lossy(&output.stdout).into_owned();
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    assert!(!printed.contains("only the first"), "{printed}");
    let found = read(&path("taps.csv"));
    let times_s: Vec<f64> = found.lines().skip(1).filter_map(|line| line.split(',').next()?.parse().ok()).collect();
    assert!(sound.strikes.iter().any(|strike| strike.at_s > 120.0));
    let is_found = |at_s: f64| times_s.iter().any(|time_s| (time_s - at_s).abs() < 1e-3);
    assert!(sound.strikes.iter().all(|strike| is_found(strike.at_s)), "{times_s:?}");
}

#[test]
fn played_strikes_rounded_to_16_bits_are_all_found() {
    let folder = TempDir::new().expect("a folder");
    let text = |name: &str| folder.path().join(name).to_string_lossy().into_owned();
    let times_s = [0.3, 0.7, 1.4, 2.4, 2.9];
    let velocities = [0.3, 0.75, 0.48, 0.93, 0.66];
    let lines: String = times_s.iter().zip(velocities).map(|(at, v)| format!("{at},marimba,{v}\n")).collect();
    fs::write(text("played.csv"), format!("time_s,pad,velocity\n{lines}")).expect("written");
    let played = Command::new(env!("CARGO_BIN_EXE_malleus"))
        .args(["play", "--kit", "demo", "--strikes", &text("played.csv"), "-o", &text("played.wav")])
        .output()
        .expect("the program runs");
    assert!(played.status.success(), "{}", String::from_utf8_lossy(&played.stderr));
    let mut reader = hound::WavReader::open(text("played.wav")).expect("a WAV file");
    let rate_hz = reader.spec().sample_rate;
    let left: Vec<i32> = reader.samples::<i32>().step_by(2).map(|sample| sample.expect("a sample")).collect();
    // Half of full scale: rounding to 16 bits makes a noise 95 dB below the peak.
    let peak = left.iter().map(|x| x.abs()).max().expect("not empty");
    let spec = hound::WavSpec {
        channels: 1,
        sample_rate: rate_hz,
        bits_per_sample: 16,
        sample_format: hound::SampleFormat::Int,
    };
    let mut writer = hound::WavWriter::create(text("taps.wav"), spec).expect("can be written");
    for x in left {
        let rounded = (f64::from(x) / f64::from(peak) * 16_384.0).round();
        writer.write_sample(rounded as i16).expect("written");
    }
    writer.finalize().expect("written");
    let flags = ["-o", &text("taps.toml"), "--events", &text("taps.csv")];
    let output = malleus(&[&folder.path().join("taps.wav")], &flags);
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    let events = read(&folder.path().join("taps.csv"));
    let found_s: Vec<f64> = events
        .lines()
        .skip(1)
        .map(|line| line.split(',').next().and_then(|at| at.parse().ok()).expect("a time"))
        .collect();
    let is_found = |at: f64| found_s.iter().any(|found| (found - at).abs() < 2e-3);
    assert!(times_s.into_iter().all(is_found), "{events}");
    // The instrument's pulses are no half-sines, and what that leaves may pass for a weak strike.
    assert!(found_s.len() <= times_s.len() + 1, "{events}");
}
