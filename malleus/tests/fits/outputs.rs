//! Outputs and layouts of `malleus fit` that are refused before anything is fitted.

use fit::multi_strike::synthetic::plain;
use tempfile::TempDir;

use crate::report::malleus;
use crate::strikes_report::write_recording;

#[test]
fn outputs_that_cannot_be_written_or_are_named_twice_are_refused_before_a_fit() {
    let folder = TempDir::new().expect("a folder");
    let text = |name: &str| folder.path().join(name).to_string_lossy().into_owned();
    write_recording(&folder.path().join("taps.wav"), &plain(3, 1.0, 3, -60.0).samples);
    let [table, away, events] = ["t.toml", "gone/t.toml", "gone/t.csv"].map(text);
    let (tables, in_tables, taps) = (text("tables"), text("tables/taps.toml"), text("taps.wav"));
    let in_taps = text("taps.wav/t");
    for (flags, words) in [
        (&["-o", &away][..], "gone/t.toml: cannot be written"),
        (&["-o", &table, "--events", &events][..], "gone/t.csv: cannot be written"),
        (&["-o", &table, "--render", &away][..], "gone/t.toml: cannot be written"),
        (&["-o", &table, "--events", &table][..], "t.toml: is named for two outputs"),
        (&["-o", &tables, "--events", &in_tables][..], "taps.toml: is named for two outputs"),
        (&["-o", &table, "--render", &taps][..], "taps.wav: is read by this command"),
        (&["-o", &taps][..], "taps.wav: is a file, and no table to write: give -o a .toml file, or a folder"),
        (&["-o", &in_taps][..], "taps.wav/t: cannot be made: there is a file where a folder is needed"),
        (&["-o", &table, "--report", &taps][..], "taps.wav: cannot be made: there is a file where a folder is needed"),
        (&["-o", &table, "--events", &in_taps][..], "what should be its folder is a file"),
    ] {
        let output = malleus(&[&folder.path().join("taps.wav")], flags);
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(output.status.code() == Some(1) && said.contains(words), "{flags:?}: {said}");
        // A fit that failed would be a row of the table that is printed.
        assert!(output.stdout.is_empty() && !folder.path().join("t.toml").exists(), "{flags:?}");
    }
}

#[test]
fn folder_in_the_place_of_a_table_is_refused_and_not_taken_for_a_result() {
    let folder = TempDir::new().expect("a folder");
    let recording = folder.path().join("taps.wav");
    write_recording(&recording, &plain(3, 1.0, 3, -60.0).samples);
    let table = folder.path().join("dir.toml");
    std::fs::create_dir(&table).expect("a folder");
    let output = malleus(&[&recording], &["-o", &table.to_string_lossy()]);
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(output.status.code() == Some(1) && said.contains("dir.toml: cannot be written: is a directory"), "{said}");
    assert!(output.stdout.is_empty());
}

#[test]
fn two_or_three_positions_are_refused_as_the_help_says() {
    for positions in ["2", "3", "17", "0"] {
        let output = malleus(&[], &["taps.wav", "-o", "t.toml", "--events", "t.csv", "--positions", positions]);
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(output.status.code() == Some(2) && said.contains("from 4 to 16 gains"), "{said}");
    }
}
