//! `malleus separate` as its user calls it: stems, tables, the report, and what it refuses.
//! `cargo test -p malleus --test separate` runs this file.

use std::path::Path;
use std::process::{Command, Output};

use fit::separate::synthetic::set;
use tempfile::TempDir;

const STEP: f64 = 8_388_608.0;

/// Folder with the recordings t0s0.wav to t1s1.wav of two strikers on two things.
fn recorded() -> TempDir {
    recorded_with(0.0)
}

/// Folder with the same recordings, to which an offset is added.
fn recorded_with(offset: f64) -> TempDir {
    let folder = TempDir::new().expect("a folder");
    for blow in set(77, 2, 2, 1) {
        let spec = hound::WavSpec {
            channels: 1,
            sample_rate: 44_100,
            bits_per_sample: 24,
            sample_format: hound::SampleFormat::Int,
        };
        let path = folder.path().join(format!("t{}s{}.wav", blow.object, blow.striker));
        let mut writer = hound::WavWriter::create(path, spec).expect("a file");
        for x in &blow.samples[..26_000] {
            writer.write_sample(((x + offset) * STEP).round() as i32).expect("a sample");
        }
        writer.finalize().expect("a whole file");
    }
    folder
}

fn separate(folder: &Path, labels: &str, words: &str) -> Output {
    std::fs::write(folder.join("labels.csv"), labels).expect("labels");
    let words = format!("separate {words} --labels labels.csv");
    let done = Command::new(env!("CARGO_BIN_EXE_malleus")).current_dir(folder).args(words.split_whitespace()).output();
    done.expect("the program runs")
}

fn floats(path: &Path) -> Vec<f64> {
    let mut reader = hound::WavReader::open(path).expect("a stem");
    reader.samples::<f32>().map(|x| f64::from(x.expect("a sample"))).collect()
}

const LABELS: &str = "recording,object,striker\nt0s0,mug,fork\nt0s1,mug,spoon\nt1s0.wav,bowl,fork\nt1s1,bowl,spoon\n";
const ALL: &str = "t0s0.wav t0s1.wav t1s0.wav t1s1.wav";

#[test]
fn stems_add_up_to_the_recording_and_known_tables_are_kept() {
    let folder = recorded();
    let at = |name: &str| folder.path().join(name);
    let done = separate(folder.path(), LABELS, &format!("{ALL} -o out --json --materials ceramic,steel"));
    assert_eq!(done.status.code(), Some(0), "{}", String::from_utf8_lossy(&done.stderr));
    let rows: serde_json::Value = serde_json::from_slice(&done.stdout).expect("JSON");
    assert_eq!(rows.as_array().expect("rows").len(), 4);
    for row in rows.as_array().expect("rows") {
        assert!(row["left_db"].as_f64().expect("a number") < -15.0, "{}", row["left_db"]);
        for part in ["object", "striker"] {
            let modulus = &row[part]["young_modulus_pa"];
            let [low, estimate, high] = ["low", "estimate", "high"].map(|key| modulus[key].as_f64().expect("a number"));
            assert!(low < estimate && estimate < high, "{modulus}");
            assert!(["ceramic", "steel"].contains(&row[part]["material"]["name"].as_str().expect("a name")));
        }
    }
    for name in ["t0s0", "t1s1"] {
        let mut reader = hound::WavReader::open(at(&format!("{name}.wav"))).expect("a recording");
        let recording: Vec<f64> = reader.samples::<i32>().map(|x| f64::from(x.expect("a sample")) / STEP).collect();
        let stems = ["object", "striker", "rest"].map(|stem| floats(&at(&format!("out/{name}-{stem}.wav"))));
        let off = recording.iter().enumerate().map(|(n, x)| (x - stems[0][n] - stems[1][n] - stems[2][n]).abs());
        let worst = off.fold(0.0, f64::max);
        assert!(stems.iter().all(|stem| stem.len() == recording.len()) && worst < 6e-8, "{name}: {worst}");
    }
    let done = separate(
        folder.path(),
        LABELS,
        &format!("{ALL} -o again --object out/mug-object.toml --striker fork=out/fork-striker.toml"),
    );
    assert_eq!(done.status.code(), Some(0), "{}", String::from_utf8_lossy(&done.stderr));
    for table in ["mug-object", "fork-striker"] {
        let frequencies = |folder: &str| {
            let text = std::fs::read_to_string(at(&format!("{folder}/{table}.toml"))).expect("a table");
            text.lines()
                .filter_map(|line| line.trim().strip_prefix("{ frequency_hz = ")?.split(',').next().map(str::to_owned))
                .collect::<Vec<String>>()
        };
        assert!(!frequencies("out").is_empty());
        assert_eq!(frequencies("out"), frequencies("again"));
    }
}

#[test]
fn constant_offset_of_a_recording_goes_into_its_rest_and_is_named() {
    let folder = recorded_with(0.05);
    let at = |name: &str| folder.path().join(name);
    let done = separate(folder.path(), LABELS, &format!("{ALL} -o out --json"));
    assert_eq!(done.status.code(), Some(0), "{}", String::from_utf8_lossy(&done.stderr));
    let rows: serde_json::Value = serde_json::from_slice(&done.stdout).expect("JSON");
    for row in rows.as_array().expect("rows") {
        assert!(row["left_db"].as_f64().expect("a number") < -15.0, "{}", row["left_db"]);
        assert!(row["notes"][0].as_str().is_some_and(|note| note.contains("offset of 5.00e-2")), "{}", row["notes"]);
    }
    let mut reader = hound::WavReader::open(at("t0s0.wav")).expect("a recording");
    let recording: Vec<f64> = reader.samples::<i32>().map(|x| f64::from(x.expect("a sample")) / STEP).collect();
    let stems = ["object", "striker", "rest"].map(|stem| floats(&at(&format!("out/t0s0-{stem}.wav"))));
    let off = recording.iter().enumerate().map(|(n, x)| (x - stems[0][n] - stems[1][n] - stems[2][n]).abs());
    assert!(off.fold(0.0, f64::max) < 6e-8);
    let mean = |sound: &[f64]| sound.iter().sum::<f64>() / sound.len() as f64;
    assert!((mean(&stems[2]) - 0.05).abs() < 1e-3 && mean(&stems[0]).abs() < 1e-3, "{}", mean(&stems[2]));
}

#[test]
fn wrong_labels_and_files_are_refused_and_nothing_is_written() {
    let folder = recorded();
    std::fs::write(folder.path().join("noise.wav"), b"RIFF of nothing").expect("a file");
    let one_pair = "recording,object,striker\nt0s0,mug,fork\n";
    for (labels, words, expected) in [
        (LABELS, "t0s0.wav t0s1.wav t1s0.wav", "line 5 names \"t1s1\", which is none of the recordings given"),
        (one_pair, "t0s0.wav t0s1.wav", "t0s1.wav: it has no label"),
        (one_pair, "t0s0.wav", "one thing and one striker"),
        (
            "recording,object,striker\nt0s0,mug,fork\nt1s1,bowl,spoon\n",
            "t0s0.wav t1s1.wav",
            "every thing is struck by one striker alone",
        ),
        (&format!("{one_pair}noise,bowl,fork\n"), "t0s0.wav noise.wav", "noise.wav: not audio"),
        (&format!("{one_pair}gone,bowl,fork\n"), "t0s0.wav gone.wav", "gone.wav: the file cannot be read"),
        (LABELS, &format!("{ALL} --object cup=labels.csv"), "--object \"cup\": no recording has this object"),
        (LABELS, &format!("{ALL} --materials granite"), "there is no material \"granite\""),
    ] {
        let done = separate(folder.path(), labels, &format!("{words} -o out"));
        let said = String::from_utf8_lossy(&done.stderr).into_owned();
        assert_eq!(done.status.code(), Some(1), "{said}");
        assert!(said.contains(expected) && said.lines().count() == 1, "{said}");
        assert!(!folder.path().join("out").exists(), "{expected}");
    }
}

#[test]
fn known_table_that_would_be_written_over_is_refused_and_kept() {
    let folder = recorded();
    let known = folder.path().join("out/mug-object.toml");
    std::fs::create_dir(folder.path().join("out")).expect("a folder");
    std::fs::copy(concat!(env!("CARGO_MANIFEST_DIR"), "/../tables/bowl.toml"), &known).expect("a table");
    let before = std::fs::read(&known).expect("a table");
    for option in ["mug=out/mug-object.toml", "out/../out/mug-object.toml"] {
        let done = separate(folder.path(), LABELS, &format!("{ALL} -o out --object {option}"));
        let said = String::from_utf8_lossy(&done.stderr).into_owned();
        assert!(done.status.code() == Some(1) && said.contains("mug-object.toml: is read by this command"), "{said}");
    }
    assert_eq!(std::fs::read(&known).expect("a table"), before);
    assert_eq!(std::fs::read_dir(folder.path().join("out")).expect("a folder").count(), 1);
}

#[test]
fn clipped_recording_is_named_with_the_times_of_its_clipped_blows() {
    let folder = recorded();
    let path = folder.path().join("t1s0.wav");
    let mut reader = hound::WavReader::open(&path).expect("a recording");
    let spec = reader.spec();
    let samples: Vec<i32> = reader.samples().map(|x| x.expect("a sample")).collect();
    let limit = samples.iter().fold(0, |most, x| x.abs().max(most)) / 4;
    let mut writer = hound::WavWriter::create(&path, spec).expect("a file");
    samples.iter().for_each(|x| writer.write_sample((*x).clamp(-limit, limit)).expect("a sample"));
    writer.finalize().expect("a whole file");
    let done = separate(folder.path(), LABELS, &format!("{ALL} -o out"));
    let said = String::from_utf8_lossy(&done.stdout).into_owned();
    assert_eq!(done.status.code(), Some(0), "{}", String::from_utf8_lossy(&done.stderr));
    let lines: Vec<&str> = said.lines().collect();
    let noted: Vec<usize> = (0..lines.len()).filter(|&line| lines[line].contains("clipped blows")).collect();
    assert!(noted.len() == 1 && lines[noted[0] - 1].starts_with("t1s0.wav"), "{said}");
}
