//! Kits with dynamic filters and biquads, as the program's user plays and checks them.

use std::fs;
use std::path::Path;
use std::process::{Command, Output};

use tempfile::TempDir;

const KIT: &str = r#"format = 1
name = "test"

[[object]]
name = "bar"
modes = [ { frequency_hz = 440, decay_per_s = 30, gain_sine = 300 } ]

[object.dynamic_filter]
path = [
    { time_s = 0, a1 = -0.5, b0 = 0.25 },
    { time_s = 0.125, a1 = -0.96875, b0 = 0 },
]
loops = [ { frequency_hz = 500, bandwidth_hz = 5, gain = 0.25, delay_s = 0.004 } ]

[object.biquads]
chains = [ [ { pole = [0.99, 0.05], zero = [1, 0], gain = 0.01 } ] ]

[[striker]]
name = "stick"
peak_force = 1
contact_time_s = 0.0005

[[pad]]
name = "bar"
object = "bar"
strikers = ["stick"]
"#;

fn malleus(folder: &Path, words: &str) -> Output {
    Command::new(env!("CARGO_BIN_EXE_malleus")).args(words.split(' ')).current_dir(folder).output().unwrap()
}

fn folder(kit: &str) -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("kit.toml"), kit).unwrap();
    fs::write(folder.path().join("s.csv"), "time_s,pad,velocity\n0.01,bar,1\n0.2,bar,0.5\n").unwrap();
    folder
}

/// Message of `malleus kit check` on the kit after one part of its text is replaced.
///
/// Asserts that both `kit check` and `play` refuse the kit with exit code 1.
fn refusal(from: &str, to: &str) -> String {
    assert_eq!(KIT.matches(from).count(), 1, "{from:?} stands there once");
    let folder = folder(&KIT.replace(from, to));
    let play = malleus(folder.path(), "play --kit kit.toml --strikes s.csv -o out.wav");
    assert_eq!(play.status.code(), Some(1), "{to}");
    assert!(!folder.path().join("out.wav").exists());
    let check = malleus(folder.path(), "kit check kit.toml");
    let message = String::from_utf8_lossy(&check.stderr).trim_end().to_owned();
    assert_eq!(check.status.code(), Some(1), "{to}: {message}");
    assert!(!message.contains("panicked"), "{message}");
    message
}

#[test]
fn kit_with_filters_is_played_and_the_report_counts_the_frames_of_its_filters() {
    let folder = folder(KIT);
    let check = malleus(folder.path(), "kit check kit.toml");
    assert!(check.status.success() && check.stderr.is_empty(), "{}", String::from_utf8_lossy(&check.stderr));
    let play = malleus(folder.path(), "play --kit kit.toml --strikes s.csv -o out.wav --json");
    assert!(play.status.success(), "{}", String::from_utf8_lossy(&play.stderr));
    let report: serde_json::Value = serde_json::from_slice(&play.stdout).unwrap();
    for key in ["filter_frames", "loop_frames", "biquad_frames"] {
        assert!(report["work"][key].as_u64() >= Some(3_000), "{key}: {}", report["work"]);
    }
    let show = malleus(folder.path(), "kit show kit.toml --plot kit.png");
    assert!(show.status.success(), "{}", String::from_utf8_lossy(&show.stderr));
    let text = String::from_utf8_lossy(&show.stdout).into_owned();
    assert!(text.contains("[object.dynamic_filter]") && text.contains("[object.biquads]"), "{text}");
    // The text that `kit show` prints and the binary form give the same bits as the kit's own text.
    fs::write(folder.path().join("shown.toml"), &text).unwrap();
    assert!(malleus(folder.path(), "kit build kit.toml -o kit.bin").status.success());
    let first = fs::read(folder.path().join("out.wav")).unwrap();
    for (kit, block) in [("shown.toml", 128), ("kit.bin", 1), ("kit.bin", 33)] {
        malleus(folder.path(), &format!("play --kit {kit} --strikes s.csv -o other.wav --block {block}"));
        assert!(fs::read(folder.path().join("other.wav")).unwrap() == first, "{kit} in blocks of {block}");
    }
}

#[test]
fn reference_plays_filters_and_says_what_it_leaves_out() {
    let start = KIT.find("[object.dynamic_filter]").unwrap();
    let end = KIT.find("[object.biquads]").unwrap();
    let biquads = format!("{}{}", &KIT[..start], &KIT[end..]).replace("gain = 0.01", "gain = 0.125");
    let events =
        "time_s,pad,velocity,action\n0.01,bar,1,\n0.015,bar,,choke\n0.02,bar,0.5,\n0.1,bar,,release\n0.2,bar,1,\n";
    // Zeros that move with the rate: a real one below 0, and one beyond half of 22.05 kHz.
    let of_zero = |zero: &str| biquads.replace("zero = [1, 0]", zero).replace("gain = 0.125", "gain = 0.0003");
    let (negative, high) = (of_zero("zero = [-1, 0]"), of_zero("zero = [-0.8, 0.3]"));
    for (kit, steps) in [(&*biquads, 2), (&*negative, 2), (&*high, 2), (KIT, 40)] {
        let folder = folder(kit);
        fs::write(folder.path().join("s.csv"), events).unwrap();
        let sound = |words: &str, file: &str| -> Vec<i32> {
            let output = malleus(folder.path(), words);
            assert!(output.status.success() && output.stderr.is_empty(), "{}", String::from_utf8_lossy(&output.stderr));
            hound::WavReader::open(folder.path().join(file)).unwrap().into_samples().map(Result::unwrap).collect()
        };
        for rate in [48_000, 44_100, 96_000, 22_050] {
            let own = sound(&format!("play --kit kit.toml --strikes s.csv -o a.wav --no-skip --rate {rate}"), "a.wav");
            let reference =
                sound(&format!("play --kit kit.toml --strikes s.csv -o b.wav --reference --rate {rate}"), "b.wav");
            let worst = own.iter().zip(&reference).map(|(a, b)| a.abs_diff(*b)).max();
            assert!(own.len() == reference.len() && worst <= Some(steps), "{rate} Hz: {worst:?} steps of 24 bits");
            assert!(own.iter().any(|x| x.abs() > 1 << 17));
        }
    }
    let noisy = folder(&format!("{KIT}\n[background]\nseed = 1\nedges_hz = [100, 1000]\nweight = [0.001]\n"));
    let output = malleus(noisy.path(), "play --kit kit.toml --strikes s.csv -o out.wav --reference");
    let message = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success() && message.contains("the reference leaves out the background"), "{message}");
}

#[test]
fn new_kit_keeps_the_filters_of_its_tables() {
    let folder = folder(&KIT[..KIT.find("[[pad]]").unwrap()]);
    assert!(malleus(folder.path(), "kit new bound.toml kit.toml").status.success());
    let bound = fs::read_to_string(folder.path().join("bound.toml")).unwrap();
    assert!(bound.contains("[object.dynamic_filter]") && bound.contains("[object.biquads]"), "{bound}");
    let play = malleus(folder.path(), "play --kit bound.toml --strikes s.csv -o out.wav");
    assert!(play.status.success(), "{}", String::from_utf8_lossy(&play.stderr));
}

#[test]
fn filters_that_are_invalid_at_any_rate_are_refused_with_file_and_line() {
    for (from, to, expected) in [
        ("a1 = -0.96875", "a1 = -1.5", "breakpoint 1: a1: a pole of radius 1.5 does not decay"),
        ("time_s = 0.125", "time_s = 0", "breakpoint 1: time_s = 0: must be later than the breakpoint before it, 0"),
        ("pole = [0.99, 0.05]", "pole = [0.99, 0.15]", "chain 0, biquad 0: pole: a pole of radius 1.001"),
        ("bandwidth_hz = 5", "bandwidth_hz = 600", "loop 0: bandwidth_hz = 600: must be from 0.01 to 500"),
        (
            "path = [",
            "exciter = { low_hz = 900, high_hz = 300 }\npath = [",
            "high_hz = 300: must be at least 1 Hz above",
        ),
    ] {
        let message = refusal(from, to);
        assert!(message.starts_with("malleus: kit.toml:") && message.contains(expected), "{message}");
        assert!(message.contains("object 0 \"bar\""), "{message}");
    }
}

#[test]
fn filters_that_are_unstable_or_beyond_nyquist_at_the_rate_are_refused() {
    let message = refusal("gain = 0.25", "gain = 25");
    assert!(message.starts_with("malleus: kit.toml: object \"bar\" at 48000 Hz: dynamic filter: "), "{message}");
    assert!(message.contains("gain round the loops"), "{message}");
    let message = refusal("frequency_hz = 500", "frequency_hz = 30000");
    assert!(message.contains("object \"bar\" at 48000 Hz: dynamic filter: loop 0"), "{message}");
    let message = refusal("path = [", "exciter = { low_hz = 900, high_hz = 25000 }\npath = [");
    assert!(message.contains("object \"bar\" at 48000 Hz: dynamic filter: "), "{message}");
    let message = refusal("delay_s = 0.004", "delay_s = 0.5");
    assert!(message.contains("object \"bar\" at 48000 Hz: dynamic filter: "), "{message}");
    // A table without pads is checked, too, and a higher rate allows more.
    let table = KIT[..KIT.find("[[striker]]").unwrap()].replace("frequency_hz = 500", "frequency_hz = 30000");
    let folder = folder(&table);
    assert_eq!(malleus(folder.path(), "kit check kit.toml").status.code(), Some(1));
    let at_96 = malleus(folder.path(), "kit check kit.toml --rate 96000");
    assert_eq!(at_96.status.code(), Some(0), "{}", String::from_utf8_lossy(&at_96.stderr));
}
