//! `malleus fit --events --estimator descent`.

use std::fs;

use fit::descent::{self, Settings};
use fit::multi_strike::synthetic::plain;
use fit::table::Provenance;
use tempfile::TempDir;

use crate::report::malleus;
use crate::strikes_report::write_recording;

#[test]
fn descent_writes_table_and_events_and_says_that_it_has_no_deviations() {
    let folder = TempDir::new().expect("a folder");
    let path = |name: &str| folder.path().join(name);
    let text = |name: &str| path(name).to_string_lossy().into_owned();
    write_recording(&path("taps.wav"), &plain(3, 1.0, 3, -60.0).samples);
    let (table, events) = (text("taps.toml"), text("taps.csv"));
    let fit = |flags: &[&str]| {
        let usual = ["-o", table.as_str(), "--json", "--redo"];
        malleus(&[&path("taps.wav")], &[&usual, flags].concat())
    };
    let short = ["--estimator", "descent", "--steps", "20", "--modes", "16", "--events", &events];
    let output = fit(&short);
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    let rows: serde_json::Value = serde_json::from_slice(&output.stdout).expect("JSON");
    let report = &rows[0]["report"];
    assert_eq!(rows[0]["outcome"], "together");
    assert!(report["notes"][0].as_str().is_some_and(|note| note.contains("no standard deviations")), "{report}");
    let (strike, mode) = (&report["strikes"][0], &report["modes"][0]);
    assert!(strike["contact_time_s"].is_number() && strike["contact_time_s_sd"].is_null(), "{strike}");
    assert!(mode["frequency_hz"].is_number() && mode["frequency_hz_sd"].is_null(), "{mode}");
    let lines = fs::read_to_string(path("taps.csv")).expect("events").lines().count();
    assert_eq!(lines, 1 + report["strikes"].as_array().expect("strikes").len());

    for (flags, words) in [
        (&["--estimator", "descent"][..], "--events"),
        (&["--steps", "20", "--events", &events][..], "--estimator descent"),
        (&["--estimator", "bins", "--events", &events][..], "descent"),
        (&[&short[..], &["--positions", "4"]].concat()[..], "--positions"),
    ] {
        let output = fit(flags);
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(output.status.code() == Some(1) && said.contains(words), "{flags:?}: {said}");
    }
}

#[test]
fn table_and_events_of_a_descent_play_its_sound() {
    let sound = plain(3, 1.0, 3, -60.0);
    let settings = Settings { modes: 16, steps: 20, rates: vec![0.03], seed: 4 };
    let estimate = descent::estimate(&sound.samples, sound.rate_hz, &settings, |_| {}).expect("it is a clip");
    let provenance = Provenance { name: "taps".to_owned(), source: String::new(), licence: String::new() };
    let table = descent::table(&estimate, &provenance);
    assert!(table.strikers.iter().all(|striker| striker.pulse == kit::Pulse::Gaussian));
    let folder = TempDir::new().expect("a folder");
    let [kit_path, events_path] = ["t.toml", "t.csv"].map(|name| folder.path().join(name));
    fs::write(&kit_path, kit::text::write(&table)).expect("written");
    fs::write(&events_path, descent::events(&estimate, &table)).expect("written");
    let frames = malleus::render::replay::replay(&kit_path, &events_path, sound.rate_hz, 1.0).expect("it plays");
    let own: Vec<f64> = sound.samples.iter().zip(&estimate.residual).map(|(x, left)| x - left).collect();
    let energy = |sound: &mut dyn Iterator<Item = f64>| sound.map(|x| x * x).sum::<f64>();
    let played = frames.iter().map(|frame| f64::from(frame[0]) / 8_388_608.0);
    let apart = energy(&mut own.iter().zip(played).map(|(x, played)| x - played));
    let apart_db = 10.0 * (apart / energy(&mut own.iter().copied())).log10();
    // The table has no room, and no pulse 40 dB below the strongest.
    assert!(apart_db < -25.0, "{apart_db} dB");
}
