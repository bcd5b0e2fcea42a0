//! Inputs that are refused, with a message that names the file and says what is expected.

use std::fs;

use crate::folder::{Folder, KIT, midi};

#[test]
fn wrong_events_are_refused_with_line_field_value_and_what_is_allowed() {
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
    folder.refuses_strikes("sample,pad,velocity\n9007199254740000,bar,1\n", &["strikes.csv", "at most 3600"]);
    folder.refuses_strikes("sample,pad,velocity\n0,bar\n", &["line 2", "fields is 2", "has 3"]);
    folder
        .refuses("play --kit kit.toml --strikes none.csv -o out.wav", &["malleus: none.csv: cannot be read", "check"]);
}

#[test]
fn commands_refuse_to_write_over_what_they_read() {
    let folder = Folder::new();
    folder.write("s.csv", b"sample,pad,velocity\n0,bar,1\n");
    let before = [fs::read(folder.path("kit.toml")).unwrap(), fs::read(folder.path("s.csv")).unwrap()];
    for (words, file) in [
        ("play --kit kit.toml --strikes s.csv -o s.csv", "s.csv"),
        ("play --kit kit.toml --strikes s.csv -o kit.toml", "kit.toml"),
        ("play --kit kit.toml --strikes s.csv -o ./s.csv", "s.csv"),
        ("play --kit kit.toml --strikes s.csv --log s.csv -o out.wav", "s.csv"),
        ("kit build kit.toml -o kit.toml", "kit.toml"),
        ("kit show kit.toml --plot kit.toml", "kit.toml"),
        ("kit new kit.toml -o kit.toml", "kit.toml"),
    ] {
        folder.refuses(words, &[file, "is read by this command"]);
    }
    folder.refuses("kit new kit.toml kit.toml", &["kit.toml", "exists already", "-o"]);
    assert_eq!(before, [fs::read(folder.path("kit.toml")).unwrap(), fs::read(folder.path("s.csv")).unwrap()]);
    assert!(!folder.path("out.wav").exists());
}

#[test]
fn events_that_are_not_text_are_refused_in_one_sentence() {
    let folder = Folder::new();
    let utf_16: Vec<u8> = "sample,pad,velocity\n0,bar,1\n".encode_utf16().flat_map(u16::to_le_bytes).collect();
    let cases: [(&[u8], usize); 5] = [
        (b"RIFF\x24\xF0\0\0WAVEfmt ", 5),
        (b"sample,pad,velocity\n0,b\xE4r,1\n", 23),
        (b"sample,pad,velocity\n0,bar,1\n\0", 28),
        (&[0; 64], 0),
        (&utf_16, 1),
    ];
    for (bytes, offset) in cases {
        folder.write("strikes.csv", bytes);
        let output = folder.malleus("play --kit kit.toml --strikes strikes.csv -o out.wav");
        let expected = format!(
            "malleus: strikes.csv: not text in UTF-8 (byte {offset} is not); give events as CSV, such as \
             time_s,pad,velocity, or as a Standard MIDI File\n"
        );
        assert_eq!(String::from_utf8_lossy(&output.stderr), expected);
        assert_eq!(output.status.code(), Some(1));
        assert!(!folder.path("out.wav").exists());
    }
}

#[test]
fn kits_and_tables_that_are_not_text_are_refused_in_one_sentence() {
    let folder = Folder::new();
    folder.write("kit.toml", b"format = 1\nname = \"b\xE4r\"\n").write("s.csv", b"sample,pad,velocity\n0,bar,1\n");
    for words in
        ["play --kit kit.toml --strikes s.csv -o out.wav", "kit check kit.toml", "kit new kit.toml -o new.toml"]
    {
        let output = folder.malleus(words);
        let message = String::from_utf8_lossy(&output.stderr);
        let expected = "malleus: kit.toml: not text in UTF-8 (byte 20 is not); give a kit as text (.toml), or as a binary \
                        kit, which begins with \"MALL\" (.bin)\n";
        assert_eq!(message, expected, "{words}");
        assert_eq!(output.status.code(), Some(1), "{words}");
    }
}

#[test]
fn damaged_midi_file_is_refused_in_one_sentence() {
    let folder = Folder::new();
    let whole = midi(&[0, 0x99, 60, 127, 0x60, 0x99, 60, 64, 0, 0x89, 60, 0]);
    for length in 1..whole.len() {
        folder.write("cut.mid", &whole[..length]);
        let expected =
            "malleus: cut.mid: not a whole Standard MIDI File: it is damaged, cut off or of another format; ";
        folder.refuses("play --kit kit.toml --strikes cut.mid -o out.wav", &[expected]);
    }
    folder.write("other.mid", &midi(&[0, 0x99, 35, 127]));
    folder.refuses("play --kit kit.toml --strikes other.mid -o out.wav", &["midi_notes", "60 (bar)"]);
}

#[test]
fn damaged_kits_are_refused_with_file_and_fault() {
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
fn wrong_command_line_exits_with_2() {
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
fn options_of_another_way_to_play_or_fit_are_refused_by_name() {
    let folder = Folder::new();
    folder.write("s.csv", b"sample,pad,velocity\n0,bar,1\n");
    for (words, option) in [
        ("play --kit kit.toml --strikes s.csv --pad bar -o out.wav", "--pad"),
        ("play --kit kit.toml --direct f.wav --pad bar --force out.wav -o sound.wav", "--force"),
        ("play --kit kit.toml --direct f.wav --pad bar --without scraper -o out.wav", "--without"),
        ("fit hit.wav -o hit.toml --hits 1 --positions 4", "--positions"),
        ("fit hit.wav -o hit.toml --render out.wav --strikers 2", "--strikers"),
    ] {
        let output = folder.malleus(words);
        let message = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{words}: {message}");
        assert!(message.contains(option) && message.contains("cannot be used with"), "{words}: {message}");
    }
}
