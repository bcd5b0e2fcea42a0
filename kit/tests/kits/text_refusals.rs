//! Invalid texts are refused with file, line and the values that are allowed.

use kit::{KitError, binary};
use proptest::prelude::*;

use crate::sample;

const TEXT: &str = r#"format = 1
name = "test"

[[object]]
name = "bar"
modes = [
    { frequency_hz = 220.0, decay_per_s = 3.2, gain_sine = 512.0 },
    { frequency_hz = 330.0, decay_per_s = 3.2, gain_sine = 512.0 },
]

[[striker]]
name = "yarn"
peak_force = 20.0
contact_time_s = 0.001

[[pad]]
name = "bar"
object = "bar"
strikers = ["yarn"]
midi_notes = [60]
"#;

/// Refusal of the text after one part of it is replaced.
fn refusal(from: &str, to: &str) -> String {
    assert_eq!(TEXT.matches(from).count(), 1, "{from:?} stands there once");
    sample::parse(&TEXT.replace(from, to)).expect_err("a wrong text").to_string()
}

#[test]
fn text_of_these_tests_is_valid_before_it_is_changed() {
    assert!(sample::parse(TEXT).is_ok());
}

#[test]
fn unknown_key_is_refused_with_its_line_and_the_known_ones() {
    let message = refusal("peak_force = 20.0", "peak_forse = 20.0");
    assert!(message.starts_with("test.toml:13:1: unknown key `peak_forse`: must be one of `name`"), "{message}");
    let message = refusal("frequency_hz = 330.0", "frequency = 330.0");
    assert!(message.starts_with("test.toml:8:7: unknown key `frequency`"), "{message}");
    let message = refusal("name = \"test\"", "nam = \"test\"");
    assert!(message.starts_with("test.toml:2:1: unknown key `nam`"), "{message}");
    let message = refusal("midi_notes", "midi");
    assert!(message.starts_with("test.toml:20:1: unknown key `midi`"), "{message}");
    let message = refusal("[[pad]]", "[[pads]]");
    assert!(message.starts_with("test.toml:16:3: unknown key `pads`"), "{message}");
}

#[test]
fn missing_key_is_refused_with_the_line_of_its_table() {
    let message = refusal("peak_force = 20.0\n", "");
    assert_eq!(message, "test.toml:11:1: the key `peak_force` is missing; add it");
    let message = refusal("frequency_hz = 330.0, ", "");
    assert_eq!(message, "test.toml:8:5: the key `frequency_hz` is missing; add it");
    let message = refusal("format = 1\n", "");
    assert_eq!(message, "test.toml:1:1: the key `format` is missing; add it");
}

#[test]
fn value_of_a_wrong_type_is_refused_with_its_line() {
    let message = refusal("peak_force = 20.0", "peak_force = \"20\"");
    assert_eq!(message, "test.toml:13:14: string \"20\": must be a number");
    let message = refusal("strikers = [\"yarn\"]", "strikers = \"yarn\"");
    assert_eq!(message, "test.toml:19:12: string \"yarn\": must be an array");
    let message = refusal("330.0, decay_per_s = 3.2, gain_sine = 512.0", "330.0, decay_per_s = 3.2, gain_sine = true");
    assert!(message.starts_with("test.toml:8:60: boolean `true`: must be a number, or an"), "{message}");
}

#[test]
fn number_beyond_all_floats_is_refused_as_too_large() {
    let message = refusal("330.0, decay_per_s = 3.2, gain_sine = 512.0", "330.0, decay_per_s = 3.2, gain_sine = 1e309");
    assert!(message.starts_with("test.toml:8:60: this number is too large for any key"), "{message}");
}

#[test]
fn text_that_is_not_toml_is_refused_with_its_line() {
    let message = refusal("[[pad]]", "[[pad]");
    assert!(message.starts_with("test.toml:16:") && message.contains("this is not TOML; check"), "{message}");
    let message = refusal("name = \"yarn\"", "name = \"yarn");
    assert!(message.starts_with("test.toml:12:"), "{message}");
    assert!(!message.contains('\n'), "{message}");
}

#[test]
fn key_that_is_there_twice_is_refused() {
    let message = refusal("peak_force = 20.0", "peak_force = 20.0\npeak_force = 21.0");
    assert_eq!(message, "test.toml:14:1: this key is there twice; keep one of the two");
}

#[test]
fn number_that_its_type_cannot_hold_is_refused_with_the_range() {
    let message = refusal("midi_notes = [60]", "trigger = { channel = 256 }");
    assert_eq!(message, "test.toml:20:23: integer `256`: must be a whole number from 0 to 255");
}

#[test]
fn unknown_pulse_is_refused_with_the_known_ones() {
    let message = refusal("peak_force = 20.0", "peak_force = 20.0\npulse = \"square\"");
    assert_eq!(message, "test.toml:14:9: pulse = \"square\": must be \"hertz\" or \"gaussian\"");
}

#[test]
fn newer_format_is_refused_before_its_keys_are() {
    let message = sample::parse("name = \"x\"\nnew_key = 1\nformat = 2\n").expect_err("newer").to_string();
    assert!(message.starts_with("test.toml:3:10: format = 2: this program knows format 1"), "{message}");
}

#[test]
fn number_outside_its_range_is_refused_with_its_line_and_item() {
    let message = refusal("frequency_hz = 330.0", "frequency_hz = 0");
    assert_eq!(message, "test.toml:8:5: object 0 \"bar\", mode 1: frequency_hz = 0: must be from 0.1 to 1000000");
    let message = refusal("contact_time_s = 0.001", "contact_time_s = 1.0");
    assert_eq!(message, "test.toml:11:1: striker 0 \"yarn\": contact_time_s = 1: must be from 0.00002 to 0.1");
    let message = refusal("midi_notes = [60]", "choke_t60_s = 1e-4");
    assert_eq!(message, "test.toml:16:1: pad 0 \"bar\": choke_t60_s = 0.0001: must be from 0.001 to 100");
}

#[test]
fn number_that_an_f32_cannot_hold_is_refused() {
    for (number, shown) in [("1e40", "inf"), ("-1e40", "-inf"), ("inf", "inf"), ("nan", "NaN")] {
        let message = refusal("330.0, decay_per_s = 3.2", &format!("330.0, decay_per_s = {number}"));
        assert!(message.contains(&format!("mode 1: decay_per_s = {shown}: must be from")), "{message}");
    }
    let message = refusal("330.0, decay_per_s = 3.2, gain_sine = 512.0", "330.0, decay_per_s = 3, gain_sine = 1e40");
    assert!(message.contains("gain_sine = inf"), "{message}");
}

#[test]
fn unknown_name_is_refused_with_the_known_ones() {
    let message = refusal("strikers = [\"yarn\"]", "strikers = [\"yarn\", \"yran\"]");
    assert_eq!(
        message,
        "test.toml:16:1: pad 0 \"bar\": strikers names \"yran\": there is no such striker (did you mean \"yarn\"?); strikers: \"yarn\""
    );
}

#[test]
fn name_that_no_kit_may_have_is_refused_before_it_is_suggested() {
    let message = sample::parse(&TEXT.replacen("name = \"bar\"", "name = \"bär\"", 1)).expect_err("wrong").to_string();
    assert!(message.contains("object 0 \"bär\": name must be 1 to 24 printable ASCII characters"), "{message}");
}

#[test]
fn name_that_is_given_twice_is_refused_with_both_places() {
    let again = "\n[[object]]\nname = \"bar\"\nmodes = []\n";
    let message = sample::parse(&format!("{TEXT}{again}")).expect_err("twice").to_string();
    assert_eq!(
        message,
        "test.toml:23:8: object \"bar\": there is one of that name at test.toml:5:8; give each its own"
    );
    let included = format!("format = 1\n{again}");
    let main = TEXT.replace("name = \"test\"", "name = \"test\"\ninclude = [\"bar.toml\"]");
    let message = sample::parse_with(&main, &[("bar.toml", &included)]).expect_err("twice").to_string();
    assert!(
        message.starts_with("test.toml:6:8: object \"bar\": there is one of that name at bar.toml:4:8"),
        "{message}"
    );
}

#[test]
fn gains_of_unequal_lengths_are_refused_with_their_line() {
    let mode = "330.0, decay_per_s = 3.2, gain_sine = 512.0";
    let message = refusal(mode, "330.0, decay_per_s = 3.2, gain_sine = [512.0, 1.0]");
    assert_eq!(
        message,
        "test.toml:8:5: object 0 \"bar\", mode 1: 2 gains: must be 1, as many as the object's first mode has"
    );
    let message = refusal(mode, "330.0, decay_per_s = 3.2, gain_sine = [1.0, 2.0], gain_cosine = 1.0");
    assert_eq!(message, "test.toml:8:5: object 0 \"bar\", mode 1: 1 gain: must be 2, as many gain_cosine as gain_sine");
    let message = refusal(
        "contact_time_s = 0.001",
        "contact_time_s = 0.001\nmodes = [{ frequency_hz = 1, decay_per_s = 1, gain_sine = [1, 2] }]",
    );
    assert!(message.contains("striker 0 \"yarn\", mode 0: 2 gains: must be 1"), "{message}");
}

#[test]
fn midi_note_outside_0_to_127_is_refused() {
    for note in ["-1", "128", "255", "300"] {
        let message = refusal("[60]", &format!("[60, {note}]"));
        assert!(
            message.starts_with(&format!("test.toml:16:1: pad 0 \"bar\": midi_notes has {note}: notes are 0 to 127")),
            "{message}"
        );
    }
}

#[test]
fn kit_with_pads_and_no_name_is_refused() {
    assert!(refusal("name = \"test\"\n", "").starts_with("test.toml: a kit with pads must have a name"));
}

#[test]
fn invalid_kit_name_is_refused_with_its_line() {
    let message = refusal("name = \"test\"", "name = \"test, again\"");
    assert!(message.starts_with("test.toml:2:8: kit \"test, again\": name must be"), "{message}");
}

#[test]
fn included_file_that_includes_files_or_has_pads_is_refused() {
    let main = "format = 1\ninclude = [\"a.toml\"]\n";
    let nested = "format = 1\ninclude = [\"b.toml\"]\n";
    let message = sample::parse_with(main, &[("a.toml", nested)]).expect_err("nested").to_string();
    assert!(message.starts_with("a.toml:2:12: include: this file is itself included by test.toml"), "{message}");
    assert!(message.contains("\"b.toml\""), "{message}");
    let pads = TEXT.replace("name = \"test\"\n", "");
    let message = sample::parse_with(main, &[("a.toml", &pads)]).expect_err("pads").to_string();
    assert!(message.starts_with("a.toml:15:1: pad: this file is included by test.toml"), "{message}");
}

#[test]
fn refusal_of_an_included_file_names_that_file() {
    let main = "format = 1\ninclude = [\"a.toml\", \"gone.toml\"]\n";
    let table = "format = 1\n[[object]]\nname = \"bar\"\nmodes = [\n{ frequency_hz = 1, decay_per_s = 0 } ]\n";
    let message = sample::parse_with(main, &[("a.toml", table), ("gone.toml", "format = 1")]).expect_err("range");
    assert_eq!(
        message.to_string(),
        "a.toml:5:1: object 0 \"bar\", mode 0: decay_per_s = 0: must be from 0.01 to 20000"
    );
    let message = sample::parse_with(main, &[("a.toml", table)]).expect_err("gone").to_string();
    assert!(message.starts_with("test.toml:2:22: include: gone.toml: cannot be read: "), "{message}");
}

proptest! {
    /// A damaged text that can still be parsed is a kit that can be built.
    #[test]
    fn damaged_text_never_panics(at in any::<prop::sample::Index>(), cut in 0..12usize, put in "[\\[\\]{}=\"',.#0-9a-z_é\n -]{0,6}") {
        let start = at.index(TEXT.len());
        let end = (start + cut).min(TEXT.len());
        let damaged = format!("{}{put}{}", &TEXT[..start], &TEXT[end..]);
        match sample::parse(&damaged) {
            Ok(kit) => prop_assert!(binary::build(&kit).is_ok()),
            Err(error) => prop_assert!(error.to_string().starts_with("test.toml:"), "{}", error),
        }
    }
}

#[test]
fn error_of_a_kit_takes_at_most_128_bytes() {
    assert!(size_of::<KitError>() <= 128, "{} bytes", size_of::<KitError>());
}
