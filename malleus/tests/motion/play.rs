//! `malleus play --motion` as its user calls it: the files that it writes, and its refusals.

use std::fs;
use std::path::Path;
use std::process::{Command, Output};

const G: f64 = 9.80665;

fn malleus(folder: &Path, words: &str) -> Output {
    let program = Command::new(env!("CARGO_BIN_EXE_malleus")).current_dir(folder).args(words.split(' ')).output();
    program.expect("the program runs")
}

pub(crate) fn runs(folder: &Path, words: &str) {
    let done = malleus(folder, words);
    assert!(done.status.success(), "{words}: {}", String::from_utf8_lossy(&done.stderr));
}

/// Channels of a WAV file of 32-bit floats.
pub(crate) fn floats(path: &Path) -> [Vec<f64>; 4] {
    let mut wav = hound::WavReader::open(path).unwrap();
    assert_eq!((wav.spec().channels, wav.spec().sample_format), (4, hound::SampleFormat::Float));
    let samples: Vec<f32> = wav.samples().map(Result::unwrap).collect();
    [0, 1, 2, 3].map(|channel| samples.iter().skip(channel).step_by(4).copied().map(f64::from).collect())
}

/// Samples of the sound, both channels.
fn sound(path: &Path) -> Vec<i32> {
    hound::WavReader::open(path).unwrap().samples().map(Result::unwrap).collect()
}

/// A kit of one pad, whose stick has the mass, tilt and friction of these tests.
fn write_kit(folder: &Path, surface: &str, striker: &str) {
    let heights: Vec<String> = (0..512u32)
        .map(|n| {
            let wave = |k: u32| (std::f64::consts::TAU * f64::from(k * n % 512) / 512.0 + f64::from(k * k)).sin();
            ((1..100).map(wave).sum::<f64>() * 400.0).round().to_string()
        })
        .collect();
    let text = format!(
        "format = 1\nname = \"test\"\n[[surface]]\nname = \"tile\"\nstep_m = 5e-6\nunit_m = 1e-9\nshortest_m = 2.5e-5\n\
         heights = [{}]\n[[object]]\nname = \"bar\"\n{surface}\nmodes = [{{ frequency_hz = 440.0, decay_per_s = 30.0, \
         gain_sine = 300.0 }}]\n[[striker]]\nname = \"stick\"\npeak_force = 1.0\ncontact_time_s = 0.0005\n{striker}\n\
         [[pad]]\nname = \"bar\"\nobject = \"bar\"\nstrikers = [\"stick\"]\nlevel_db = -30\n",
        heights.join(", ")
    );
    fs::write(folder.join("kit.toml"), text).unwrap();
}

const SURFACE: &str = "surface = \"tile\"";
const SCRAPE: &str = "[striker.scrape]\nmass_kg = 0.01\ntilt_rad = 0.5\nfriction = 0.4";
const ROLL: &str = "[striker.scrape]\nmass_kg = 0.01\n[striker.roll]\nradius_m = 0.01";

#[test]
fn normal_force_at_both_ends_of_a_back_and_forth_is_that_of_equations_8_and_9() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    write_kit(folder, SURFACE, SCRAPE);
    let (tilt, friction) = (0.5f64.tan(), 0.4);
    for (length_m, period_s) in [(0.2f64, 1.0f64), (0.05, 0.37), (0.3, 1.618)] {
        runs(folder, &format!("motion back-and-forth --length {length_m} --period {period_s} --pad bar -o m.csv"));
        runs(folder, "play --kit kit.toml --motion m.csv --force f.wav -o out.wav");
        let [_, normal_n, speed, distance] = floats(&folder.join("f.wav"));
        let acceleration = 0.5 * length_m * (std::f64::consts::TAU / period_s).powi(2);
        for (end, sign) in [(1, -1.0), (2, 1.0), (3, -1.0)] {
            let frame = (0.5 * period_s * f64::from(end) * 48_000.0).round() as usize;
            let expected = 0.01 * (G + sign * acceleration * tilt).max(0.0) / (1.0 - friction * tilt);
            let error = normal_n[frame] / expected - 1.0;
            println!("{length_m} m in {period_s} s, end {end}: {:.6} N, {:+.4} %", normal_n[frame], 100.0 * error);
            if expected == 0.0 {
                assert_eq!(normal_n[frame], 0.0);
            } else {
                assert!(error.abs() < 1e-3, "{} against {expected}", normal_n[frame]);
            }
            assert!(speed[frame] < 0.02 * speed.iter().fold(0.0, |most, &speed| speed.max(most)));
        }
        let way = distance.last().unwrap();
        assert!((way / (4.0 * length_m) - 1.0).abs() < 1e-3, "{way} m in four strokes of {length_m} m");
    }
}

#[test]
fn lifted_stick_is_silent_and_without_normal_force() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    write_kit(folder, SURFACE, SCRAPE);
    let lines = "0,bar,scrape,stick,0,0,\n0.3,bar,lift,,0.1,0,\n\
                 1.0,bar,scrape,stick,0,0,\n1.2,bar,lift,,0.1,0,\n";
    fs::write(folder.join("m.csv"), format!("time_s,pad,action,striker,x_m,y_m,normal_n\n{lines}")).unwrap();
    runs(folder, "play --kit kit.toml --motion m.csv --force f.wav -o out.wav");
    let [force, normal_n, speed, _] = floats(&folder.join("f.wav"));
    for quiet in [14_400 + 96..48_000 - 64, 57_600 + 96..force.len()] {
        assert!(force[quiet.clone()].iter().all(|&force| force == 0.0));
        assert!(normal_n[quiet.clone()].iter().chain(&speed[quiet]).all(|&number| number == 0.0));
    }
    assert!([4_800, 52_800].iter().all(|&frame| normal_n[frame] > 0.0 && speed[frame] > 0.0));
    assert!(force[..14_400].iter().chain(&force[48_000..57_600]).any(|force| force.abs() > 1e-4));
}

#[test]
fn instrument_and_reference_play_the_same_motion_and_each_ablation_sounds_different() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    for striker in [SCRAPE, ROLL] {
        let striker = format!("modes = [{{ frequency_hz = 900.0, decay_per_s = 80.0, gain_sine = 60.0 }}]\n{striker}");
        // A ball's force is small: most of the distance is what the bank of modes rounds.
        let (motion, level_db, least_db) =
            if striker.contains("roll") { ("roll --incline 3", 32, 80.0) } else { ("back-and-forth", 0, 90.0) };
        write_kit(folder, &format!("{SURFACE}\nsurface_level_db = {level_db}"), &striker);
        runs(folder, &format!("motion {motion} --pad bar -o m.csv"));
        let play = |more: &str| {
            runs(folder, &format!("play --kit kit.toml --motion m.csv --tail 0.1 -o out.wav{more}"));
            sound(&folder.join("out.wav"))
        };
        let full = play("");
        let reference = snr_db(&full, &play(" --reference"));
        println!("{motion}: {reference:.1} dB from the reference");
        assert!(reference > least_db, "{motion}: {reference:.1} dB from the reference");
        assert_eq!(full, play(" --block 7"), "any block gives the same sound");
        for part in ["nonlinearity", "normal-force", "scraper"] {
            let distance = snr_db(&full, &play(&format!(" --without {part}")));
            println!("{motion} without {part}: {distance:.1} dB from the whole");
            assert!((-20.0..40.0).contains(&distance), "{motion} without {part}: {distance:.1} dB");
        }
    }
}

#[test]
fn pad_whose_scrapes_come_to_its_end_is_told_before_its_level_reaches_full_scale() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    runs(folder, "motion line --speed 8 --length 2 --pad bar -o m.csv");
    let of_level = |level_db: i32| {
        write_kit(folder, &format!("{SURFACE}\nsurface_level_db = {level_db}"), SCRAPE);
        let done = malleus(folder, "play --kit kit.toml --motion m.csv --tail 0.1 --json -o out.wav");
        let report: serde_json::Value = serde_json::from_slice(&done.stdout).unwrap();
        let told = String::from_utf8_lossy(&done.stderr).contains("surface_level_db");
        (report["held_frames"].as_u64().unwrap(), report["peak_dbfs"].as_f64().unwrap(), told)
    };
    let (held, peak_dbfs, told) = of_level(40);
    assert!(held > 10 && told && peak_dbfs < -3.0, "{held} frames, {peak_dbfs} dBFS");
    let (held, _, told) = of_level(-40);
    assert!(held == 0 && !told, "{held} frames");
}

/// Distance of a sound from another in dB of the first.
fn snr_db(whole: &[i32], other: &[i32]) -> f64 {
    let [signal, noise] = whole.iter().zip(other).fold([0.0, 0.0], |[signal, noise], (&a, &b)| {
        [signal + f64::from(a).powi(2), noise + f64::from(a - b).powi(2)]
    });
    10.0 * (signal / noise).log10()
}

#[test]
fn contact_that_moves_along_an_object_comes_near_to_the_reference() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    for (path, least_db) in [("scribble --pad marimba --striker pen", 62.0), ("circle --pad drum", 62.0)] {
        runs(folder, &format!("motion {path} -o m.csv"));
        let play = |more: &str| {
            runs(folder, &format!("play --kit scrapes --motion m.csv --tail 0.1 -o out.wav{more}"));
            sound(&folder.join("out.wav"))
        };
        let distance = snr_db(&play(" --reference"), &play(""));
        println!("{path}: {distance:.1} dB from the reference");
        assert!((least_db..100.0).contains(&distance), "{path}: {distance:.1} dB");
    }
}

#[test]
fn log_of_a_motion_under_a_budget_plays_to_the_same_bits_with_the_motion() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    fs::write(
        folder.join("s.csv"),
        "time_s,pad,velocity\n0.1,glass,0.9\n0.15,drum,0.9\n0.3,drum,0.5\n0.31,bowl,1\n0.8,drum,0.7\n",
    )
    .unwrap();
    runs(folder, "motion circle --pad drum -o m.csv");
    let play = |words: &str| {
        runs(folder, &format!("play --kit scrapes --motion m.csv --tail 0.3 -o out.wav {words}"));
        sound(&folder.join("out.wav"))
    };
    let whole = play("--strikes s.csv");
    let shed = play("--strikes s.csv --budget-mhz 60 --log l.csv");
    let log = fs::read_to_string(folder.join("l.csv")).unwrap();
    assert!(log.contains("shed") && shed != whole, "{log}");
    assert!(play("--strikes l.csv --block 77") == shed, "the log plays otherwise");
}

#[test]
fn fifty_modes_and_twenty_of_the_scraper_take_with_the_scraping_half_of_168_mhz() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let modes = |count: u32, hz: f64, ratio: f64| -> String {
        let mode = |k: u32| {
            let hz = hz * ratio.powi(k as i32);
            format!("{{ frequency_hz = {hz:.1}, decay_per_s = {}, gain_sine = 20.0 }}", 10 + 3 * k)
        };
        format!("modes = [{}]", (0..count).map(mode).collect::<Vec<_>>().join(", "))
    };
    write_kit(folder, SURFACE, &format!("{}\n{SCRAPE}", modes(20, 900.0, 1.12)));
    let kit = fs::read_to_string(folder.join("kit.toml")).unwrap();
    let one = kit.split("modes = [").nth(1).unwrap().split_once(']').unwrap().0.to_owned();
    let kit = kit.replacen(&format!("modes = [{one}]"), &modes(50, 300.0, 1.07), 1);
    fs::write(folder.join("kit.toml"), kit).unwrap();
    runs(folder, "motion back-and-forth --pad bar -o m.csv");
    let words = "play --kit kit.toml --motion m.csv --budget-mhz 168 --tail 0 -o out.wav --json";
    let done = malleus(folder, words);
    assert!(done.status.success(), "{}", String::from_utf8_lossy(&done.stderr));
    let report: serde_json::Value = serde_json::from_slice(&done.stdout).unwrap();
    let share = |cycles: &str| {
        let frame = report["work"][cycles].as_f64().unwrap() / 32.0;
        (frame, frame * report["rate_hz"].as_f64().unwrap() / 168e6)
    };
    let ((frame, mean), (_, dearest)) = (share("mean_predicted_cycles"), share("largest_predicted_cycles"));
    println!(
        "{frame:.0} cycles a frame: {:.1} % of 168 MHz, {:.1} % in the dearest tick",
        100.0 * mean,
        100.0 * dearest
    );
    assert!(report["work"]["scrape_frames"].as_u64().unwrap() > 90_000 && report["work"]["shed_modes"] == 0);
    assert!(frame > 1_000.0 && mean < 0.45 && dearest < 0.53);
}

#[test]
fn motions_that_a_kit_cannot_play_are_refused_by_name_without_a_file() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    fs::write(
        folder.join("s.csv"),
        "time_s,pad,action,striker,x_m,y_m,normal_n\n0,bar,scrape,stick,0,0,\n1,bar,lift,,0.1,0,\n",
    )
    .unwrap();
    fs::write(
        folder.join("r.csv"),
        "time_s,pad,action,striker,x_m,y_m,normal_n\n0,bar,roll,stick,0,0,\n1,bar,lift,,0.1,0,\n",
    )
    .unwrap();
    write_kit(folder, SURFACE, SCRAPE);
    let done = malleus(folder, "play --kit kit.toml --motion s.csv --force out.wav -o out.wav");
    assert!(!done.status.success() && String::from_utf8_lossy(&done.stderr).contains("two outputs"));
    for (surface, striker, motion, reasons) in [
        ("", SCRAPE, "s.csv", ["pad bar", "object bar has no surface"]),
        (SURFACE, "", "s.csv", ["pad bar", "striker stick does not scrape"]),
        (SURFACE, SCRAPE, "r.csv", ["pad bar", "striker stick does not roll"]),
        ("surface = \"til\"", SCRAPE, "s.csv", ["til", "tile"]),
        (SURFACE, "[striker.scrape]\nmass_kg = 0.01\ntilt_rad = 1.4\nfriction = 0.4", "s.csv", ["stick", "friction"]),
        (
            SURFACE,
            "[striker.scrape]\nmass_kg = 0.01\nalpha_min_m = 2e-5\nalpha_max_m = 1e-5",
            "s.csv",
            ["alpha_min_m", "alpha_max_m"],
        ),
        (SURFACE, "[striker.roll]\nradius_m = 0.01", "r.csv", ["roll", "scrape"]),
    ] {
        write_kit(folder, surface, striker);
        let done = malleus(folder, &format!("play --kit kit.toml --motion {motion} --force f.wav -o out.wav"));
        let error = String::from_utf8_lossy(&done.stderr);
        assert!(!done.status.success(), "{striker} {motion} is played");
        assert!(reasons.iter().all(|reason| error.contains(reason)) && !error.contains("panicked"), "{error}");
        assert!(!folder.join("f.wav").exists() && !folder.join("out.wav").exists());
    }
}

#[test]
fn motion_that_leaves_the_object_is_told_with_its_time_and_place() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    write_kit(folder, "surface = \"tile\"\nsize_m = [0.2, 0.1]", SCRAPE);
    let told = |length_m: f64, more: &str| {
        runs(folder, &format!("motion back-and-forth --length {length_m} --period 1 --pad bar -o m.csv{more}"));
        let done = malleus(folder, "play --kit kit.toml --motion m.csv -o out.wav");
        assert!(done.status.success());
        String::from_utf8_lossy(&done.stderr).into_owned()
    };
    assert!(!told(0.2, " --at -0.1,0").contains("leaves"), "{}", told(0.2, " --at -0.1,0"));
    // Both strokes there end 0.2 m from the middle: 0.1 m is reached at the angle acos(-1/3).
    let said = told(0.3, " --at -0.1,0");
    assert!(
        said.contains("m.csv: pad bar: the motion leaves the object 2 times, first at 0.305 s at 0.1005,0.0000 m"),
        "{said}"
    );
    assert!(said.contains("size_m = [0.2, 0.1]"), "{said}");
}

#[test]
fn play_that_fails_leaves_neither_force_nor_log_behind() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    write_kit(folder, SURFACE, SCRAPE);
    runs(folder, "motion back-and-forth --strokes 1 --pad bar -o m.csv");
    fs::write(folder.join("old.csv"), "old").unwrap();
    for files in ["--force f.wav --log old.csv -o missing/out.wav", "--force missing/f.wav --log old.csv -o out.wav"] {
        let done = malleus(folder, &format!("play --kit kit.toml --motion m.csv {files}"));
        let error = String::from_utf8_lossy(&done.stderr);
        assert!(!done.status.success() && error.contains("missing") && error.contains("make its folder"), "{error}");
        let names: Vec<_> = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().file_name()).collect();
        assert_eq!(
            (names.len(), fs::read_to_string(folder.join("old.csv")).unwrap()),
            (3, "old".to_owned()),
            "{names:?}"
        );
    }
    let done = malleus(folder, "play --kit kit.toml --motion m.csv --force f.wav --log f.wav -o out.wav");
    assert!(!done.status.success() && !folder.join("f.wav").exists());
}
