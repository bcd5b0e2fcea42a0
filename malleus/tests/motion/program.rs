//! `malleus motion` as its user calls it.

use std::path::Path;
use std::process::{Command, Output};

fn malleus(folder: &Path, words: &str) -> Output {
    let program = Command::new(env!("CARGO_BIN_EXE_malleus")).current_dir(folder).args(words.split(' ')).output();
    program.expect("the program runs")
}

const PATHS: [&str; 6] = ["back-and-forth", "four-strokes", "circle", "line", "scribble", "roll"];

#[test]
fn each_path_is_written_as_a_motion_that_its_report_describes() {
    let folder = tempfile::tempdir().unwrap();
    for path in PATHS {
        let words = format!("motion {path} -o m.csv --pad drum --striker pen --start 0.5 --at -0.1,0.2 --json");
        let done = malleus(folder.path(), &words);
        assert!(done.status.success(), "{}", String::from_utf8_lossy(&done.stderr));
        let report: serde_json::Value = serde_json::from_slice(&done.stdout).unwrap();
        let motion = crate::parse(&std::fs::read(folder.path().join("m.csv")).unwrap()).unwrap();
        assert_eq!(report["motion"], path);
        assert_eq!(report["contacts"], motion.contacts().len());
        assert_eq!(report["end_s"], motion.end_s());
        let state = motion.at(0.5).unwrap();
        assert_eq!((state.pad, state.striker, state.position_m), (1, 0, [-0.1, 0.2]));
    }
}

#[test]
fn varied_motions_follow_their_seeds() {
    let folder = tempfile::tempdir().unwrap();
    let written = |words: &str| {
        let done = malleus(folder.path(), &format!("motion {words} -o m.csv"));
        assert!(done.status.success(), "{}", String::from_utf8_lossy(&done.stderr));
        std::fs::read(folder.path().join("m.csv")).unwrap()
    };
    for path in PATHS {
        let [one, same, other] = [7, 7, 8].map(|seed| written(&format!("{path} --vary --seed {seed}")));
        assert!(one == same && one != other, "{path}");
    }
}

#[test]
fn motions_that_cannot_be_are_refused_without_a_file() {
    let folder = tempfile::tempdir().unwrap();
    for (words, reason) in [
        ("line -o m.csv --speed 20", "--speed 20: must be from 0.001 to 10 m/s"),
        ("circle -o m.csv --length 0", "--length 0: must be from 0.001 to 100 metres"),
        ("line -o m.csv --length inf", "--length inf: must be"),
        ("back-and-forth -o m.csv --period 0.04", "s of the motion, and no motion is faster than 10 m/s"),
        ("scribble -o m.csv --speed 10", "s of the motion, and no motion is faster than 10 m/s"),
        ("roll -o m.csv --incline 3 --speed 0", "a ball at rest rolls downhill only"),
        ("scribble -o m.csv --at 0", "must be two numbers in metres"),
        ("line -o m.csv --length 100 --speed 0.05", "at most 600 s"),
        ("line -o absent/m.csv", "make its folder first"),
    ] {
        let done = malleus(folder.path(), &format!("motion {words}"));
        let error = String::from_utf8_lossy(&done.stderr);
        assert!(!done.status.success() && error.contains(reason), "{words}: {error}");
        assert!(!error.contains("panicked") && std::fs::read_dir(folder.path()).unwrap().count() == 0, "{words}");
    }
}

#[test]
fn help_of_motion_names_every_path() {
    let help = String::from_utf8(malleus(Path::new("."), "motion --help").stdout).unwrap();
    assert!(PATHS.iter().all(|path| help.contains(path)), "{help}");
}
