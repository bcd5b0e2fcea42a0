//! The shipped kit `shapes`: bodies by finite elements, as `malleus shape` makes them.

use std::path::{Path, PathBuf};
use std::process::Command;

use dsp_core::SampleRate;
use dsp_core::engine::{Setup, Skipping};
use dsp_core::event::{Event, Time};
use dsp_core::fixed::ONE_Q27;
use dsp_core::table::Kit;
use malleus::render::instrument::{self, Output, Settings};
use malleus::render::{Performance, reference};

const RATE: SampleRate = SampleRate::HZ_48000;

fn shapes() -> kit::Kit {
    kit::open("shapes").expect("the shipped kit is valid").kit
}

/// Path of a file of the kit.
fn file(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../tables/shapes").join(name)
}

fn object<'a>(kit: &'a kit::Kit, name: &str) -> &'a kit::Object {
    kit.objects.iter().find(|object| object.name == name).expect("an object of the kit")
}

/// Stereo bus of a performance by the instrument, 1.0 = full scale. No mode is retired.
fn play(kit: &kit::Kit, performance: &Performance) -> Vec<[f64; 2]> {
    let binary = kit::binary::build(kit).expect("a valid kit");
    let table = Kit::parse(&binary).expect("a built kit is valid");
    let settings =
        Settings { setup: Setup { skipping: Skipping::Off, ..Setup::new(RATE) }, block: 128, budget_cycles: None };
    let bus = instrument::render(&table, performance, settings, Output::Bus, |_| {}).expect("the kit fits");
    bus.into_iter().map(|frame| frame.map(|x| f64::from(x) / f64::from(ONE_Q27))).collect()
}

#[test]
fn each_body_has_over_105_db_of_snr_to_the_reference() {
    let kit = shapes();
    assert!(kit.pads.len() >= 10, "{} pads", kit.pads.len());
    for (index, pad) in kit.pads.iter().enumerate() {
        let strike = |frame: u64, velocity: f32, position: f32| Event {
            time: Time { frame, fraction: 0x5000_0000 },
            pad: index as u8,
            velocity,
            position,
            ..Event::default()
        };
        let events = vec![strike(100, 0.9, 0.0), strike(5_003, 0.3, 0.4), strike(9_007, 1.0, 1.0)];
        let performance = Performance::new(events, None, &kit, RATE, Some(0.2));
        let expected = reference::render(&kit, &performance, RATE, |_| {}).expect("the events are valid");
        let got = play(&kit, &performance);
        let power: f64 = expected.iter().flatten().map(|x| x * x).sum();
        let error: f64 = expected.iter().flatten().zip(got.iter().flatten()).map(|(a, b)| (a - b).powi(2)).sum();
        let snr_db = 10.0 * (power / error).log10();
        println!("{}: {snr_db:.1} dB", pad.name);
        assert!(snr_db >= 105.0, "{}: {snr_db:.1} dB", pad.name);
    }
}

#[test]
fn undercut_bars_of_the_kit_sound_1_to_4_to_10() {
    let kit = shapes();
    for (name, hz) in [("marimba", 220.0), ("vibraphone", 349.23)] {
        let modes = &object(&kit, name).modes;
        let frequencies: Vec<f64> = modes.iter().map(|mode| f64::from(mode.frequency_hz)).collect();
        let wanted = [hz, 4.0 * frequencies[0], 10.0 * frequencies[0]];
        let off = frequencies.iter().zip(wanted).map(|(found, wanted)| (found / wanted - 1.0).abs());
        let worst = off.fold(0.0, f64::max);
        println!("{name}: {:?}, {:.4} % off at most", &frequencies[..3], 100.0 * worst);
        assert!(worst < 1e-4, "{name}: {frequencies:?}");
    }
}

/// Amplitude of a frequency in a sound from a time on, by a Hann window over the sound.
fn amplitude(sound: &[f64], hz: f64) -> f64 {
    let step = std::f64::consts::TAU * hz / RATE.hz();
    let turn = std::f64::consts::TAU / sound.len() as f64;
    let [mut re, mut im] = [0.0; 2];
    for (index, sample) in sound.iter().enumerate() {
        let windowed = sample * (1.0 - (turn * index as f64).cos());
        re += windowed * (step * index as f64).cos();
        im += windowed * (step * index as f64).sin();
    }
    re.hypot(im) / sound.len() as f64
}

/// Position between 0 and 1 at which a mode's gain crosses zero between two positions of a table.
fn node(mode: &kit::Mode) -> f32 {
    let gains: Vec<f32> = mode.gains.iter().map(|gain| gain.cosine).collect();
    let at = gains.windows(2).position(|pair| pair[0] * pair[1] < 0.0).expect("the mode has a node");
    (at as f32 + gains[at] / (gains[at] - gains[at + 1])) / (gains.len() - 1) as f32
}

#[test]
fn strike_at_the_node_of_mode_1_is_40_db_softer_in_it_than_at_the_antinode() {
    let folder = tempfile::tempdir().expect("a folder");
    let kit = shapes();
    for name in ["marimba", "glockenspiel"] {
        let mode = &object(&kit, name).modes[0];
        let sound = |position: f32| {
            let strikes = format!("time_s,pad,velocity,position\n0,{name},0.9,{position}\n");
            std::fs::write(folder.path().join("s.csv"), strikes).expect("the folder is writable");
            let words = "play --kit shapes --strikes s.csv -o out.wav --tail 1";
            let done = Command::new(env!("CARGO_BIN_EXE_malleus"))
                .args(words.split(' '))
                .current_dir(folder.path())
                .output()
                .expect("the program runs");
            assert!(done.status.success(), "{}", String::from_utf8_lossy(&done.stderr));
            let mut read = hound::WavReader::open(folder.path().join("out.wav")).expect("a sound");
            let samples: Vec<f64> = read.samples::<i32>().step_by(2).map(|x| f64::from(x.expect("a sample"))).collect();
            amplitude(&samples, f64::from(mode.frequency_hz))
        };
        let place = node(mode);
        let [antinode, node] = [sound(0.0), sound(place)];
        let difference_db = 20.0 * (antinode / node).log10();
        println!("{name}: {difference_db:.1} dB between the middle and the node at {place:.4}");
        assert!(difference_db >= 40.0, "{name}: {difference_db:.1} dB");
    }
}

/// Asserts that two tables have the same modes but for rounding.
fn assert_same(found: &kit::Kit, shipped: &kit::Kit) {
    let [found, shipped] = [found, shipped].map(|kit| &kit.objects[0]);
    let named = |object: &kit::Object| (object.name.clone(), object.source.clone(), object.licence.clone());
    assert_eq!(named(found), named(shipped));
    assert_eq!(found.modes.len(), shipped.modes.len());
    let numbers = |mode: &kit::Mode| -> Vec<f32> {
        let gains = mode.gains.iter().flat_map(|gain| [gain.sine, gain.cosine]);
        [mode.frequency_hz, mode.decay_per_s].into_iter().chain(gains).collect()
    };
    for (found, shipped) in found.modes.iter().zip(&shipped.modes) {
        let largest = shipped.gains.iter().map(|gain| gain.cosine.abs()).fold(0.0, f32::max);
        for (number, (a, b)) in numbers(found).into_iter().zip(numbers(shipped)).enumerate() {
            let scale = if number < 2 { b } else { largest };
            assert!((a - b).abs() <= 1e-4 * scale, "{a} and not {b} at {} Hz", shipped.frequency_hz);
        }
    }
}

#[test]
fn tables_of_two_bars_are_what_their_commands_write() {
    let folder = tempfile::tempdir().expect("a folder");
    let script = std::fs::read_to_string(file("make.sh")).expect("the script");
    for (line, words) in [
        ("shape glockenspiel --max-hz 20000", "glockenspiel.shape.toml --max-hz 20000"),
        (
            "undercut marimba --hz 220",
            "marimba.bar.toml --undercut 1:4:10 --tuned OUT/marimba.shape.toml --max-hz 20000 --hz 220",
        ),
    ] {
        assert!(script.contains(line), "{line}");
        let name = line.split(' ').nth(1).expect("a name");
        let table = folder.path().join(format!("{name}.toml"));
        let out = folder.path().to_str().expect("a path in UTF-8");
        let done = Command::new(env!("CARGO_BIN_EXE_malleus"))
            .current_dir(file(""))
            .arg("shape")
            .args(words.split(' ').map(|word| word.replace("OUT", out)))
            .args(["--licence", "CC0-1.0", "-o", table.to_str().expect("a path in UTF-8")])
            .output()
            .expect("the program runs");
        assert!(done.status.success(), "{}", String::from_utf8_lossy(&done.stderr));
        let load = |path: &Path| kit::load(path).expect("a table").kit;
        assert_same(&load(&table), &load(&file(&format!("{name}.toml"))));
    }
    // The shape file that the search writes is as it ships, to a micrometre.
    let corners = |path: &Path| -> Vec<f64> {
        let text = std::fs::read_to_string(path).expect("a shape file");
        let polygon = text.split("polygon_m = ").nth(1).and_then(|rest| rest.split("thickness_m").next());
        let numbers = polygon.expect("a polygon").split(['[', ']', ',', ' ', '\n']);
        numbers.filter_map(|number| number.parse().ok()).collect()
    };
    let [found, shipped] =
        [folder.path().join("marimba.shape.toml"), file("marimba.shape.toml")].map(|path| corners(&path));
    assert!(shipped.len() > 60 && found.len() == shipped.len(), "{} numbers", found.len());
    assert!(found.iter().zip(&shipped).all(|(a, b)| (a - b).abs() <= 1e-6), "{found:?}");
}

#[test]
fn undercut_that_cannot_be_cut_leaves_no_file() {
    let folder = tempfile::tempdir().expect("a folder");
    for (words, reason) in [
        ("--undercut 1:4:28 --tuned t.toml -o o.toml", "no arch was found"),
        ("--undercut 4:1 --tuned t.toml -o o.toml", "1:4:10"),
        ("--undercut 1-4 --tuned t.toml -o o.toml", "colons"),
        ("--undercut 1:4 --tuned t.toml -o t.toml", "one would be lost"),
        ("--undercut 1:4 -o o.toml", "--tuned"),
        ("--hz 100 -o o.toml", "--undercut"),
    ] {
        let done = Command::new(env!("CARGO_BIN_EXE_malleus"))
            .current_dir(folder.path())
            .arg("shape")
            .arg(file("marimba.bar.toml"))
            .args(words.split(' '))
            .output()
            .expect("the program runs");
        let message = String::from_utf8_lossy(&done.stderr);
        assert!(!done.status.success() && message.contains(reason), "{words}: {message}");
        assert!(!message.contains("panicked"), "{words}: {message}");
        let left = std::fs::read_dir(folder.path()).expect("a folder").count();
        assert_eq!(left, 0, "{words} leaves a file");
    }
}
