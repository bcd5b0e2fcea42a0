//! The program as its user meets it: files in, exit codes, messages, files out.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use tempfile::TempDir;

const KIT: &str = r#"
format = 1
name = "test"
[[object]]
name = "bar"
modes = [
  { frequency_hz = 440.0, decay_per_s = 30.0, gain_sine = 300.0, gain_cosine = 20.0 },
  { frequency_hz = 5200.0, decay_per_s = 50.0, gain_sine = 300.0, gain_cosine = 0.0 },
]
[[striker]]
name = "stick"
peak_force = 1.0
contact_time_s = 0.0005
[[pad]]
name = "bar"
object = "bar"
strikers = ["stick"]
midi_notes = [60]
"#;

/// A folder with a kit and what a test puts there.
struct Folder(TempDir);

impl Folder {
    fn new() -> Self {
        let folder = Self(tempfile::tempdir().unwrap());
        folder.write("kit.toml", KIT.as_bytes());
        folder
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    fn write(&self, name: &str, bytes: &[u8]) -> &Self {
        fs::write(self.path(name), bytes).unwrap();
        self
    }

    /// Runs `malleus` here with words split at spaces.
    fn malleus(&self, words: &str) -> Output {
        Command::new(env!("CARGO_BIN_EXE_malleus")).args(words.split(' ')).current_dir(self.0.path()).output().unwrap()
    }

    /// Asserts that a run fails with code 1, names all of `expected` on stderr, and leaves no output behind.
    fn refuses(&self, words: &str, expected: &[&str]) {
        let files = |folder: &Path| fs::read_dir(folder).unwrap().count();
        let before = files(self.0.path());
        let output = self.malleus(words);
        let message = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(1), "{words}: {message}");
        for part in expected {
            assert!(message.contains(part), "{words}: no {part:?} in: {message}");
        }
        assert!(!message.contains("panicked"), "{message}");
        assert_eq!(files(self.0.path()), before, "{words}: a file was left behind");
    }

    fn refuses_strikes(&self, csv: &str, expected: &[&str]) {
        self.write("strikes.csv", csv.as_bytes());
        self.refuses("play --kit kit.toml --strikes strikes.csv -o out.wav", expected);
    }
}

/// A Standard MIDI File of one track with the given events.
fn midi(events: &[u8]) -> Vec<u8> {
    let mut file = b"MThd\0\0\0\x06\0\0\0\x01\0\x60MTrk".to_vec();
    file.extend((events.len() as u32 + 4).to_be_bytes());
    file.extend(events);
    file.extend([0, 0xFF, 0x2F, 0]);
    file
}

fn samples(path: &Path) -> Vec<i32> {
    hound::WavReader::open(path).unwrap().into_samples::<i32>().map(Result::unwrap).collect()
}

#[test]
fn strikes_become_a_24_bit_stereo_file() {
    let folder = Folder::new();
    folder.write("s.csv", b"sample,pad,velocity\n100,bar,1\n24000,bar,0.25\n");
    let output = folder.malleus("play --kit kit.toml --strikes s.csv -o out.wav --json");
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    let report: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(report["work"]["strikes"], 2);
    let spec = hound::WavReader::open(folder.path("out.wav")).unwrap().spec();
    assert_eq!((spec.channels, spec.bits_per_sample, spec.sample_rate), (2, 24, 48_000));
    // The plain header, which every reader knows: format 1 at byte 20.
    assert_eq!(fs::read(folder.path("out.wav")).unwrap()[20..22], [1, 0]);
    let sound = samples(&folder.path("out.wav"));
    assert!(sound[..200].iter().all(|&sample| sample == 0));
    assert!(sound[200..].iter().any(|&sample| sample.abs() > 1 << 18));
}

#[test]
fn the_instrument_is_within_rounding_of_the_reference() {
    let folder = Folder::new();
    folder.write(
        "s.csv",
        b"time_s,pad,velocity,position,striker,action\n0.01001,bar,0.9,,,\n0.1,bar,,,,choke\n0.15,bar,,,,release\n",
    );
    for (file, option) in [("a.wav", "--no-skip"), ("b.wav", "--reference")] {
        let output = folder.malleus(&format!("play --kit kit.toml --strikes s.csv -o {file} {option}"));
        assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    }
    let (instrument, reference) = (samples(&folder.path("a.wav")), samples(&folder.path("b.wav")));
    assert_eq!(instrument.len(), reference.len());
    let worst = instrument.iter().zip(&reference).map(|(a, b)| a.abs_diff(*b)).max();
    assert!(worst <= Some(2), "{worst:?} steps of 24 bits");
}

#[test]
fn any_block_gives_the_same_file_and_a_binary_kit_the_same_as_its_text() {
    let folder = Folder::new();
    folder.write("s.csv", b"time_s,pad,velocity\n0.01001,bar,0.9\n0.0101,bar,1\n");
    assert_eq!(folder.malleus("kit build kit.toml -o kit.bin").status.code(), Some(0));
    folder.malleus("play --kit kit.toml --strikes s.csv -o first.wav --rate 86000000/1792");
    for block in [8, 32, 33, 128] {
        folder.malleus(&format!("play --kit kit.bin --strikes s.csv -o out.wav --block {block} --rate 86000000/1792"));
        assert_eq!(fs::read(folder.path("first.wav")).unwrap(), fs::read(folder.path("out.wav")).unwrap(), "{block}");
    }
}

#[test]
fn midi_notes_strike_the_pads_that_the_kit_maps() {
    let folder = Folder::new();
    // Two quarter notes at 120 beats a minute; note 61 is not mapped.
    folder.write("a.mid", &midi(&[0, 0x99, 60, 127, 0, 0x99, 61, 90, 0x60, 0x99, 60, 64, 0, 0x89, 60, 0]));
    let output = folder.malleus("play --kit kit.toml --strikes a.mid -o out.wav --json");
    let message = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(0), "{message}");
    assert!(message.contains("61"), "{message}");
    let report: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(report["work"]["strikes"], 2);
    let sound = samples(&folder.path("out.wav"));
    let onset = |from: usize| (from..).find(|&frame| sound[2 * frame] != 0).unwrap();
    assert!(onset(0) <= 2 && (23_000..=24_002).contains(&onset(23_900)));
}

#[test]
fn a_direct_force_plays_at_its_own_rate() {
    let folder = Folder::new();
    let spec = hound::WavSpec {
        channels: 2,
        sample_rate: 44_100,
        bits_per_sample: 16,
        sample_format: hound::SampleFormat::Int,
    };
    let mut writer = hound::WavWriter::create(folder.path("f.wav"), spec).unwrap();
    for frame in 0..1000 {
        writer.write_sample(0i16).unwrap();
        writer.write_sample(if frame == 500 { 30_000i16 } else { 0 }).unwrap();
    }
    writer.finalize().unwrap();
    assert_eq!(folder.malleus("play --kit kit.toml --direct f.wav:1 --pad bar -o out.wav").status.code(), Some(0));
    assert_eq!(hound::WavReader::open(folder.path("out.wav")).unwrap().spec().sample_rate, 44_100);
    let sound = samples(&folder.path("out.wav"));
    assert_eq!(sound.iter().position(|&sample| sample != 0).map(|index| index / 2), Some(500));
    folder.refuses("play --kit kit.toml --direct f.wav:2 --pad bar -o no.wav", &["channel 2", "counted from 0"]);
    folder.refuses("play --kit kit.toml --direct f.wav --pad bra -o no.wav", &["bra", "bar"]);
    folder.refuses("play --kit kit.toml --direct f.wav --pad bar --rate 48000 -o no.wav", &["44100", "48000"]);
    folder.refuses("play --kit kit.toml --direct kit.toml --pad bar -o no.wav", &["kit.toml", "not a readable WAV"]);
}

#[test]
fn bad_events_are_refused_by_line_field_value_and_what_is_allowed() {
    let folder = Folder::new();
    folder.refuses_strikes("sample,pad,velocity\n10,bar,1\n5,bar,1\n", &["line 3", "earlier"]);
    folder.refuses_strikes("sample,pad,velocity\n-1,bar,1\n", &["line 2", "sample", "-1"]);
    folder.refuses_strikes("time_s,pad,velocity\n-0.5,bar,1\n", &["line 2", "time_s", "-0.5"]);
    folder.refuses_strikes("time_s,pad,velocity\nNaN,bar,1\n", &["line 2", "time_s"]);
    folder.refuses_strikes("sample,pad,velocity\n0,cymbal,1\n", &["line 2", "cymbal", "the kit has bar"]);
    folder.refuses_strikes("sample,pad,velocity\n0,bar,1.5\n", &["line 2", "velocity", "1.5", "0 to 1"]);
    folder.refuses_strikes("sample,pad,velocity\n0,bar,nan\n", &["line 2", "velocity"]);
    folder.refuses_strikes("sample,pad,velocity,position\n0,bar,1,-0.1\n", &["line 2", "position", "-0.1"]);
    folder.refuses_strikes("sample,pad,velocity,striker\n0,bar,1,axe\n", &["line 2", "axe", "stick"]);
    folder.refuses_strikes("sample,pad,velocity,action\n0,bar,1,hit\n", &["line 2", "action", "hit"]);
    folder.refuses_strikes("sample,pad,speed\n0,bar,1\n", &["line 1", "speed"]);
    folder.refuses_strikes("pad,velocity\nbar,1\n", &["line 1", "time_s"]);
    folder.refuses_strikes("sample,pad,velocity\n0,bar\n", &["line"]);
    folder.refuses_strikes("sample,pad,velocity\n9007199254740000,bar,1\n", &["strikes.csv", "at most 3600"]);
    folder.refuses("play --kit kit.toml --strikes none.csv -o out.wav", &["none.csv"]);
}

#[test]
fn damaged_midi_is_refused() {
    let folder = Folder::new();
    let whole = midi(&[0, 0x99, 60, 127, 0x60, 0x99, 60, 64, 0, 0x89, 60, 0]);
    for length in 1..whole.len() {
        folder.write("cut.mid", &whole[..length]);
        folder.refuses("play --kit kit.toml --strikes cut.mid -o out.wav", &["cut.mid"]);
    }
    folder.write("other.mid", &midi(&[0, 0x99, 35, 127]));
    folder.refuses("play --kit kit.toml --strikes other.mid -o out.wav", &["midi_notes", "60 (bar)"]);
}

#[test]
fn damaged_kits_are_refused_by_name() {
    let folder = Folder::new();
    folder.write("s.csv", b"sample,pad,velocity\n0,bar,1\n");
    folder.malleus("kit build kit.toml -o good.bin");
    let good = fs::read(folder.path("good.bin")).unwrap();
    let mut newer = good.clone();
    newer[4] = 9;
    let mut flipped = good.clone();
    flipped[good.len() / 2] ^= 4;
    let cases: [(&[u8], &str); 4] =
        [(&good[..good.len() - 7], "truncated"), (b"RIFFabcdefgh", "magic"), (&newer, "version 9"), (&flipped, "CRC")];
    folder.write("k.bin", b"");
    for (bytes, expected) in cases {
        folder.write("k.bin", bytes);
        folder.refuses("play --kit k.bin --strikes s.csv -o out.wav", &["k.bin", expected]);
        folder.refuses("kit check k.bin", &["k.bin", expected]);
    }
    let text = |from: &str, to: &str| KIT.replace(from, to).into_bytes();
    let cases: [(Vec<u8>, &[&str]); 6] = [
        (text("frequency_hz = 440.0", "frequency_hz = nan"), &["frequency_hz", "NaN", "0.1"]),
        (text("frequency_hz = 440.0", "frequency_hz = inf"), &["frequency_hz", "inf"]),
        (text("decay_per_s = 30.0", "decay_per_s = -30.0"), &["decay_per_s", "-30", "0.01"]),
        (text("gain_sine = 300.0, gain_cosine = 20.0", "gain = 3"), &["gain", ":7:"]),
        (text("contact_time_s = 0.0005", "contact_time = 0.0005"), &["contact_time", ":13:"]),
        (text("decay_per_s = 50.0", "decay_per_s = 19999.0"), &["decay_per_s", "19999", "16320"]),
    ];
    folder.write("k.toml", b"");
    for (bytes, expected) in cases {
        folder.write("k.toml", &bytes);
        folder.refuses("play --kit k.toml --strikes s.csv -o out.wav", expected);
    }
    folder.refuses("play --kit nothing --strikes s.csv -o out.wav", &["nothing", "demo"]);
}

#[test]
fn wrong_usage_exits_with_2() {
    let folder = Folder::new();
    folder.write("s.csv", b"sample,pad,velocity\n0,bar,1\n");
    for words in [
        "play --kit kit.toml -o out.wav",
        "play --kit kit.toml --strikes s.csv --direct f.wav --pad bar -o out.wav",
        "play --kit kit.toml --direct f.wav -o out.wav",
        "play --kit kit.toml --strikes s.csv -o out.wav --rate 0",
        "play --kit kit.toml --strikes s.csv -o out.wav --block 0",
        "dance",
    ] {
        assert_eq!(folder.malleus(words).status.code(), Some(2), "{words}");
    }
}

#[test]
fn what_a_budget_left_out_plays_to_the_same_bits_from_the_log() {
    let folder = Folder::new();
    // Times between samples, so that the log must keep them exactly.
    folder.write("strikes.csv", b"time_s,pad,velocity\n0.00101,bar,0.9\n0.0507,bar,0.5\n0.11,bar,1\n");
    let played = |words: &str, file: &str| {
        let output = folder.malleus(words);
        assert!(output.status.success(), "{words}: {}", String::from_utf8_lossy(&output.stderr));
        fs::read(folder.path(file)).unwrap()
    };
    let whole = played("play --kit kit.toml --strikes strikes.csv -o whole.wav", "whole.wav");
    let busy = "play --kit kit.toml --strikes strikes.csv --budget-mhz 20 --log log.csv -o busy.wav";
    let busy = played(busy, "busy.wav");
    let log = fs::read_to_string(folder.path("log.csv")).unwrap();
    assert!(busy != whole && log.contains(",shed "), "{log}");
    assert!(played("play --kit kit.toml --strikes log.csv -o again.wav", "again.wav") == busy, "{log}");
}

#[test]
fn clipped_samples_are_counted_and_the_peak_before_them_is_told() {
    let folder = Folder::new();
    folder.write("s.csv", b"sample,pad,velocity\n0,bar,1\n");
    folder.write("loud.toml", KIT.replace("midi_notes", "level_db = 30\nmidi_notes").as_bytes());
    let played = |kit: &str, options: &str| {
        let words = format!("play --kit {kit} --strikes s.csv -o out.wav --json{options}");
        let output = folder.malleus(&words);
        assert_eq!(output.status.code(), Some(0), "{words}");
        let report: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
        (report, String::from_utf8(output.stderr).unwrap(), samples(&folder.path("out.wav")))
    };
    for renderer in ["", " --reference"] {
        let (soft, told, _) = played("kit.toml", renderer);
        assert_eq!(soft["clipped_samples"], 0, "{told}");
        assert!(!told.contains("clip"), "{told}");
        let (loud, told, sound) = played("loud.toml", renderer);
        let at_the_end = sound.iter().filter(|sample| !(-(1 << 23) + 1..(1 << 23) - 1).contains(*sample)).count();
        assert_eq!(loud["clipped_samples"], at_the_end, "{loud}");
        assert!(at_the_end > 100 && told.contains(&format!("{at_the_end} samples are clipped")), "{told}");
        let [soft, loud_peak] = [&soft, &loud].map(|report| report["unclipped_peak_dbfs"].as_f64().unwrap());
        assert!((loud_peak - soft - 30.0).abs() < 0.01 && loud_peak > 0.0, "{soft} {loud_peak}");
        assert!(loud["peak_dbfs"].as_f64().unwrap().abs() < 1e-5);
    }
    let output = folder.malleus("play --kit loud.toml --strikes s.csv -o out.wav");
    let text = String::from_utf8(output.stdout).unwrap();
    assert!(text.contains("samples were clipped") && text.contains("peak +"), "{text}");
}

#[test]
fn strikes_that_may_clip_the_force_bus_are_counted() {
    let folder = Folder::new();
    folder.write("hard.toml", KIT.replace("peak_force = 1.0", "peak_force = 9.0").as_bytes());
    folder.write("harder.toml", KIT.replace("peak_force = 1.0", "peak_force = 17.0").as_bytes());
    folder.write("roll.csv", b"time_s,pad,velocity\n0,bar,1\n0.0002,bar,1\n0.1,bar,1\n");
    folder.write("one.csv", b"time_s,pad,velocity\n0,bar,1\n0.1,bar,0.5\n");
    for (kit, strikes, overloads, largest) in
        [("kit", "roll", 0, 2.0), ("hard", "one", 0, 9.0), ("hard", "roll", 1, 18.0), ("harder", "one", 1, 17.0)]
    {
        let output = folder.malleus(&format!("play --kit {kit}.toml --strikes {strikes}.csv -o out.wav --json"));
        let report: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
        let told = String::from_utf8(output.stderr).unwrap();
        assert_eq!((&report["force_overloads"], &report["largest_force"]), (&overloads.into(), &largest.into()));
        assert_eq!(told.contains("reference_force"), overloads > 0, "{told}");
    }
}

/// Two pads of 60 modes: more than a board has time for at once, but the faster one for some.
fn many_modes() -> String {
    let mut kit = String::from("format = 1\nname = \"many\"\n");
    for pad in 0..2 {
        kit += &format!("[[object]]\nname = \"bar {pad}\"\nmodes = [\n");
        for mode in 0..60 {
            let frequency_hz = 200.0 + 110.0 * f64::from(mode) + 7.0 * f64::from(pad);
            let gain = 30.0 / (1.0 + f64::from(mode));
            kit += &format!("{{ frequency_hz = {frequency_hz}, decay_per_s = 20, gain_sine = {gain} }},\n");
        }
        kit += "]\n";
    }
    kit += "[[striker]]\nname = \"stick\"\npeak_force = 1.0\ncontact_time_s = 0.0005\n";
    for pad in 0..2 {
        kit += &format!("[[pad]]\nname = \"bar {pad}\"\nobject = \"bar {pad}\"\nstrikers = [\"stick\"]\n");
    }
    kit
}

#[test]
fn a_board_plays_within_its_budget_unless_that_is_lifted() {
    let folder = Folder::new();
    folder.write("many.toml", many_modes().as_bytes());
    let strikes = (0..2).map(|pad| format!("0,bar {pad},1\n")).collect::<String>();
    folder.write("chord.csv", format!("time_s,pad,velocity\n{strikes}").as_bytes());
    let played = |options: &str, strikes: &str| {
        let words = format!("play --kit many.toml --strikes {strikes} -o out.wav --json {options}");
        let output = folder.malleus(&words);
        assert!(output.status.success(), "{words}: {}", String::from_utf8_lossy(&output.stderr));
        let report: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
        (report, fs::read(folder.path("out.wav")).unwrap())
    };
    let check = folder.malleus("kit check many.toml --json");
    let check: serde_json::Value = serde_json::from_slice(&check.stdout).unwrap();
    for (index, (board, cycles, mhz)) in
        [("stm32f407g-disc1", 45_500, 0.0), ("blackpill-f411", 25_000, 37.5)].into_iter().enumerate()
    {
        let (within, sound) = played(&format!("--board {board} --log log.csv"), "chord.csv");
        let shed = within["work"]["shed_modes"].as_u64().unwrap();
        println!("{board}: {shed} modes in {} ticks", within["work"]["shedding_ticks"]);
        assert_eq!((&within["board"], &within["budget_cycles"]), (&board.into(), &cycles.into()));
        assert!(shed > 0, "{board}");
        // The kit check says beforehand what of each pad is shed.
        let board_check = &check["boards"][index];
        let told = board_check["chord_shed"].as_array().unwrap().iter().map(|shed| shed["modes"].as_u64().unwrap());
        assert_eq!((&board_check["board"], told.sum::<u64>()), (&board.into(), shed), "{board_check}");
        // A log holds the decisions: played back, they are taken as they are.
        let (replayed, again) = played(&format!("--board {board}"), "log.csv");
        assert!(again == sound && replayed["budget_cycles"].is_null(), "{board}");
        let (whole, unlimited) = played(&format!("--board {board} --budget-mhz 0"), "chord.csv");
        assert!(unlimited != sound && whole["work"]["shed_modes"] == 0 && whole["budget_cycles"].is_null());
        if mhz > 0.0 {
            let (_, of_mhz) = played(&format!("--board {board} --budget-mhz {mhz}"), "chord.csv");
            assert!(of_mhz == sound, "{board} at {mhz} MHz");
        }
    }
    let text = String::from_utf8(folder.malleus("kit check many.toml").stdout).unwrap();
    assert!(text.contains("stm32f407g-disc1 sheds of all pads at once at velocity 1: "), "{text}");
    assert!(text.contains(" of 60 modes of \"bar 1\""), "{text}");
    assert!(text.contains("blackpill-f411 sheds of all pads at once at velocity 1: all 120 modes"), "{text}");
    let text = String::from_utf8(folder.malleus("kit check kit.toml").stdout).unwrap();
    assert!(text.contains("blackpill-f411 sheds nothing of all pads at once at velocity 1"), "{text}");
}

#[test]
fn the_help_of_play_names_every_shipped_kit() {
    let help = String::from_utf8(Folder::new().malleus("play --help").stdout).unwrap();
    for name in kit::shipped_names() {
        assert!(help.contains(name), "{name}");
    }
}
