//! Young's modulus of a body of known size by `malleus fit`, and doubts about it.

use tempfile::TempDir;

use crate::report::{malleus, strike};
use crate::strikes_report::write_recording;

#[test]
fn notes_doubt_the_modulus_of_a_body_whose_modes_are_those_of_another() {
    let folder = TempDir::new().expect("a folder");
    let (recording, table) = (folder.path().join("hit.wav"), folder.path().join("t.toml"));
    let table = table.to_string_lossy().into_owned();
    // The lowest modes of a bar, and those of a disc.
    for (frequencies_hz, is_bar) in [([440.0, 1213.0, 2378.0], true), ([440.0, 739.0, 1021.0], false)] {
        strike(&recording, frequencies_hz);
        let fit = |flags: &[&str]| {
            let mut all = vec!["--modes", "3", "--redo", "-o", &table, "--bar", "0.30,0.008,7850"];
            all.extend(flags);
            let output = malleus(&[&recording], &all);
            assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
            String::from_utf8_lossy(&output.stdout).into_owned()
        };
        let doubt = "where a bar that is free at both ends has its own";
        let rows: serde_json::Value = serde_json::from_str(&fit(&["--json"])).expect("JSON");
        assert!(rows[0]["report"]["young_modulus_pa"]["estimate"].is_number(), "{rows}");
        let notes = rows[0]["report"]["notes"].as_array().expect("notes");
        let is_told = notes.iter().any(|note| note.as_str().is_some_and(|note| note.contains(doubt)));
        assert_eq!(is_told, !is_bar, "{frequencies_hz:?}: {notes:?}");
        assert_eq!(fit(&[]).contains(doubt), !is_bar, "{frequencies_hz:?}");
    }
}

#[test]
fn modulus_is_printed_of_many_strikes_as_it_is_of_one() {
    let folder = TempDir::new().expect("a folder");
    let path = |name: &str| folder.path().join(name);
    write_recording(&path("taps.wav"), &fit::multi_strike::synthetic::plain(8, 8.0, 6, -60.0).samples);
    let [table, events] = ["t.toml", "t.csv"].map(|name| path(name).to_string_lossy().into_owned());
    let fit = |flags: &[&str]| {
        let mut all = vec!["--redo", "-o", &table, "--events", &events];
        all.extend(flags);
        let output = malleus(&[&path("taps.wav")], &all);
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        String::from_utf8_lossy(&output.stdout).into_owned()
    };
    let bar = ["--bar", "0.30,0.008,7850"];
    let rows: serde_json::Value = serde_json::from_str(&fit(&[bar[0], bar[1], "--json"])).expect("JSON");
    let gigapascals = 1e-9 * rows[0]["report"]["young_modulus_pa"]["estimate"].as_f64().expect("a modulus");
    let printed = fit(&bar);
    assert!(printed.contains(&format!("\n  Young's modulus {gigapascals:.2} GPa, from ")), "{printed}");
    // Without a size the modulus is that of likely materials, and no row has it.
    assert!(!fit(&[]).contains("Young's modulus"));
}
