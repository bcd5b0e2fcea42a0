//! Strikes whose force stands in the events, and recordings of many strikes that are played anew.

use std::path::Path;

use crate::folder::{Folder, samples};

/// Plays `law.csv` and `own.csv` on a kit. Returns the largest sample of the first, and the largest
/// difference of both.
fn law_and_own(folder: &Folder, kit: &str, option: &str) -> (i32, i32) {
    let [law, own] = ["law", "own"].map(|name| {
        let words = format!("play --kit {kit} --strikes {name}.csv -o {name}.wav --tail 0.3{option}");
        let output = folder.malleus(&words);
        assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
        samples(&folder.path(&format!("{name}.wav")))
    });
    let largest = law.iter().map(|x| x.abs()).max().unwrap();
    (largest, law.iter().zip(&own).map(|(a, b)| (a - b).abs()).max().unwrap())
}

#[test]
fn a_strike_with_its_laws_own_force_sounds_as_the_law() {
    let folder = Folder::new();
    // At velocity 1 the striker's law gives its peak force and contact time themselves.
    folder.write("law.csv", b"time_s,pad,velocity\n0.01001,bar,1\n0.2,bar,1\n");
    folder.write(
        "own.csv",
        b"time_s,pad,velocity,peak_force,contact_time_s\n0.01001,bar,0.3,1,0.0005\n0.2,bar,1,,0.0005\n",
    );
    // The instrument computes the force of a law in 32 bits: -80 dB. The reference's is exact.
    for (option, share) in [("", 10_000), (" --reference", 200_000)] {
        let (largest, worst) = law_and_own(&folder, "kit.toml", option);
        assert!(largest > 1 << 18 && worst < largest / share + 2, "{option}: {worst} of {largest}");
    }
}

/// A bar with gains at three positions, and two strikers, of which the second rings.
const TWO_STRIKERS: &str = r#"
format = 1
name = "two"
[[object]]
name = "bar"
acceleration = 0.001
modes = [
    { frequency_hz = 440.0, decay_per_s = 12.0, gain_sine = [20.0, -10.0, 5.0], gain_cosine = [3.0, 4.0, 0.0] },
    { frequency_hz = 1870.0, decay_per_s = 30.0, gain_sine = [5.0, 25.0, -15.0] },
]
[[striker]]
name = "soft"
peak_force = 1.0
contact_time_s = 0.0016
[[striker]]
name = "hard"
peak_force = 1.0
contact_time_s = 0.0005
modes = [{ frequency_hz = 3200.0, decay_per_s = 50.0, gain_sine = 12.0 }]
[[pad]]
name = "bar"
object = "bar"
strikers = ["soft", "hard"]
striker_weight = 0.7
level_db = 24.0
"#;

#[test]
fn own_forces_at_positions_and_with_strikers_sound_as_their_laws() {
    let folder = Folder::new();
    folder.write("two.toml", TWO_STRIKERS.as_bytes());
    let strikes = "0.01,bar,1,0.2,soft,{}\n0.3,bar,1,0.75,hard,{}\n0.6,bar,1,1,hard,{}\n";
    let events = |own: &str| format!("time_s,pad,velocity,position,striker,peak_force\n{}", strikes.replace("{}", own));
    folder.write("law.csv", events("").as_bytes());
    folder.write("own.csv", events("1").as_bytes());
    // The instrument ends modes at -110 dBFS, which are 27 steps of 24 bits.
    for (option, share) in [("", 10_000), (" --reference", 200_000)] {
        let (largest, worst) = law_and_own(&folder, "two.toml", option);
        assert!(largest > 1 << 18, "{option}: {largest}");
        assert!(worst < largest / share + 4, "{option}: {worst} of {largest}");
    }
    folder.refuses("play --kit two.toml --strikes own.csv -o own.wav --limit -3", &["own.csv", "parts", "--limit"]);
}

#[test]
fn forces_that_cannot_be_played_are_refused_with_line_and_field() {
    let folder = Folder::new();
    let header = "sample,pad,velocity,position,action,peak_force,contact_time_s\n";
    folder.refuses_strikes(&format!("{header}0,bar,1,,,-1,\n"), &["line 2", "peak_force", "-1"]);
    folder.refuses_strikes(&format!("{header}0,bar,1,,,,9\n"), &["line 2", "contact_time_s", "9"]);
    folder.refuses_strikes(&format!("{header}0,bar,,,choke,1,\n"), &["line 2", "only a strike"]);
    folder.refuses_strikes(&format!("{header}9,bar,1,,,1,\n5,bar,1,,,,\n"), &["line 3", "earlier"]);
}

/// Writes a recording of 24 bits.
fn write_recording(path: &Path, sound: &[f64]) {
    let spec = hound::WavSpec {
        channels: 1,
        sample_rate: 44_100,
        bits_per_sample: 24,
        sample_format: hound::SampleFormat::Int,
    };
    let mut writer = hound::WavWriter::create(path, spec).unwrap();
    sound.iter().for_each(|x| writer.write_sample((x * 8_388_608.0).round() as i32).unwrap());
    writer.finalize().unwrap();
}

#[test]
fn fitted_strikes_replay_their_recording_down_to_its_noise() {
    let folder = Folder::new();
    let sound = fit::multi_strike::synthetic::plain(8, 6.0, 10, -60.0);
    write_recording(&folder.path("taps.wav"), &sound.samples);
    let output = folder.malleus("fit taps.wav -o taps.toml --events taps.csv --json");
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    let report: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    let strikes = report[0]["report"]["strikes"].as_array().unwrap();
    assert_eq!((report[0]["outcome"].as_str(), strikes.len()), (Some("together"), 10));
    assert!(strikes[3]["contact_time_s_sd"].as_f64().unwrap() > 0.0);
    let output = folder.malleus("play --kit taps.toml --strikes taps.csv -o again.wav --rate 44100 --tail 2");
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    let again = samples(&folder.path("again.wav"));
    let left = sound.samples.iter().enumerate().map(|(n, x)| {
        let played = again.get(2 * n).map_or(0.0, |y| f64::from(*y) / 8_388_608.0);
        (x - played).powi(2)
    });
    let left_db = 10.0 * (left.sum::<f64>() / sound.samples.len() as f64).log10();
    assert!(left_db < -59.0, "{left_db} dBFS are left");
}

#[test]
fn strikes_at_positions_with_two_strikers_replay_their_recording() {
    let folder = Folder::new();
    let sound = fit::multi_strike::synthetic::at_places(1, 15.0, 25);
    write_recording(&folder.path("places.wav"), &sound.samples);
    let output = folder.malleus("fit places.wav -o p.toml --events p.csv --positions 8 --strikers 2 --json");
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    let report: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    let strikes = report[0]["report"]["strikes"].as_array().unwrap();
    let is_soft = |strike: &&serde_json::Value| strike["striker"] == 1 && strike["position_sd"].is_number();
    assert!(strikes.len() >= 24 && strikes.iter().filter(is_soft).count() > 5, "{strikes:?}");
    let output = folder.malleus("play --kit p.toml --strikes p.csv -o again.wav --rate 44100 --tail 2");
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    let again = samples(&folder.path("again.wav"));
    let played = |n: usize| again.get(2 * n).map_or(0.0, |y| f64::from(*y) / 8_388_608.0);
    let left: f64 = sound.samples.iter().enumerate().map(|(n, x)| (x - played(n)).powi(2)).sum();
    let left_db = 10.0 * (left / sound.samples.iter().map(|x| x * x).sum::<f64>()).log10();
    assert!(left_db < -25.0, "{left_db} dB of the recording are left");
}

#[test]
fn events_of_a_single_strike_are_refused_by_name() {
    let folder = Folder::new();
    let sound = fit::multi_strike::synthetic::plain(8, 1.5, 1, -60.0);
    write_recording(&folder.path("once.wav"), &sound.samples);
    folder.refuses("fit once.wav -o once.toml --events once.csv", &["once.wav: 1 strike heard", "--events"]);
}
