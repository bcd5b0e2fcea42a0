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
        (["--adc-noise", "1e9"], "from 0 to 4095 counts"),
        (["--adc-noise", "4096"], "from 0 to 4095 counts"),
    ] {
        let refused = complaint(&["image.elf", arguments[0], arguments[1]]);
        assert!(refused.contains(expected), "{arguments:?}: {refused}");
    }
}

#[test]
fn outputs_that_would_be_lost_or_cannot_be_written_are_refused_before_the_run() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
    let [image, kit, hit, song, sysex] = ["i.elf", "k.bin", "h.wav", "s.mid", "x.syx"].map(path);
    let inputs = [&image, &kit, &hit, &song, &sysex];
    inputs.iter().for_each(|input| std::fs::write(input, input).unwrap());
    let numbered = format!("1={hit}");
    let [new, away, folder_itself] = [path("new"), path("gone/new"), path("")];
    let read = "is read by this command and would be lost";
    for (arguments, words) in [
        (&["-o", &image][..], format!("i.elf: {read}")),
        (&["--midi-out", &image], format!("i.elf: {read}")),
        (&["--kit", &kit, "-o", &kit], format!("k.bin: {read}")),
        (&["--piezo", &hit, "-o", &hit], format!("h.wav: {read}")),
        (&["--piezo", &numbered, "-o", &hit], format!("h.wav: {read}")),
        (&["--midi", &song, "--midi-out", &song], format!("s.mid: {read}")),
        (&["--sysex", &sysex, "--midi-out", &sysex], format!("x.syx: {read}")),
        (&["-o", &new, "--midi-out", &new], "new: is named for two outputs".to_owned()),
        (&["-o", &away], "gone/new: cannot be written".to_owned()),
        (&["--midi-out", &away], "gone/new: cannot be written".to_owned()),
        (&["-o", &folder_itself], "cannot be written: is a directory".to_owned()),
        (&["--midi-out", &folder_itself], "cannot be written: is a directory".to_owned()),
    ] {
        let refused = complaint(&[&[image.as_str()], arguments].concat());
        assert!(refused.contains(&words), "{arguments:?}: {refused}");
        assert!(inputs.iter().all(|input| std::fs::read_to_string(input).unwrap() == **input), "{arguments:?}");
        assert!(!Path::new(&new).exists(), "{arguments:?}");
    }
}

#[test]
fn kits_and_signals_that_the_board_cannot_take_are_refused_by_name() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
    let [image, text, song, hit] = ["i.elf", "k.toml", "s.mid", "h.wav"].map(path);
    std::fs::write(&image, "not an ELF file").unwrap();
    std::fs::write(&text, "name = \"a kit\"").unwrap();
    std::fs::write(&song, usb_midi::song(&[]).unwrap()).unwrap();
    let spec =
        hound::WavSpec { channels: 1, sample_rate: 8000, bits_per_sample: 16, sample_format: hound::SampleFormat::Int };
    hound::WavWriter::create(&hit, spec).unwrap().finalize().unwrap();
    let [first, third] = [format!("1={hit}"), format!("3={hit}")];
    for (arguments, words) in [
        (&["--kit", &text][..], "k.toml: is a kit as text"),
        (&["--kit", &text], "malleus kit build"),
        (&["--kit", &song], "s.mid: is no binary kit"),
        (&["--pins", "open,open,open,open,open,open"], "--pins names 6 parts, and stm32f407g-disc1 has 4 piezos"),
        (&["--pins", "piezo,piezo,piezo,open", "--piezo", &third], "h.wav: cannot reach the board"),
        (&["--piezo", &first, "--piezo", &first], "--piezo gives piezo 1 two signals"),
        // The last one is refused for its image alone.
        (&["--pins", "open,piezo,open,piezo", "--piezo", &first, "--piezo", &third], "cannot be read as ELF"),
    ] {
        let refused = complaint(&[&[image.as_str()], arguments].concat());
        assert!(refused.contains(words), "{arguments:?}: {refused}");
    }
}

#[test]
fn runner_of_the_blackpill_is_one_line_wherever_it_is_told() {
    let repository = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/.."));
    let read = |file: &str| std::fs::read_to_string(repository.join(file)).unwrap();
    // A runner of `cfg(all())` loses against one of the triple.
    let config = read("firmware/.cargo/config.toml");
    assert!(config.contains("\n[target.thumbv7em-none-eabihf]\nrunner = "), "{config}");
    let runner = "--config 'target.thumbv7em-none-eabihf.runner=\"probe-rs run --chip STM32F411CEUx\"'";
    for file in ["firmware/.cargo/config.toml", "docs/hardware.md", "docs/first-flash.md"] {
        assert!(read(file).contains(runner), "{file}");
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
    assert_eq!(report["seconds"], 0.33);
    assert_eq!(report["audio"]["rate"], "671875/14");
    let lines = report["log"].as_array().unwrap();
    assert!(lines.iter().any(|line| line["message"].as_str().unwrap().contains("strike")), "{lines:#?}");

    // The plain header, format 1, as that of `malleus play`.
    let bytes = std::fs::read(&sound).unwrap();
    assert_eq!((&bytes[12..22], &bytes[36..40]), (b"fmt \x10\0\0\0\x01\0".as_slice(), b"data".as_slice()));
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
fn song_that_comes_too_early_is_told_and_midi_out_counts_from_its_origin() {
    let firmware = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../firmware/Cargo.toml"));
    let features = ["--no-default-features", "--features", "stm32f407g-disc1"];
    let elf = virtual_core::build_binary(firmware, "percussion", &features).unwrap();
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
    let [image, song, answers] = ["percussion.elf", "song.mid", "answers.mid"].map(path);
    std::fs::write(&image, elf).unwrap();
    std::fs::write(&song, usb_midi::song(&[(0.0, [0x09, 0x99, 36, 90])]).unwrap()).unwrap();
    let presses = ["--button", "0.3,0.02", "--button", "0.4,0.02", "--seconds", "0.45", "--midi-out", &answers];
    // The presses go out as notes of the first pad a few milliseconds later.
    for (more, expected_s, warned) in [
        (&[][..], &[0.3, 0.4][..], false),
        (&["--midi", &song, "--midi-start", "0.01"], &[0.29, 0.39], true),
        (&["--midi", &song, "--midi-start", "0.35"], &[0.05], false),
        (&["--midi", &song], &[], true),
    ] {
        let output = malleus(&[&[image.as_str()], &presses[..], more].concat());
        let told = String::from_utf8(output.stderr).unwrap();
        assert!(output.status.success(), "{told}");
        assert_eq!(told.contains("warning: the board never got 1 transfer"), warned, "{more:?}: {told}");
        let answers = usb_midi::packets(&std::fs::read(&answers).unwrap()).unwrap();
        let notes = answers.iter().filter(|(_, packets)| packets[0][0] == 0x09).map(|(at_s, _)| *at_s);
        let notes: Vec<f64> = notes.collect();
        assert_eq!(notes.len(), expected_s.len(), "{more:?}: {notes:?}");
        assert!(notes.iter().zip(expected_s).all(|(at_s, wanted)| (0.0..0.02).contains(&(at_s - wanted))), "{notes:?}");
    }
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
