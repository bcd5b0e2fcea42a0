//! `malleus fit --dynamic-filter`: its table plays, and decays in all bands as the recording does.

use std::fs;
use std::path::Path;
use std::process::{Command, Output};

use fit::dynamic_filter::{Breakpoint, Coefficients, Model, Path as FilterPath, RATE_HZ, render};
use fit::modes::DampedSine;

fn malleus(folder: &Path, words: &str) -> Output {
    Command::new(env!("CARGO_BIN_EXE_malleus")).args(words.split(' ')).current_dir(folder).output().unwrap()
}

fn succeeds(folder: &Path, words: &str) -> String {
    let output = malleus(folder, words);
    assert!(output.status.success(), "{words}: {}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).unwrap()
}

/// Writes a recording of a block of wood: noise that loses its high end first, and two modes,
/// behind 20 ms of silence. The sound is cut off after `seconds`.
fn write_recording(path: &Path, seconds: f64) {
    let point = |time_s: f64, b0: f64, a1: f64| Breakpoint {
        time_s,
        coefficients: Coefficients { a: [a1, 0.0], b: [b0, b0, 0.0] },
        noise: 1.0,
    };
    let mode = |frequency_hz, decay_per_s, amplitude| DampedSine { frequency_hz, decay_per_s, amplitude, phase: 0.3 };
    let model = Model {
        path: FilterPath { points: vec![point(0.0, 0.1, -0.6), point(0.15, 0.0008, -0.85), point(0.3, 0.0, -0.9)] },
        modes: vec![mode(620.0, 25.0, 0.3), mode(1_710.0, 38.0, 0.15)],
        loops: vec![],
    };
    let specification = hound::WavSpec {
        channels: 1,
        sample_rate: 48_000,
        bits_per_sample: 32,
        sample_format: hound::SampleFormat::Float,
    };
    let mut writer = hound::WavWriter::create(path, specification).unwrap();
    let silence = std::iter::repeat_n(0.0, 960);
    for sample in silence.chain(render(&model, (seconds * RATE_HZ) as usize, 5)) {
        writer.write_sample(sample as f32).unwrap();
    }
    writer.finalize().unwrap();
}

#[test]
fn a_recording_becomes_a_table_that_plays_and_keeps_its_decays() {
    let folder = tempfile::tempdir().unwrap();
    write_recording(&folder.path().join("block.wav"), 0.5);
    let json = succeeds(folder.path(), "fit block.wav -o block.toml --dynamic-filter modes --render heard.wav --json");
    let rows: serde_json::Value = serde_json::from_str(&json).unwrap();
    let report = &rows[0]["report"];
    println!("{report}");
    let number = |key: &str| report[key].as_f64().unwrap();
    assert_eq!(rows[0]["outcome"], "filtered");
    assert!(number("bands") >= 12.0 && number("bands_within_15_percent") >= 0.8 * number("bands"), "{report}");
    assert!(number("modes") <= 10.0);

    let text = fs::read_to_string(folder.path().join("block.toml")).unwrap();
    assert!(text.contains("[object.dynamic_filter]") && text.contains("block.wav"), "{text}");
    succeeds(folder.path(), "kit new kit.toml block.toml");
    succeeds(folder.path(), "kit check kit.toml");
    fs::write(folder.path().join("s.csv"), "time_s,pad,velocity\n0,block,1\n").unwrap();
    succeeds(folder.path(), "play --kit kit.toml --strikes s.csv -o out.wav");
    assert!(folder.path().join("heard.wav").exists());
    // A second run does not fit a recording whose table exists.
    assert!(succeeds(folder.path(), "fit block.wav -o block.toml --dynamic-filter modes").contains("is done already"));
}

#[test]
fn options_that_conflict_with_a_dynamic_filter_and_absent_files_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    for option in ["--hits 1", "--positions 4", "--strikers 2", "--materials wood"] {
        let output = malleus(folder.path(), &format!("fit a.wav -o a.toml --dynamic-filter modes {option}"));
        assert_eq!(output.status.code(), Some(2));
        let message = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(message.contains("cannot be used with") && message.contains(&option[..6]), "{message}");
    }
    let output = malleus(folder.path(), "fit absent.wav -o a.toml --dynamic-filter loops");
    let message = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(!output.status.success() && message.contains("absent.wav"), "{message}");
}

#[test]
fn dynamic_filter_of_a_strike_below_15_ms_is_refused_as_too_short() {
    let folder = tempfile::tempdir().unwrap();
    write_recording(&folder.path().join("block.wav"), 0.012);
    let output = malleus(folder.path(), "fit block.wav -o block.toml --dynamic-filter modes");
    let message = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(!output.status.success() && message.contains("block.wav: the strike at 0.0"), "{message}");
    assert!(message.contains("at least 15 ms") && !folder.path().join("block.toml").exists(), "{message}");
}
