//! `malleus fit --report`: its pages show pictures, play sounds, and fetch nothing.
//!
//! If Chromium is installed it opens a page; else the test that needs it is ignored.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use tempfile::TempDir;

use crate::page::{assert_sounds_play, assert_well_formed_and_self_contained, findings, list, read, tags};

/// Writes a strike of three modes as 16-bit WAV, 0.7 s at 44.1 kHz.
pub(crate) fn strike(path: &Path, frequencies_hz: [f64; 3]) {
    fs::create_dir_all(path.parent().expect("a folder")).expect("can be made");
    let spec = hound::WavSpec {
        channels: 1,
        sample_rate: 44_100,
        bits_per_sample: 16,
        sample_format: hound::SampleFormat::Int,
    };
    let mut writer = hound::WavWriter::create(path, spec).expect("can be written");
    let mut dither = 1_u32;
    for n in 0..30_870 {
        let t = (f64::from(n) - 2205.0) / 44_100.0;
        let ring = |f: f64, d: f64| (-d * t).exp() * (std::f64::consts::TAU * f * t).sin();
        let sound = if t < 0.0 {
            0.0
        } else {
            0.25 * (ring(frequencies_hz[0], 9.0) + ring(frequencies_hz[1], 18.0) + ring(frequencies_hz[2], 30.0))
        };
        dither = dither.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        let noise = f64::from(dither >> 16) / 65_536.0 - 0.5;
        writer.write_sample((sound * 32_000.0 + 4.0 * noise) as i16).expect("written");
    }
    writer.finalize().expect("written");
}

pub(crate) fn malleus(arguments: &[&Path], flags: &[&str]) -> std::process::Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_malleus"));
    command.arg("fit").args(arguments).args(flags).output().expect("the program runs")
}

/// Folder with two recordings of one stem, one of another stem, and a file that is not audio, after
/// a fit of all four with a report.
struct Fitted {
    folder: TempDir,
    output: std::process::Output,
}

impl Fitted {
    fn new() -> Self {
        let folder = TempDir::new().expect("a folder");
        strike(&folder.path().join("one/hit.wav"), [440.0, 1230.0, 2750.0]);
        strike(&folder.path().join("two/hit.wav"), [500.0, 1530.0, 3150.0]);
        strike(&folder.path().join("<b>&bell.wav"), [700.0, 1900.0, 5200.0]);
        fs::write(folder.path().join("text.wav"), "no audio at all").expect("written");
        let mut fitted = Self { folder, output: malleus(&[], &["--help"]) };
        fitted.output = fitted.run();
        fitted
    }

    fn path(&self, below: &str) -> PathBuf {
        self.folder.path().join(below)
    }

    fn run(&self) -> std::process::Output {
        let inputs = ["one/hit.wav", "two/hit.wav", "<b>&bell.wav", "text.wav"].map(|name| self.path(name));
        let inputs: Vec<&Path> = inputs.iter().map(PathBuf::as_path).collect();
        let (tables, pages) = (self.path("tables"), self.path("pages"));
        let (tables, pages) = (tables.to_string_lossy().into_owned(), pages.to_string_lossy().into_owned());
        malleus(&inputs, &["--modes", "8", "-o", &tables, "--report", &pages, "--json"])
    }
}

#[test]
fn each_recording_has_a_page_that_is_well_formed_and_self_contained() {
    let fitted = Fitted::new();
    assert_eq!(fitted.output.status.code(), Some(1), "the file that is no audio fails");
    for name in ["one-hit", "two-hit", "<b>&bell"] {
        assert!(fitted.path(&format!("tables/{name}.toml")).is_file(), "{name}");
        let html = read(&fitted.path(&format!("pages/{name}.html")));
        assert_well_formed_and_self_contained(&html);
        assert!(tags(&html).iter().filter(|tag| tag.name == "audio" && !tag.closes).count() >= 2);
        assert!(tags(&html).iter().filter(|tag| tag.name == "svg" && !tag.closes).count() >= 7);
        assert!(!html.contains("<b>"), "names are text, not markup");
    }
    let index = read(&fitted.path("pages/index.html"));
    assert_well_formed_and_self_contained(&index);
    for found in ["./one-hit.html", "./two-hit.html", "./%3Cb%3E%26bell.html", "text.wav", "not audio"] {
        assert!(index.contains(found), "{found} is missing");
    }

    // The two recordings of one stem have figures of their own.
    let rows: serde_json::Value = serde_json::from_slice(&fitted.output.stdout).expect("JSON");
    let rows = rows.as_array().expect("rows");
    assert_eq!(rows.len(), 4);
    assert_ne!(rows[0]["report"]["frequency_hz"], rows[1]["report"]["frequency_hz"]);
    assert!(rows[0]["report"]["damping_law"]["bands"].as_array().is_some_and(|bands| !bands.is_empty()));
    assert!(rows[0]["report"]["room"].is_null(), "a dry strike has no room");

    // A second run makes only the page that is missing, and its index still has every page.
    let untouched = fitted.path("pages/two-hit.html");
    let before = fs::metadata(&untouched).and_then(|metadata| metadata.modified()).expect("is there");
    fs::remove_file(fitted.path("pages/one-hit.html")).expect("was there");
    fs::remove_file(fitted.path("pages/index.html")).expect("was there");
    let again: serde_json::Value = serde_json::from_slice(&fitted.run().stdout).expect("JSON");
    let outcomes: Vec<&str> =
        again.as_array().expect("rows").iter().filter_map(|row| row["outcome"].as_str()).collect();
    assert_eq!(outcomes, ["fitted", "skipped", "skipped", "failed"]);
    assert!(fitted.path("pages/one-hit.html").is_file());
    assert_eq!(fs::metadata(&untouched).and_then(|metadata| metadata.modified()).expect("is there"), before);
    let index = read(&fitted.path("pages/index.html"));
    assert!(index.contains("./one-hit.html") && index.contains("./two-hit.html") && index.contains("bell.html"));
}

/// Asserts that the blind comparison counted two answers, of which the first said "the recording"
/// and the second "the fit", and none that came without a sound.
fn assert_counts_answers(counts: &[serde_json::Value], found: &serde_json::Value) {
    let counts: Vec<&str> = counts.iter().filter_map(|count| count.as_str()).collect();
    assert_eq!(counts.len(), 3, "{found}");
    assert!(counts[0].starts_with("0 of 0 right"), "an answer counts without a sound: {found}");
    let first = usize::from(counts[1].starts_with("That was the recording."));
    let second = usize::from(counts[2].starts_with("That was the fit."));
    assert!(counts[1].contains(&format!(". {first} of 1 right")), "{found}");
    assert!(counts[2].contains(&format!(". {} of 2 right", first + second)), "{found}");
}

#[test]
#[cfg_attr(not(has_chromium), ignore = "needs Chromium; the page is checked by parsing alone, in the other tests")]
fn page_in_a_browser_shows_its_pictures_plays_its_sounds_and_fetches_nothing() {
    let folder = TempDir::new().expect("a folder");
    let input = folder.path().join("mug.wav");
    strike(&input, [440.0, 1230.0, 2750.0]);
    let (table, pages) = (folder.path().join("mug.toml"), folder.path().join("pages"));
    let done =
        malleus(&[&input], &["--modes", "8", "-o", &table.to_string_lossy(), "--report", &pages.to_string_lossy()]);
    assert!(done.status.success(), "{}", String::from_utf8_lossy(&done.stderr));
    let html = read(&pages.join("mug.html"));
    for found in findings(&html) {
        assert!(list(&found, "sounds").len() >= 2, "{found}");
        assert_sounds_play(&found, 0.6..0.7);
        let (pictures, charts) = (list(&found, "pictures"), list(&found, "charts"));
        assert!(pictures.len() >= 2 && pictures.iter().all(|width| width.as_u64() == Some(640)), "{found}");
        assert!(charts.len() >= 7 && charts.iter().all(|height| height.as_f64() > Some(150.0)), "{found}");
        assert_counts_answers(&list(&found, "counts"), &found);
    }
}
