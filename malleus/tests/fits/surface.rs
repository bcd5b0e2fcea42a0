//! `malleus surface` as its user calls it.

use std::f64::consts::TAU;
use std::path::Path;
use std::process::{Command, Output};

use tempfile::TempDir;

/// Folder with the profile `rough.csv`: waves of 0.3 and 0.05 mm in steps of 10 µm, and noise.
fn with_profile() -> TempDir {
    let folder = TempDir::new().expect("a folder");
    let mut state = 7u32;
    let mut text = String::from("x_m,height_m\n");
    for n in 0..6_000 {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        let x = f64::from(n) * 1e-5;
        let noise = f64::from(state >> 8) / f64::from(1 << 24) - 0.5;
        let height = 2e-6 * (x / 0.3e-3 * TAU).sin() + 3e-7 * (x / 0.05e-3 * TAU).sin() + 2e-7 * noise;
        text += &format!("{x:e},{height:e}\n");
    }
    std::fs::write(folder.path().join("rough.csv"), text).expect("the folder is writable");
    folder
}

fn surface(folder: &Path, words: &str) -> Output {
    let program = Command::new(env!("CARGO_BIN_EXE_malleus"))
        .current_dir(folder)
        .arg("surface")
        .args(words.split_whitespace())
        .output();
    program.expect("the program runs")
}

#[test]
fn table_report_and_page_of_a_surface_agree() {
    let folder = with_profile();
    let done = surface(folder.path(), "rough.csv -o rough.toml --report pages --json");
    assert!(done.status.success(), "{}", String::from_utf8_lossy(&done.stderr));
    let report: serde_json::Value = serde_json::from_slice(&done.stdout).expect("a report");
    let text = std::fs::read_to_string(folder.path().join("rough.toml")).expect("a table");
    let table: toml::Table = text.parse().expect("TOML");
    let surface = &table["surface"][0];
    assert_eq!(surface["rows"].as_integer(), Some(1));
    assert_eq!(surface["heights"].as_array().map(Vec::len), Some(4096));
    assert_eq!(surface["step_m"].as_float(), report["step_m"].as_f64());
    assert_eq!(surface["shortest_m"].as_float(), Some(2.5e-5));
    assert!(report["band_rms_db"].as_f64().expect("a number") < 0.5, "{report}");
    let page = std::fs::read_to_string(folder.path().join("pages/rough.html")).expect("a page");
    assert!(page.contains("Curvature in thirds of octaves") && !page.contains("://"));
}

#[test]
fn surfaces_that_cannot_be_read_are_refused_without_a_file() {
    let folder = with_profile();
    for (words, reason) in [
        ("absent.csv -o s.toml", "cannot be read"),
        ("rough.csv -o rough.csv", "would be lost"),
        ("rough.csv -o s.toml --points 1000", "--points 1000: give a power of two"),
        ("rough.csv -o s.toml --section 0.05,0.2", "--section 0.05,0.2: the profile reaches from 0 to 0.05960 m"),
        ("rough.csv -o s.toml --map", "--map: the file holds one profile"),
        ("rough.csv -o s.toml --extend-to 1", "--extend-to 1: give a wavelength"),
    ] {
        let done = surface(folder.path(), words);
        let error = String::from_utf8_lossy(&done.stderr);
        assert!(!done.status.success() && error.contains(reason), "{words}: {error}");
        assert!(!folder.path().join("s.toml").exists(), "{words}");
    }
}
