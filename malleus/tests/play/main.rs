//! The program as its user meets it: files are read, messages and exit codes are right, files are
//! written.

mod budget;
mod folder;
mod levels;
mod own_force;
mod refusals;
mod strikes_on_boards;

use std::fs;

use folder::{Folder, KIT, midi, samples};

#[test]
fn strikes_are_written_as_a_24_bit_stereo_file() {
    let folder = Folder::new();
    folder.write("s.csv", b"sample,pad,velocity\n100,bar,1\n24000,bar,0.25\n");
    let output = folder.malleus("play --kit kit.toml --strikes s.csv -o out.wav --json");
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    let report: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(report["work"]["strikes"], 2);
    let spec = hound::WavReader::open(folder.path("out.wav")).unwrap().spec();
    assert_eq!((spec.channels, spec.bits_per_sample, spec.sample_rate), (2, 24, 48_000));
    // Format 1 at byte 20: the plain header, which every reader knows.
    assert_eq!(fs::read(folder.path("out.wav")).unwrap()[20..22], [1, 0]);
    let sound = samples(&folder.path("out.wav"));
    assert!(sound[..200].iter().all(|&sample| sample == 0));
    assert!(sound[200..].iter().any(|&sample| sample.abs() > 1 << 18));
}

#[test]
fn instrument_is_within_two_24_bit_steps_of_the_reference() {
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
fn sound_is_the_same_in_any_block_and_from_the_binary_kit_as_from_the_text() {
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
    // Two notes a quarter apart at 120 quarter notes per minute; note 61 is not mapped.
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
fn spaces_before_quotes_and_lines_of_spaces_change_no_events() {
    let folder = Folder::new();
    folder.write("tight.csv", b"sample,pad,velocity,position,striker\n100,bar,1,0,stick\n24000,bar,0.25,0,stick\n");
    folder.write(
        "loose.csv",
        b" \"sample\", \"pad\" ,\t\"velocity\",position, striker\r\n  \r\n100, \"bar\", 1, 0, \"stick\"\r\n\t\r\n24000,bar,\"0.25\",0,stick\r\n   ",
    );
    for name in ["tight", "loose"] {
        let output = folder.malleus(&format!("play --kit kit.toml --strikes {name}.csv -o {name}.wav"));
        assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    }
    assert_eq!(samples(&folder.path("tight.wav")), samples(&folder.path("loose.wav")));
    folder.write("wrong.csv", b"sample,pad,velocity\n   \n1, \"drum\",1\n");
    folder.refuses("play --kit kit.toml --strikes wrong.csv -o no.wav", &["line 3", "drum"]);
}

#[test]
fn direct_force_is_played_at_the_rate_of_its_file() {
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
fn direct_force_that_was_written_into_a_pipe_is_read_to_its_end() {
    let folder = Folder::new();
    let spec = hound::WavSpec {
        channels: 2,
        sample_rate: 48_000,
        bits_per_sample: 16,
        sample_format: hound::SampleFormat::Int,
    };
    let mut writer = hound::WavWriter::create(folder.path("f.wav"), spec).unwrap();
    (0..2000).for_each(|sample| writer.write_sample(if sample == 1000 { 30_000i16 } else { 0 }).unwrap());
    writer.finalize().unwrap();
    assert_eq!(folder.malleus("play --kit kit.toml --direct f.wav --pad bar -o whole.wav").status.code(), Some(0));
    let whole = fs::read(folder.path("f.wav")).unwrap();
    // Lengths of the file and of its data as FFmpeg, SoX and others leave them open.
    for (file, data) in [(u32::MAX, u32::MAX), (0x7fff_f024, 0x7fff_f000), (0, 0), (u32::MAX, 0)] {
        let mut stream = whole.clone();
        stream[4..8].copy_from_slice(&file.to_le_bytes());
        stream[40..44].copy_from_slice(&data.to_le_bytes());
        // The pipe ended within a frame.
        stream.push(0);
        folder.write("stream.wav", &stream);
        let output = folder.malleus("play --kit kit.toml --direct stream.wav --pad bar -o out.wav");
        assert!(output.status.success(), "{file:x} {data:x}: {}", String::from_utf8_lossy(&output.stderr));
        assert_eq!(samples(&folder.path("out.wav")), samples(&folder.path("whole.wav")), "{file:x} {data:x}");
    }
    // A file that was cut is no stream.
    folder.write("cut.wav", &whole[..2000]);
    folder.refuses("play --kit kit.toml --direct cut.wav --pad bar -o no.wav", &["cut.wav", "not a readable WAV"]);
}

#[test]
fn demo_writes_sound_and_picture_or_neither_and_says_what_is_in_the_way() {
    let folder = Folder::new();
    folder.write("file", b"a file");
    folder.refuses("demo --out file", &["file: cannot be made: there is a file where a folder is needed"]);
    fs::create_dir_all(folder.path("taken/demo.png")).unwrap();
    folder.refuses("demo --out taken", &["demo.png: cannot be written"]);
    let left: Vec<_> = fs::read_dir(folder.path("taken")).unwrap().map(|entry| entry.unwrap().file_name()).collect();
    assert_eq!(left, ["demo.png"]);
}

#[test]
fn help_of_play_names_every_shipped_kit() {
    let help = String::from_utf8(Folder::new().malleus("play --help").stdout).unwrap();
    for name in kit::shipped_names() {
        assert!(help.contains(name), "{name}");
    }
}

#[test]
fn new_kit_goes_to_the_file_of_its_output_option_or_of_its_first_path() {
    let folder = Folder::new();
    folder.write("table.toml", KIT.split("[[pad]]").next().unwrap().as_bytes());
    for (words, file) in [
        ("kit new table.toml -o short.toml", "short.toml"),
        ("kit new --output long.toml table.toml", "long.toml"),
        ("kit new first.toml table.toml", "first.toml"),
    ] {
        let output = folder.malleus(words);
        assert!(output.status.success(), "{words}: {}", String::from_utf8_lossy(&output.stderr));
        let kit = fs::read_to_string(folder.path(file)).unwrap();
        assert!(kit.contains("[[pad]]\nname = \"bar\"\nobject = \"bar\""), "{words}: {kit}");
    }
    let output = folder.malleus("kit new table.toml");
    assert_eq!(output.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&output.stderr).contains("malleus kit new TABLE... -o KIT.toml"));
}

#[test]
fn new_kit_of_tables_with_equal_names_has_a_pad_for_each_and_a_name_that_fits() {
    let folder = Folder::new();
    let table = KIT.split("[[pad]]").next().unwrap();
    folder.write("one.toml", table.as_bytes()).write("two.toml", table.replace("5200.0", "5300.0").as_bytes());
    folder.write("three.toml", table.replace("peak_force = 1.0", "peak_force = 2.0").as_bytes());
    let output = folder.malleus("kit new one.toml two.toml three.toml -o marimba,and-a-vibraphone-kit.toml");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let loaded = kit::open(folder.path("marimba,and-a-vibraphone-kit.toml").to_str().unwrap()).unwrap();
    let strikers: Vec<_> = loaded.kit.pads.iter().map(|pad| (pad.object.as_str(), pad.strikers.join(","))).collect();
    let expected = [("bar", "stick"), ("bar 2", "stick"), ("bar 3", "stick 2")];
    assert_eq!(strikers, expected.map(|(object, striker)| (object, striker.to_owned())));
    assert_eq!((loaded.kit.name.as_str(), loaded.kit.strikers.len()), ("marimba-and-a-vibraphone", 2));
    folder.refuses("kit new one.toml two.toml --first-note 127 -o k.toml", &["--first-note 127", "lower first note"]);
}

#[test]
fn name_that_ends_in_bin_is_that_of_a_binary_kit_and_toml_that_of_text() {
    let folder = Folder::new();
    folder.write("table.toml", KIT.split("[[pad]]").next().unwrap().as_bytes());
    for words in ["kit new table.toml -o new.toml", "kit new table.toml -o new.BIN"] {
        let output = folder.malleus(words);
        assert!(output.status.success(), "{words}: {}", String::from_utf8_lossy(&output.stderr));
    }
    assert!(fs::read(folder.path("new.BIN")).unwrap().starts_with(b"MALL"));
    let [text, binary] = ["new.toml", "new.BIN"].map(|file| kit::open(folder.path(file).to_str().unwrap()).unwrap());
    assert_eq!((text.kit == binary.kit, text.kit.pads.len()), (true, 1));
    folder.refuses("kit build new.BIN -o built.toml", &["built.toml", "binary form", "name it .bin", "kit show"]);
    assert!(!folder.path("built.toml").exists());
}

#[test]
fn new_kit_of_surfaces_alone_is_refused_and_keeps_those_beside_objects() {
    let folder = Folder::new();
    // Heights of two waves, 256 points.
    let heights: Vec<String> = (0..256).map(|n| (100 * (n % 8) - 70 * (n % 64)).to_string()).collect();
    let surface = |unit_m: &str| {
        let head = "format = 1\nname = \"tile\"\n[[surface]]\nname = \"tile\"\nstep_m = 5e-6\nshortest_m = 2.5e-5\n";
        format!("{head}unit_m = {unit_m}\nheights = [{}]\n", heights.join(", "))
    };
    folder.write("tile.toml", surface("1e-9").as_bytes()).write("rough.toml", surface("2e-9").as_bytes());
    folder.refuses("kit new tile.toml -o new.toml", &["no table has an object", "malleus fit"]);
    assert!(!folder.path("new.toml").exists());

    let table = KIT.split("[[pad]]").next().unwrap();
    folder.write("bar.toml", table.as_bytes());
    let named = surface("2e-9") + &table[table.find("[[object]]").unwrap()..];
    folder.write(
        "own.toml",
        named.replace("name = \"bar\"", "name = \"own\"\nsurface = \"tile\"\nsize_m = [0.1, 0.1]").as_bytes(),
    );
    let output = folder.malleus("kit new bar.toml tile.toml rough.toml own.toml -o new.toml");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let kit = kit::open(folder.path("new.toml").to_str().unwrap()).unwrap().kit;
    let surfaces: Vec<_> = kit.surfaces.iter().map(|surface| (surface.name.as_str(), surface.unit_m)).collect();
    assert_eq!(surfaces, [("tile", 1e-9), ("tile 2", 2e-9)]);
    assert_eq!(kit.objects[1].surface.as_ref().map(|own| own.surface.as_str()), Some("tile 2"));
}
