//! `malleus board`, as its user calls it.

use std::path::Path;
use std::process::{Command, Output};

use malleus::events::usb_midi;

fn malleus(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_malleus")).args(["board", "run"]).args(arguments).output().unwrap()
}

fn complaint(arguments: &[&str]) -> String {
    let output = malleus(arguments);
    assert!(!output.status.success());
    String::from_utf8(output.stderr).unwrap()
}

#[test]
fn image_that_cannot_be_run_is_refused_with_its_name() {
    let folder = tempfile::tempdir().unwrap();
    let missing = complaint(&["no/such/image.elf"]);
    assert!(missing.contains("no/such/image.elf"), "{missing}");
    let text = folder.path().join("text.elf");
    std::fs::write(&text, "not an ELF file").unwrap();
    let refused = complaint(&[text.to_str().unwrap()]);
    assert!(refused.contains("cannot be read as ELF"), "{refused}");
}

#[test]
fn wrong_arguments_are_refused_with_what_is_allowed() {
    for (arguments, expected) in [
        (["--board", "arduino"], "stm32f407g-disc1"),
        (["--fault", "adc-overrun"], "adc-overrun@AT"),
        (["--fault", "core-stalled@1"], "core-stalled@AT,FOR"),
        (["--button", "1,2,3,4"], "when, for how long"),
        (["--seconds", "5000"], "3600"),
    ] {
        let refused = complaint(&["image.elf", arguments[0], arguments[1]]);
        assert!(refused.contains(expected), "{arguments:?}: {refused}");
    }
}

#[test]
fn firmware_plays_a_press_of_the_button_and_reports_it() {
    let firmware = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../firmware/Cargo.toml"));
    let features = ["--no-default-features", "--features", "stm32f407g-disc1"];
    let elf = virtual_core::build_binary(firmware, "percussion", &features).unwrap();
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
    let (image, sound) = (path("percussion.elf"), path("sound.wav"));
    std::fs::write(&image, elf).unwrap();
    let output = malleus(&[&image, "--button", "0.25,0.05", "--seconds", "0.33", "-o", &sound, "--report", "json"]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let report: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(report["board"], "stm32f407g-disc1");
    assert_eq!(report["audio"]["rate"], "671875/14");
    let lines = report["log"].as_array().unwrap();
    assert!(lines.iter().any(|line| line["message"].as_str().unwrap().contains("strike")), "{lines:#?}");

    let mut wave = hound::WavReader::open(&sound).unwrap();
    assert_eq!((wave.spec().sample_rate, wave.spec().bits_per_sample, wave.spec().channels), (47_991, 24, 2));
    let peak = wave.samples::<i32>().map(|sample| sample.unwrap().unsigned_abs()).max().unwrap();
    assert!(peak > 1 << 16, "{peak}");
}

#[test]
fn song_and_sysex_go_to_the_board_over_usb_and_its_answers_to_a_midi_file() {
    let firmware = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../firmware/Cargo.toml"));
    let features = ["--no-default-features", "--features", "stm32f407g-disc1"];
    let elf = virtual_core::build_binary(firmware, "percussion", &features).unwrap();
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
    let [image, song, sysex, answers] = ["percussion.elf", "song.mid", "one.syx", "answers.mid"].map(path);
    std::fs::write(&image, elf).unwrap();
    let notes = [(0.0, [0x09, 0x99, 36, 90]), (0.01, [0x09, 0x99, 38, 91])];
    std::fs::write(&song, usb_midi::song(&notes).unwrap()).unwrap();
    std::fs::write(&sysex, [0xf0, 0x7d, 1, 2, 0xf7]).unwrap();
    let output = malleus(&[
        &image,
        "--midi",
        &song,
        "--midi-start",
        "0.4",
        "--sysex",
        &sysex,
        "--midi-out",
        &answers,
        "--button",
        "0.45,0.02",
        "--seconds",
        "0.5",
        "--report",
        "json",
    ]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let report: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    let sent: Vec<u8> = (report["usb"]["sent"].as_array().unwrap().iter())
        .flat_map(|transfer| transfer["bytes"].as_array().unwrap())
        .map(|byte| byte.as_u64().unwrap() as u8)
        .collect();
    assert_eq!(sent.as_chunks().0, [[4, 0xf0, 0x7d, 1], [6, 2, 0xf7, 0], notes[0].1, notes[1].1]);
    // The press of the button goes out as a note of the first pad, with velocity 0.8.
    let answers = usb_midi::packets(&std::fs::read(&answers).unwrap()).unwrap();
    assert!(answers.iter().any(|(_, packets)| packets.contains(&[0x09, 0x99, 60, 102])), "{answers:?}");
    let refused = complaint(&[&image, "--midi", &sysex]);
    assert!(refused.contains("one.syx") && refused.contains("Standard MIDI File"), "{refused}");
}

#[test]
fn program_that_meets_a_breakpoint_ends_with_a_message_that_names_it() {
    // The program is made for the bare core. It meets a breakpoint, which is a fault without a
    // debugger.
    let program = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../virtual-core/tests/program/Cargo.toml"));
    let folder = tempfile::tempdir().unwrap();
    let image = folder.path().join("program.elf");
    std::fs::write(&image, virtual_core::build(program).unwrap()).unwrap();
    let refused = complaint(&[image.to_str().unwrap(), "--seconds", "0.1"]);
    assert!(refused.contains("breakpoint #0"), "{refused}");
}

#[cfg(not(feature = "usb-midi"))]
#[test]
fn command_to_a_real_board_tells_how_to_install_a_malleus_with_usb_midi() {
    for arguments in [&["info"][..], &["send", "demo"], &["erase", "--slot", "0"], &["settings"], &["dfu"]] {
        let output = Command::new(env!("CARGO_BIN_EXE_malleus")).arg("board").args(arguments).output().unwrap();
        assert!(!output.status.success(), "{arguments:?}");
        let told = String::from_utf8(output.stderr).unwrap();
        assert!(told.contains("--path malleus --features usb-midi"), "{arguments:?}: {told}");
        assert!(told.contains("libasound2-dev"), "{arguments:?}: {told}");
    }
}

#[test]
fn kit_to_send_is_checked_before_the_board_is_looked_for() {
    let output = Command::new(env!("CARGO_BIN_EXE_malleus")).args(["board", "send", "no-such-kit"]).output().unwrap();
    let told = String::from_utf8(output.stderr).unwrap();
    assert!(!output.status.success() && told.contains("no-such-kit"), "{told}");
}
