//! Levels of a kit, as its user meets them: `kit check` names strikes that clip with the numbers
//! that fit, and new kits do not clip.

use std::fs;
use std::path::Path;
use std::process::{Command, Output};

use dsp_core::SampleRate;
use dsp_core::engine::Setup;
use dsp_core::event::{Action, Event, Time};
use dsp_core::fixed::ONE_Q27;
use dsp_core::table::Kit;
use malleus::render::instrument::{self, Output as Samples, Settings};
use malleus::render::level::Level;
use malleus::render::{Performance, reference};
use tempfile::TempDir;

/// Kit with a force beyond the force bus, 20 N where the bus ends at 16, and a sound beyond full
/// scale, +17.7 dBFS.
const LOUD: &str = r#"format = 1
name = "loud"

[[object]]
name = "bar"
modes = [
    { frequency_hz = 220.0, decay_per_s = 3.2, gain_sine = [512.0, 300.0] },
    { frequency_hz = 880.0, decay_per_s = 9.5, gain_sine = [180.0, -500.0] },
]

[[striker]]
name = "yarn mallet"
peak_force = 20.0
contact_time_s = 0.002

[[striker]]
name = "feather"
peak_force = 0.1
contact_time_s = 0.004

[[pad]]
name = "bar"
object = "bar"
strikers = ["feather", "yarn mallet"]
"#;

fn malleus(folder: &Path, words: &str) -> Output {
    Command::new(env!("CARGO_BIN_EXE_malleus")).args(words.split(' ')).current_dir(folder).output().unwrap()
}

fn stdout(folder: &Path, words: &str) -> String {
    let output = malleus(folder, words);
    assert!(output.status.success(), "{words}: {}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).unwrap()
}

fn json(folder: &Path, words: &str) -> serde_json::Value {
    serde_json::from_str(&stdout(folder, words)).unwrap()
}

fn folder(kit: &str) -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("kit.toml"), kit).unwrap();
    folder
}

fn strike(pad: u8, position: f32, striker: u8) -> Event {
    Event { time: Time::at_frame(0), pad, velocity: 1.0, position, striker, action: Action::Strike }
}

/// Sounds of a kit by the instrument and by the reference, 1.0 = full scale, half a second at 48
/// kHz.
fn both(kit: &kit::Kit, events: &[Event]) -> [Vec<[f64; 2]>; 2] {
    let (rate, frames) = (SampleRate::HZ_48000, 24_000);
    let performance = Performance { events: events.to_vec(), direct: None, frames };
    let settings = Settings { setup: Setup::new(rate), block: 128, budget_cycles: None };
    let binary = kit::binary::build(kit).unwrap();
    let table = Kit::parse(&binary).unwrap();
    let bus = instrument::render(&table, &performance, settings, Samples::Bus, |_| {}).unwrap();
    let bus = bus.iter().map(|frame| frame.map(|x| f64::from(x) / f64::from(ONE_Q27))).collect();
    [bus, reference::render(kit, &performance, rate, |_| {}).unwrap()]
}

fn snr_db([bus, reference]: &[Vec<[f64; 2]>; 2]) -> f64 {
    let power = |x: f64| x * x;
    let signal: f64 = reference.iter().flatten().copied().map(power).sum();
    let error: f64 = bus.iter().flatten().zip(reference.iter().flatten()).map(|(a, b)| power(a - b)).sum();
    10.0 * (signal / error).log10()
}

fn peak_dbfs(sound: &[[f64; 2]]) -> f64 {
    Level::of_reference(sound).peak_dbfs().unwrap()
}

#[test]
fn kit_check_names_what_clips_at_velocity_1_and_its_numbers_fit() {
    let folder = folder(LOUD);
    let report = json(folder.path(), "kit check kit.toml --json");
    let [feather, mallet] = [0, 1].map(|index| report["strikes"][index].clone());
    assert_eq!((feather["striker"].as_str(), mallet["striker"].as_str()), (Some("feather"), Some("yarn mallet")));
    assert!(feather["fitting_reference_force"].is_null() && feather["fitting_level_db"].is_null(), "{feather}");
    assert_eq!(mallet["fitting_reference_force"], 20.0, "{mallet}");
    // The reference clips nowhere, and so gives the peak that the check must find. The other end of
    // the bar is softer.
    let loud = kit::load(&folder.path().join("kit.toml")).unwrap().kit;
    let [_, reference] = both(&loud, &[strike(0, 0.0, 1)]);
    let [_, far] = both(&loud, &[strike(0, 1.0, 1)]);
    let peak = mallet["peak_dbfs"].as_f64().unwrap();
    println!("{} and {} dBFS, the check says {peak}", peak_dbfs(&reference), peak_dbfs(&far));
    assert!((peak - peak_dbfs(&reference).max(peak_dbfs(&far))).abs() < 0.1 && peak > 12.0);

    let text = stdout(folder.path(), "kit check kit.toml");
    let level_db = mallet["fitting_level_db"].as_f64().unwrap();
    assert!(text.contains("\"yarn mallet\"") && text.contains("reference_force = 20 fits"), "{text}");
    assert!(text.contains(&format!("level_db = {level_db:.1} fits")), "{text}");
    assert!(text.contains("all pads at once"), "{text}");

    let fitting = LOUD.replace("name = \"bar\"\nmodes", "name = \"bar\"\nreference_force = 20\nmodes")
        + &format!("level_db = {level_db}\n");
    fs::write(folder.path().join("fitting.toml"), fitting).unwrap();
    let text = stdout(folder.path(), "kit check fitting.toml");
    assert!(!text.contains("clip") && !text.contains("fits"), "{text}");
    let fitting = kit::load(&folder.path().join("fitting.toml")).unwrap().kit;
    let sounds = both(&fitting, &[strike(0, mallet["position"].as_f64().unwrap() as f32, 1)]);
    let peak = peak_dbfs(&sounds[0]);
    assert!((-6.2..=-5.9).contains(&peak), "{peak} dBFS");
    assert!(snr_db(&sounds) > 100.0, "{}", snr_db(&sounds));
}

#[test]
fn kit_check_hears_peaks_behind_a_quiet_level_and_clipping_chords() {
    // Each of the two pads peaks at -2 dBFS. Their own buses stand at +28 dBFS, where they would
    // clip.
    let quiet = LOUD.replace("[512.0, 300.0]", "[1656.0, 970.0]").replace("[180.0, -500.0]", "[582.0, -1617.0]");
    let quiet = quiet.replace("modes = [", "reference_force = 20\nmodes = [").replace(
        "strikers = [\"feather\", \"yarn mallet\"]",
        "strikers = [\"yarn mallet\"]\nlevel_db = -30\n[[pad]]\nname = \"bar 2\"\nobject = \"bar\"\nstrikers = [\"yarn mallet\"]\nlevel_db = -30",
    );
    let folder = folder(&quiet);
    let report = json(folder.path(), "kit check kit.toml --json");
    let kit = kit::load(&folder.path().join("kit.toml")).unwrap().kit;
    let [_, one] = both(&kit, &[strike(0, 0.0, 0)]);
    let [_, chord] = both(&kit, &[strike(0, 0.0, 0), strike(1, 0.0, 0)]);
    let [one, chord] = [peak_dbfs(&one), peak_dbfs(&chord)];
    println!("one {one}, chord {chord}; {report}");
    assert!((report["chord_peak_dbfs"].as_f64().unwrap() - chord).abs() < 0.1 && chord > 0.0);
    let text = stdout(folder.path(), "kit check kit.toml");
    assert!(text.contains("all pads at once at velocity 1 peak at +"), "{text}");
    // Their own sounds clip, which no level mends: lower gains do, with a higher level.
    let own = report["strikes"][0]["own_peak_dbfs"].as_f64().unwrap();
    let gain_db = report["strikes"][0]["fitting_gain_db"].as_f64().unwrap();
    let level_db = report["strikes"][0]["fitting_level_db"].as_f64().unwrap();
    assert!((own - one - 30.0 - 3.01).abs() < 0.1 && (own + gain_db - 12.0).abs() < 0.11, "{report}");
    assert!((level_db - (-30.0 - 6.0 - one - gain_db)).abs() < 0.2, "{level_db} dB with {gain_db} dB");
    assert!(text.contains("before level_db and clips at +24 dBFS; gains of object \"bar\""), "{text}");
}

#[test]
fn new_kit_of_an_object_that_is_far_too_loud_does_not_clip_before_its_level() {
    // The own sound stands at +50 dBFS.
    let loud = LOUD.replace("[512.0, 300.0]", "[20480.0, 12000.0]").replace("[180.0, -500.0]", "[7200.0, -20000.0]");
    let folder = folder(&loud);
    fs::write(folder.path().join("bar.toml"), loud.split("[[pad]]").next().unwrap()).unwrap();
    let done = malleus(folder.path(), "kit new bar.toml -o new.toml");
    let told = String::from_utf8_lossy(&done.stderr);
    assert!(done.status.success() && told.contains("gains of \"bar\" are") && told.contains("dB lower"), "{told}");
    let report = json(folder.path(), "kit check new.toml --json");
    for strike in report["strikes"].as_array().unwrap() {
        assert!(strike["fitting_gain_db"].is_null() && strike["own_peak_dbfs"].as_f64().unwrap() < 12.1, "{strike}");
    }
    let kit = kit::load(&folder.path().join("new.toml")).unwrap().kit;
    let peaks = [0.0, 1.0].map(|position| {
        let sounds = both(&kit, &[strike(0, position, 0)]);
        assert!(snr_db(&sounds) > 90.0, "{}", snr_db(&sounds));
        peak_dbfs(&sounds[0])
    });
    assert!((peaks[0].max(peaks[1]) + 6.0).abs() < 0.5, "{peaks:?} dBFS");
}

#[test]
fn new_kit_peaks_at_minus_6_dbfs_at_velocity_1_in_both_renderers() {
    let table = LOUD.split("[[pad]]").next().unwrap();
    let soft = table.replace("\"bar\"", "\"soft\"").replace("[512.0, 300.0]", "[2.3, 0.4]");
    let soft = soft.replace("[180.0, -500.0]", "[0.8, 0.2]").replace("feather", "soft feather");
    let folder = folder(LOUD);
    fs::write(folder.path().join("bar.toml"), table).unwrap();
    fs::write(folder.path().join("soft.toml"), soft.replace("yarn mallet", "soft mallet")).unwrap();
    // The new kit is the first path, or that of the option -o.
    stdout(folder.path(), "kit new new.toml bar.toml soft.toml");
    let first = fs::read(folder.path().join("new.toml")).unwrap();
    fs::remove_file(folder.path().join("new.toml")).unwrap();
    stdout(folder.path(), "kit new bar.toml soft.toml -o new.toml");
    assert_eq!(first, fs::read(folder.path().join("new.toml")).unwrap());
    let kit = kit::load(&folder.path().join("new.toml")).unwrap().kit;
    assert_eq!((kit.objects[0].reference_force, kit.pads.len()), (20.0, 2));
    for pad in 0..2 {
        let loudest = [0.0, 1.0].map(|position| {
            let sounds = both(&kit, &[strike(pad, position, 0)]);
            assert!(snr_db(&sounds) > 90.0, "{}", snr_db(&sounds));
            [peak_dbfs(&sounds[0]), peak_dbfs(&sounds[1])]
        });
        for renderer in 0..2 {
            let peak = loudest[0][renderer].max(loudest[1][renderer]);
            assert!((peak + 6.0).abs() <= 0.5, "pad {pad}: {loudest:?}");
        }
    }
    assert_eq!(malleus(folder.path(), "kit new only.toml").status.code(), Some(2));
}

#[test]
fn new_kit_strikes_objects_without_strikers_by_those_of_other_tables() {
    let (object, striker) = LOUD.split("[[pad]]").next().unwrap().split_once("[[striker]]").unwrap();
    let folder = folder(LOUD);
    fs::write(folder.path().join("bar.toml"), object).unwrap();
    let head = object.split("[[object]]").next().unwrap();
    fs::write(folder.path().join("strikers.toml"), format!("{head}[[striker]]{striker}")).unwrap();
    let told = stdout(folder.path(), "kit new bar.toml strikers.toml -o new.toml");
    assert!(told.contains(": 1 pad, "), "{told}");
    let kit = kit::load(&folder.path().join("new.toml")).unwrap().kit;
    assert!(kit.pads.len() == 1 && kit.pads[0].strikers.len() == kit.strikers.len(), "{:?}", kit.pads[0]);

    let refused = malleus(folder.path(), "kit new bar.toml -o none.toml");
    let told = String::from_utf8(refused.stderr).unwrap();
    assert!(told.contains("no table has a striker") && !folder.path().join("none.toml").exists(), "{told}");
}

/// Kit of an object with all stages, whose modes go through its dynamic filter.
fn filtered() -> kit::Kit {
    let filtered = LOUD.replace(
        "\n[[striker]]\nname = \"yarn",
        r#"
[object.residual]
edges_hz = [200, 2000, 8000]
weight = [0.02, 0.01]
decay_db_per_s = [80, 120]

[object.dynamic_filter]
modes = "through"
exciter = { low_hz = 300, high_hz = 4000, exponent = 0.4 }
path = [ { time_s = 0, a1 = -0.5, b0 = 0.002 }, { time_s = 0.25, a1 = -0.9, b0 = 0.0005 } ]
loops = [ { frequency_hz = 500, bandwidth_hz = 5, gain = 20, delay_s = 0.004 } ]

[object.biquads]
chains = [ [ { pole = [0.99, 0.05], zero = [1, 0], gain = 0.0001 } ] ]

[[striker]]
name = "yarn"#,
    );
    let filtered = filtered.replace("modes = [", "acceleration = 0.0001\nreference_force = 5\nmodes = [");
    let filtered = filtered.replace("[512.0, 300.0]", "[4.0, 4.0]").replace("[180.0, -500.0]", "[2.0, -2.0]");
    let folder = folder(&filtered);
    kit::load(&folder.path().join("kit.toml")).unwrap().kit
}

#[test]
fn object_with_another_reference_force_sounds_as_before() {
    let before = filtered();
    let mut after = before.clone();
    after.objects[0] = after.objects[0].with_reference_force(20.0);
    let [before, after] = [before, after].map(|kit| both(&kit, &[strike(0, 0.0, 1)]));
    for renderer in 0..2 {
        let snr = snr_db(&[after[renderer].clone(), before[renderer].clone()]);
        println!("{snr:.1} dB, peak {:.1} dBFS", peak_dbfs(&before[renderer]));
        assert!(snr > 80.0, "{snr:.1} dB");
    }
}

#[test]
fn object_with_another_gain_differs_in_level_by_just_that() {
    for modes in [kit::ModesGo::Through, kit::ModesGo::Beside] {
        let mut before = filtered();
        before.objects[0].dynamic_filter.as_mut().unwrap().modes = modes;
        let mut after = before.clone();
        after.objects[0] = after.objects[0].with_gain(0.25);
        let [before, after] = [before, after].map(|kit| both(&kit, &[strike(0, 0.0, 1)]));
        for renderer in 0..2 {
            let louder = after[renderer].iter().map(|frame| frame.map(|x| 4.0 * x)).collect();
            let snr = snr_db(&[louder, before[renderer].clone()]);
            assert!(snr > 80.0, "{modes:?}: {snr:.1} dB");
        }
    }
}

#[test]
fn first_example_of_the_format_page_is_played_without_clipping() {
    let page = fs::read_to_string(concat!(env!("CARGO_MANIFEST_DIR"), "/../docs/kit-format.md")).unwrap();
    let example = page.split("```toml\n").nth(1).and_then(|rest| rest.split("```").next()).unwrap();
    let folder = folder(example);
    let kit = kit::load(&folder.path().join("kit.toml")).unwrap().kit;
    let sounds = both(&kit, &[strike(0, 0.0, 0)]);
    let (snr, peak) = (snr_db(&sounds), peak_dbfs(&sounds[1]));
    println!("SNR {snr:.1} dB, peak {peak:.1} dBFS");
    assert!(snr >= 100.0 && peak <= -5.5, "SNR {snr:.1} dB, peak {peak:.1} dBFS");
    fs::write(folder.path().join("s.csv"), "time_s,pad,velocity\n0,bar,1\n").unwrap();
    for renderer in ["", " --reference"] {
        let report = json(folder.path(), &format!("play --kit kit.toml --strikes s.csv -o out.wav --json{renderer}"));
        assert_eq!(report["clipped_samples"], 0, "{report}");
    }
    let text = stdout(folder.path(), "kit check kit.toml");
    assert!(!text.contains("clip"), "{text}");
}

#[test]
fn kit_check_hears_kits_with_surfaces_and_says_what_boards_do_with_them() {
    let done = Command::new(env!("CARGO_BIN_EXE_malleus")).args(["kit", "check", "scrapes"]).output().unwrap();
    let text = String::from_utf8_lossy(&done.stdout).into_owned() + &String::from_utf8_lossy(&done.stderr);
    assert!(done.status.success() && !text.contains("not checked"), "{text}");
    for board in ["stm32f407g-disc1", "blackpill-f411"] {
        let lines: Vec<&str> = text.lines().filter(|line| line.contains(board)).collect();
        assert!(lines.iter().any(|line| line.contains("leaves out: surfaces, 10 of them")), "{text}");
        assert!(lines.iter().any(|line| line.contains("and a slot has 131072")), "{text}");
    }
}
