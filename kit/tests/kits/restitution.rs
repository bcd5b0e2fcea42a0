//! Restitution of strikers in text and bytes.

use dsp_core::table::layout::tag;
use dsp_core::table::{self, TableError};
use kit::{Kit, KitError, Pulse, Striker, binary, text};

use crate::binary_refusals::has_section;
use crate::sample;

const TEXT: &str = r#"format = 1
name = "test"

[[striker]]
name = "yarn"
peak_force = 20.0
contact_time_s = 0.001

[[striker]]
name = "steel"
peak_force = 20.0
contact_time_s = 0.001
restitution = 0.8

[[striker]]
name = "finger"
pulse = "gaussian"
peak_force = 20.0
contact_time_s = 0.001
"#;

fn kit() -> Kit {
    sample::parse(TEXT).expect("a right text")
}

fn refusal(from: &str, to: &str) -> String {
    assert_eq!(TEXT.matches(from).count(), 1, "{from:?} stands there once");
    sample::parse(&TEXT.replace(from, to)).expect_err("a wrong text").to_string()
}

#[test]
fn restitution_comes_through_text_and_bytes_unchanged() {
    let kit = kit();
    let restitutions: Vec<f32> = kit.strikers.iter().map(|striker| striker.restitution).collect();
    assert_eq!(restitutions, [Striker::DEFAULT_RESTITUTION, 0.8, Striker::DEFAULT_RESTITUTION]);
    assert_eq!(sample::parse(&text::write(&kit)).expect("its own text"), kit);
    let bytes = binary::build(&kit).expect("a right kit");
    assert_eq!(binary::read(&bytes).expect("its own bytes"), kit);
}

#[test]
fn kit_of_default_restitutions_has_no_section_for_them() {
    let mut kit = kit();
    let with = binary::build(&kit).expect("a right kit");
    table::Kit::parse(&with).expect("its own bytes");
    assert!(has_section(&with, tag::RESTITUTION));
    kit.strikers[1].restitution = Striker::DEFAULT_RESTITUTION;
    let without = binary::build(&kit).expect("a right kit");
    let view = table::Kit::parse(&without).expect("its own bytes");
    assert!(!has_section(&without, tag::RESTITUTION));
    assert!(view.strikers().all(|striker| striker.contact().restitution() == Striker::DEFAULT_RESTITUTION));
    // A line of the directory takes 16 bytes, and three numbers take 12.
    assert_eq!(with.len(), without.len() + 16 + 12);
}

#[test]
fn invalid_restitutions_are_refused_with_their_place() {
    assert_eq!(
        refusal("restitution = 0.8", "restitution = 0.05"),
        "test.toml:9:1: striker 1 \"steel\": restitution = 0.05: must be from 0.1 to 1"
    );
    assert_eq!(
        refusal("restitution = 0.8", "restitution = nan"),
        "test.toml:9:1: striker 1 \"steel\": restitution = NaN: must be from 0.1 to 1"
    );
    assert_eq!(
        refusal("pulse = \"gaussian\"", "pulse = \"gaussian\"\nrestitution = 0.5"),
        "test.toml:15:1: striker 2 \"finger\": restitution = 0.5: a gaussian pulse has none; leave the key out, or take \
         pulse = \"hertz\""
    );
}

#[test]
fn kit_with_a_restitution_of_a_gaussian_is_refused_as_text_too() {
    let mut kit = kit();
    assert_eq!(kit.strikers[2].pulse, Pulse::Gaussian);
    kit.strikers[2].restitution = 0.5;
    assert!(binary::build(&kit).is_err());
    assert!(sample::parse(&text::write(&kit)).is_err(), "nothing wrong is lost on the way through text");
}

#[test]
fn restitution_section_for_another_number_of_strikers_is_refused() {
    let bytes = binary::build(&kit()).expect("a right kit");
    // The body lies behind the header's 16 bytes, and its last section is `rest`.
    let mut body = bytes[16..bytes.len() - 4].to_vec();
    let sections = u32::from_le_bytes([body[0], body[1], body[2], body[3]]) as usize;
    let length = 4 + 16 * (sections - 1) + 12;
    body[length] -= 4;
    let error = binary::read(&crate::binary_refusals::signed(&body)).expect_err("a striker too few");
    assert!(
        matches!(error, KitError::Binary { error: TableError::LengthMismatch { expected: 12, found: 8, .. }, .. }),
        "{error}"
    );
}
