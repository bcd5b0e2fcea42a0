//! `malleus fit --estimator bins`: a physical prior of one mode a bin and 100 bands of noise.
//!
//! The recordings lie in `../shared/data/recordings`, beside the project. If they are absent, the
//! test that fits one is ignored.

use std::path::Path;
use std::process::{Command, Output};

use fit::distance::RecordedLevels;

fn malleus(folder: &Path, words: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_malleus")).args(words).current_dir(folder).output().unwrap()
}

fn json(folder: &Path, words: &[&str]) -> serde_json::Value {
    let output = malleus(folder, words);
    assert!(output.status.success(), "{words:?}: {}", String::from_utf8_lossy(&output.stderr));
    serde_json::from_slice(&output.stdout).unwrap()
}

/// Number of samples of silence before the strike of [`strike`].
const SILENCE: usize = 2_205;

/// Strike on a cymbal, 1 s at 44.1 kHz behind silence: 12 modes, and noise in every bin that decays
/// by 60 dB in 0.7 s. Strikes of other seeds have other noise.
pub(crate) fn strike(seed: u64) -> Vec<f64> {
    let mut state = seed;
    let mut noise = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 33) as f64 / (1u64 << 31) as f64 - 0.5
    };
    let sound = (0..44_100).map(|n| {
        let time_s = f64::from(n) / 44_100.0;
        let mode = |k: u32| {
            let (hz, decay_per_s) = (300.0 * f64::from(k).powf(1.4), 5.0 + f64::from(k));
            (std::f64::consts::TAU * hz * time_s).sin() * (-decay_per_s * time_s).exp() / f64::from(k)
        };
        0.3 * (1..=12).map(mode).sum::<f64>() + noise() * (0.1 * (-9.9 * time_s).exp() + 1e-5)
    });
    let sound: Vec<f64> = sound.collect();
    let before = (0..SILENCE).map(|n| 1e-5 * ((n * 7 % 13) as f64 / 13.0 - 0.5));
    before.chain(sound).collect()
}

pub(crate) fn write(path: &Path, samples: &[f64]) {
    let spec = hound::WavSpec {
        channels: 1,
        sample_rate: 44_100,
        bits_per_sample: 32,
        sample_format: hound::SampleFormat::Float,
    };
    let mut writer = hound::WavWriter::create(path, spec).unwrap();
    for sample in samples {
        writer.write_sample(*sample as f32).unwrap();
    }
    writer.finalize().unwrap();
}

fn samples(path: &Path) -> Vec<f64> {
    fit::audio::read(path, None).expect("a sound").samples
}

#[test]
fn a_prior_has_1025_modes_and_100_bands_and_sounds_like_the_recording() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    let recorded = strike(1);
    write(&at("cymbal.wav"), &recorded);
    let words = ["fit", "cymbal.wav", "-o", "cymbal.toml", "--estimator", "bins", "--render", "again.wav", "--json"];
    let rows = json(folder.path(), &words);
    println!("{} s", rows[0]["report"]["seconds"]);
    let object = &kit::load(&at("cymbal.toml")).unwrap().kit.objects[0];
    let residual = object.residual.as_ref().expect("the modes leave noise");
    assert_eq!((object.modes.len(), residual.weight.len(), residual.edges_hz.len()), (1025, 100, 101));
    let levels = RecordedLevels::new(&recorded[..SILENCE], &recorded[SILENCE..], 44_100.0);
    let distance_db = |sound: &[f64]| levels.lsd_db(&sound[SILENCE..]);
    let (prior_db, again_db) = (distance_db(&samples(&at("again.wav"))), distance_db(&strike(2)));
    println!("LSD of the prior {prior_db:.2} dB, of another strike {again_db:.2} dB");
    assert!(prior_db < again_db + 1.0, "{prior_db:.2} dB, of another strike {again_db:.2} dB");

    json(folder.path(), &["kit", "check", "cymbal.toml", "--json"]);
    assert!(malleus(folder.path(), &["kit", "new", "kit.toml", "cymbal.toml"]).status.success());
    let report = json(folder.path(), &["kit", "check", "kit.toml", "--json"]);
    assert!(report["not_rendered"].is_null() && report["strikes"][0]["peak_dbfs"].is_number(), "{report}");
}

#[test]
fn a_number_of_modes_is_obeyed_by_a_prior_and_bounded_by_its_bins() {
    let folder = tempfile::tempdir().unwrap();
    write(&folder.path().join("cymbal.wav"), &strike(1));
    let fit = |modes: &str| {
        malleus(folder.path(), &["fit", "cymbal.wav", "-o", "cymbal.toml", "--estimator", "bins", "--modes", modes])
    };
    assert!(fit("40").status.success());
    assert_eq!(kit::load(&folder.path().join("cymbal.toml")).unwrap().kit.objects[0].modes.len(), 40);
    let refused = fit("1026");
    assert_eq!(refused.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&refused.stderr).contains("from 1 to 1025 modes"));
}

#[test]
#[cfg_attr(not(has_shared_data), ignore = "needs the recordings in ../shared/data")]
fn prior_of_a_cymbal_has_a_mode_for_almost_every_bin_and_100_bands() {
    let folder = tempfile::tempdir().unwrap();
    let recording = Path::new(env!("SHARED_DATA")).join("recordings/metal_cymbal_1.wav");
    let recording = recording.to_str().expect("a path in UTF-8");
    let rows = json(folder.path(), &["fit", recording, "-o", "cymbal.toml", "--estimator", "bins", "--json"]);
    let report = &rows[0]["report"];
    let number = |key: &str| report[key].as_f64().expect(key);
    println!("{} modes, LSD {} dB, {} s", report["modes"], report["lsd_with_residual_db"], report["seconds"]);
    assert!(number("modes") >= 1000.0 && number("lsd_with_residual_db") < 8.5, "{report}");
    assert!(number("erb_with_residual_db") < 0.6 * number("erb_db"), "{report}");
    assert_eq!(report["residual_bands"].as_array().map(Vec::len), Some(100));
}
