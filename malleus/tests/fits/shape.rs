//! `malleus shape` as its user calls it.

use std::path::Path;
use std::process::{Command, Output};

use tempfile::TempDir;

/// Bar of docs/shape.md.
pub(crate) const BAR: &str = r#"
format = 1
name = "bar"
[shape]
kind = "plate"
polygon_m = [[0, 0], [0.2, 0], [0.2, 0.03], [0, 0.03]]
thickness_m = 0.008
[material]
name = "steel"
[strike]
path_m = [[0.1, 0.015], [0.0, 0.015]]
positions = 3
[sound]
readout = "velocity"
at_m = [0.2, 0.0]
"#;

pub(crate) fn with_bar() -> TempDir {
    let folder = TempDir::new().expect("a folder");
    std::fs::write(folder.path().join("bar.toml"), BAR).expect("the folder is writable");
    folder
}

pub(crate) fn shape(folder: &Path, words: &str) -> Output {
    let program = Command::new(env!("CARGO_BIN_EXE_malleus"))
        .current_dir(folder)
        .arg("shape")
        .args(words.split_whitespace())
        .output();
    program.expect("the program runs")
}

#[test]
fn table_of_a_bar_has_the_modes_that_its_report_names_and_sounds_at_each_position() {
    let folder = with_bar();
    let done = shape(folder.path(), "bar.toml -o table.toml --modes 5 --error 0.002 --render bar.wav --json");
    assert!(done.status.success(), "{}", String::from_utf8_lossy(&done.stderr));
    let report: serde_json::Value = serde_json::from_slice(&done.stdout).expect("a report");
    let text = std::fs::read_to_string(folder.path().join("table.toml")).expect("a table");
    let table: toml::Table = text.parse().expect("TOML");
    let modes = table["object"][0]["modes"].as_array().expect("modes");
    assert_eq!(modes.len(), 5);
    for (mode, told) in modes.iter().zip(report["modes"].as_array().expect("modes")) {
        let [kept, told] = [mode["frequency_hz"].as_float(), told["frequency_hz"].as_f64()].map(Option::unwrap);
        assert!((kept / told - 1.0).abs() < 1e-7, "{kept} {told}");
    }
    // Euler and Bernoulli's bar has 1038 Hz; shear and rotary inertia take half a percent.
    let lowest = report["modes"][0]["frequency_hz"].as_f64().expect("a number");
    assert!((lowest - 1032.5).abs() < 1.5, "{lowest}");
    assert!((report["mass_kg"].as_f64().expect("a number") - 0.3768).abs() < 1e-9);
    let mut sound = hound::WavReader::open(folder.path().join("bar.wav")).expect("a sound");
    let samples: Vec<i32> = sound.samples::<i32>().map(Result::unwrap).collect();
    assert_eq!(samples.len(), 2 * 3 * 48_000);
    for strike in samples.chunks(2 * 48_000) {
        let peak = strike.iter().map(|sample| sample.unsigned_abs()).max();
        assert!(peak > Some(1 << 18), "a strike peaks at {peak:?}");
    }
}

#[test]
fn estimate_of_a_clamped_plate_is_above_the_error_asked_for_and_help_says_so() {
    let folder = with_bar();
    let support = "[support]\nedges = [\"clamped\", \"clamped\", \"clamped\", \"clamped\"]\n";
    let clamped = BAR
        .replace("[[0, 0], [0.2, 0], [0.2, 0.03], [0, 0.03]]", "[[0, 0], [0.8, 0], [0.8, 0.12], [0, 0.12]]")
        .replace("thickness_m = 0.008", "thickness_m = 0.032")
        .replace("[[0.1, 0.015], [0.0, 0.015]]", "[[0.1, 0.06], [0.7, 0.06]]")
        .replace("at_m = [0.2, 0.0]", "at_m = [0.2, 0.05]")
        + support;
    std::fs::write(folder.path().join("clamped.toml"), clamped).expect("the folder is writable");
    let done = shape(folder.path(), "clamped.toml -o table.toml --modes 1 --error 0.01 --json");
    assert!(done.status.success(), "{}", String::from_utf8_lossy(&done.stderr));
    let report: serde_json::Value = serde_json::from_slice(&done.stdout).expect("a report");
    assert!(report["modes"][0]["error"].as_f64().expect("a number") > 0.01, "{report}");
    let help = String::from_utf8(shape(folder.path(), "--help").stdout).expect("text");
    let words: Vec<&str> = help.split_whitespace().collect();
    assert!(words.join(" ").contains("the printed estimate is above this number"), "{help}");
}

/// Corners of a block of 10, 3 and 2 cm, and its faces, as the text of an OBJ file.
const BLOCK: &str = "v 0 0 0\nv 10 0 0\nv 0 3 0\nv 10 3 0\nv 0 0 2\nv 10 0 2\nv 0 3 2\nv 10 3 2\n\
    f 1 3 4 2\nf 5 6 8 7\nf 1 2 6 5\nf 3 7 8 4\nf 1 5 7 3\nf 2 4 8 6\n";

#[test]
fn table_of_a_solid_comes_from_its_surface_and_a_surface_with_a_gap_is_refused() {
    let folder = TempDir::new().expect("a folder");
    let write = |name: &str, text: &str| std::fs::write(folder.path().join(name), text).expect("a file");
    let file = "format = 1\nname = \"block\"\n[shape]\nkind = \"solid\"\nsurface = \"block.obj\"\nunit_m = 0.01\n\
        [material]\nname = \"wood\"\n[strike]\npath_m = [[0.05, 0.015, 0.02], [0.1, 0.015, 0.02]]\npositions = 2\n\
        [sound]\nreadout = \"velocity\"\nat_m = [0.0, 0.0, 0.02]\n";
    write("block.toml", file);
    write("block.obj", BLOCK);
    let done = shape(folder.path(), "block.toml -o t.toml --modes 6 --error 0.01 --report pages --json");
    assert!(done.status.success(), "{}", String::from_utf8_lossy(&done.stderr));
    let report: serde_json::Value = serde_json::from_slice(&done.stdout).expect("a report");
    assert!((report["mass_kg"].as_f64().expect("a number") - 0.045).abs() < 1e-6, "{report}");
    assert_eq!(report["rigid"], 6);
    // A rod of such a cross-section bends at 7.9 kHz by Euler and Bernoulli, and less as it shears.
    let lowest = report["modes"][0]["frequency_hz"].as_f64().expect("a number");
    assert!((6000.0..7800.0).contains(&lowest), "{lowest} Hz");
    let page = std::fs::read_to_string(folder.path().join("pages/index.html")).expect("a page");
    assert_eq!(page.matches("<figure class=\"mode\">").count(), 6);
    write("block.obj", &BLOCK.replace("f 2 4 8 6\n", ""));
    let done = shape(folder.path(), "block.toml -o gap.toml");
    let message = String::from_utf8_lossy(&done.stderr);
    assert!(!done.status.success() && message.contains("has a gap at the edge"), "{message}");
    assert!(!folder.path().join("gap.toml").exists());
}

#[test]
fn half_a_pair_is_told_at_the_end_and_in_the_report() {
    let folder = TempDir::new().expect("a folder");
    let disc = BAR
        .replace("polygon_m = [[0, 0], [0.2, 0], [0.2, 0.03], [0, 0.03]]", "outline = \"disc.svg\"\nunit_m = 0.001")
        .replace("at_m = [0.2, 0.0]", "at_m = [0.1, -0.1]")
        .replace("path_m = [[0.1, 0.015], [0.0, 0.015]]", "path_m = [[0.1, -0.1], [0.15, -0.1]]");
    let drawing = "<svg xmlns=\"http://www.w3.org/2000/svg\"><circle cx=\"100\" cy=\"100\" r=\"80\"/></svg>";
    std::fs::write(folder.path().join("disc.toml"), disc).expect("the folder is writable");
    std::fs::write(folder.path().join("disc.svg"), drawing).expect("the folder is writable");
    // The lowest modes of a free disc: a pair, one alone, a pair.
    for (modes, is_cut) in [(1, true), (2, false), (3, false), (4, true)] {
        let words = format!("disc.toml -o t.toml --error 0.01 --modes {modes}");
        let done = shape(folder.path(), &words);
        let text = String::from_utf8_lossy(&done.stdout);
        assert!(done.status.success(), "{}", String::from_utf8_lossy(&done.stderr));
        assert_eq!(text.contains("half a pair beats otherwise"), is_cut, "{text}");
        let done = shape(folder.path(), &(words + " --json"));
        let report: serde_json::Value = serde_json::from_slice(&done.stdout).expect("a report");
        assert_eq!(report["cut_pair"], is_cut, "{modes}");
    }
}

#[test]
fn shapes_that_cannot_be_solved_are_refused_without_a_file() {
    let folder = with_bar();
    let write = |name: &str, from: &str, to: &str| {
        std::fs::write(folder.path().join(name), BAR.replace(from, to)).expect("the folder is writable");
    };
    write("unknown.toml", "kind", "knid");
    write("thick.toml", "0.008", "0.02");
    write("millimetres.toml", "[0.2, 0], [0.2, 0.03], [0, 0.03]", "[200, 0], [200, 30], [0, 30]");
    write(
        "drawn.toml",
        "polygon_m = [[0, 0], [0.2, 0], [0.2, 0.03], [0, 0.03]]",
        "outline = \"o.svg\"\nunit_m = 0.001",
    );
    std::fs::write(folder.path().join("o.svg"), "<svg xmlns=\"http://www.w3.org/2000/svg\"/>").expect("a drawing");
    write(
        "pictured.toml",
        "polygon_m = [[0, 0], [0.2, 0], [0.2, 0.03], [0, 0.03]]",
        "outline = \"o.png\"\nunit_m = 0.001",
    );
    std::fs::write(folder.path().join("o.png"), "no picture").expect("a file");
    for (words, reason) in [
        ("absent.toml -o t.toml", "cannot be read"),
        ("bar.toml -o bar.toml", "would be lost"),
        ("bar.toml -o t.toml --modes 0", "--modes"),
        ("bar.toml -o t.toml --modes 1000000000", "1 to 4096, as many as a table holds"),
        ("bar.toml -o t.toml --budget 1e12", "at most the 4096 modes"),
        ("bar.toml -o t.toml --budget 9", "at least 9.42, the cycles a sample of one mode"),
        ("bar.toml -o t.toml --budget nan", "at least 9.42"),
        ("bar.toml -o t.toml --max-hz 50", "--modes N"),
        ("bar.toml -o t.toml --max-hz 1e12", "at most 24000, half the sample rate"),
        ("bar.toml -o t.toml --max-hz nan", "--max-hz"),
        ("bar.toml -o t.toml --render t.toml", "one would be lost"),
        ("unknown.toml -o t.toml", "line 5"),
        ("thick.toml -o t.toml", "that is no plate"),
        ("millimetres.toml -o t.toml", "lengths are in metres"),
        ("drawn.toml -o t.toml", "o.svg"),
        ("pictured.toml -o t.toml", "not readable as PNG"),
    ] {
        let done = shape(folder.path(), words);
        let message = String::from_utf8_lossy(&done.stderr);
        assert!(!done.status.success() && message.contains(reason), "{words}: {message}");
        assert!(!message.contains("panicked"), "{words}: {message}");
        assert!(!folder.path().join("t.toml").exists(), "{words} leaves a file");
    }
}

#[test]
fn decays_of_a_report_are_those_of_the_table_also_without_losses() {
    let folder = with_bar();
    for (losses, decay_per_s) in [("loss_factor = 0", Some(0.01)), ("loss_factor = 0.01", None)] {
        let lossless = BAR.replace("name = \"steel\"", &format!("name = \"steel\"\n{losses}"));
        std::fs::write(folder.path().join("bar.toml"), lossless).expect("the folder is writable");
        let done = shape(folder.path(), "bar.toml -o t.toml --budget 20 --error 0.01 --report pages --json");
        assert!(done.status.success(), "{}", String::from_utf8_lossy(&done.stderr));
        let report: serde_json::Value = serde_json::from_slice(&done.stdout).expect("a report");
        let table: toml::Table =
            std::fs::read_to_string(folder.path().join("t.toml")).expect("a table").parse().unwrap();
        let modes = table["object"][0]["modes"].as_array().expect("modes");
        assert_eq!(modes.len(), 2, "as many as 20 cycles a sample play");
        for (kept, told) in modes.iter().zip(report["modes"].as_array().expect("modes")) {
            let [kept, told] = [kept["decay_per_s"].as_float(), told["decay_per_s"].as_f64()].map(Option::unwrap);
            assert!((kept / told - 1.0).abs() < 1e-6, "{losses}: {kept} in the table, {told} in the report");
            assert!(decay_per_s.is_none_or(|expected: f64| (told - expected).abs() < 1e-9), "{losses}: {told}");
        }
        let page = std::fs::read_to_string(folder.path().join("pages/index.html")).expect("a page");
        assert_eq!(page.contains("0.010 1/s"), decay_per_s.is_some(), "{losses}");
        assert!(!page.contains("no end"), "{losses}");
    }
}

/// Names of all that lies in a folder, and the bytes of the files.
fn contents(folder: &Path) -> Vec<(std::ffi::OsString, Option<Vec<u8>>)> {
    let entries = std::fs::read_dir(folder).expect("a folder").map(|entry| entry.expect("an entry"));
    let mut contents: Vec<_> = entries.map(|entry| (entry.file_name(), std::fs::read(entry.path()).ok())).collect();
    contents.sort();
    contents
}

#[test]
fn an_output_that_cannot_be_written_leaves_all_files_as_they_were() {
    let folder = with_bar();
    let path = |name: &str| folder.path().join(name);
    std::fs::create_dir(path("folder")).expect("made");
    std::fs::write(path("file"), "a file").expect("written");
    std::fs::write(path("old.toml"), "an old table").expect("written");
    let square = r#"<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 9 9"><rect width="9" height="9"/></svg>"#;
    std::fs::write(path("o.svg"), square).expect("written");
    let polygon = "polygon_m = [[0, 0], [0.2, 0], [0.2, 0.03], [0, 0.03]]";
    let drawn = BAR.replace(polygon, "outline = \"o.svg\"\nunit_m = 0.01");
    std::fs::write(path("drawn.toml"), drawn).expect("written");
    let before = contents(folder.path());
    for (words, reason) in [
        ("bar.toml -o folder", "cannot be written"),
        ("bar.toml -o missing/t.toml", "make its folder first"),
        ("bar.toml -o t.toml --render folder", "cannot be written"),
        ("bar.toml -o old.toml --render missing/x.wav", "make its folder first"),
        ("bar.toml -o old.toml --render file/x.wav", "cannot be written"),
        ("bar.toml -o old.toml --report file/pages", "is a file"),
        ("bar.toml -o t.toml --render folder --report pages/of/bar", "cannot be written"),
        ("bar.toml -o t.toml --render ./t.toml", "one would be lost"),
        ("bar.toml -o pages/index.html --report pages", "one would be lost"),
        ("bar.toml -o t.toml --undercut 1:4 --tuned folder", "cannot be written"),
        ("bar.toml -o t.toml --undercut 1:4 --tuned missing/t.toml", "make its folder first"),
        ("drawn.toml -o o.svg", "would be lost"),
        ("drawn.toml -o t.toml --render o.svg", "would be lost"),
        // No body: the page's folder is not made.
        ("bar.toml -o t.toml --render x.wav --report pages --error 2", "error"),
    ] {
        let done = shape(folder.path(), words);
        let message = String::from_utf8_lossy(&done.stderr);
        assert!(!done.status.success() && message.contains(reason), "{words}: {message}");
        assert!(!message.contains("panicked"), "{words}: {message}");
        assert!(contents(folder.path()) == before, "{words} changes the folder");
    }
    assert_eq!(std::fs::read_dir(path("folder")).expect("a folder").count(), 0);
}

#[cfg(unix)]
#[test]
fn an_output_in_a_folder_that_takes_no_files_leaves_no_table() {
    use std::os::unix::fs::PermissionsExt;
    let folder = with_bar();
    let locked = folder.path().join("locked");
    std::fs::create_dir(&locked).expect("made");
    std::fs::set_permissions(&locked, std::fs::Permissions::from_mode(0o555)).expect("locked");
    if std::fs::write(locked.join("x"), "x").is_ok() {
        // The system's administrator may write everywhere.
        return;
    }
    for words in ["-o t.toml --render locked/x.wav", "-o t.toml --report locked/pages", "-o t.toml --report locked"] {
        let done = shape(folder.path(), &format!("bar.toml {words}"));
        let message = String::from_utf8_lossy(&done.stderr);
        assert!(!done.status.success() && message.contains("locked"), "{words}: {message}");
        assert!(!folder.path().join("t.toml").exists(), "{words} leaves a table");
    }
}

/// Picture of a dark L on white, 60 pixels high and wide.
fn picture_of_an_l() -> Vec<u8> {
    let dark = |x: usize, y: usize| (10..70).contains(&x) && (20..80).contains(&y) && (x < 30 || y >= 60);
    let values: Vec<u8> = (0..100 * 100).map(|index| if dark(index % 100, index / 100) { 0 } else { 255 }).collect();
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, 100, 100);
    encoder.set_color(png::ColorType::Grayscale);
    let mut writer = encoder.write_header().expect("a header");
    writer.write_image_data(&values).expect("pixels");
    writer.finish().expect("an end");
    bytes
}

#[test]
fn places_on_a_drawing_and_a_picture_have_y_below_zero_from_the_upper_left_corner() {
    let folder = TempDir::new().expect("a folder");
    let path = |name: &str| folder.path().join(name);
    // The view box of this L does not begin at 0, 0.
    let drawing = r#"<svg xmlns="http://www.w3.org/2000/svg" viewBox="-10 -20 100 100"><path d="M0 0 H20 V40 H60 V60 H0 Z"/></svg>"#;
    std::fs::write(path("l.svg"), drawing).expect("written");
    std::fs::write(path("l.png"), picture_of_an_l()).expect("written");
    for outline in ["l.svg", "l.png"] {
        // Column 20 and row 30 lie on the upright part, column 60 and row 30 beside it.
        for (place, is_on_body) in [("[0.02, -0.03]", true), ("[0.06, -0.03]", false), ("[0.02, 0.03]", false)] {
            let text = format!(
                "format = 1\nname = \"l\"\n[shape]\nkind = \"plate\"\noutline = \"{outline}\"\nunit_m = 0.001\n\
                 thickness_m = 0.001\n[material]\nname = \"steel\"\n[strike]\npath_m = [{place}]\npositions = 1\n"
            );
            std::fs::write(path("l.toml"), text).expect("written");
            let done = shape(folder.path(), "l.toml -o t.toml --modes 2 --error 0.02");
            let message = String::from_utf8_lossy(&done.stderr);
            assert_eq!(done.status.success(), is_on_body, "{outline} {place}: {message}");
            assert!(is_on_body || message.contains("strike.path_m"), "{outline} {place}: {message}");
        }
    }
}

#[test]
fn one_mode_is_counted_as_one() {
    let folder = with_bar();
    let done = shape(folder.path(), "bar.toml -o table.toml --modes 1 --error 0.05");
    let printed = String::from_utf8_lossy(&done.stdout).into_owned();
    assert!(done.status.success() && printed.contains("table.toml: 1 mode of a body"), "{printed}");
}
