//! The derived acceleration sound, `acceleration = "balance"`, in text and bytes.

use dsp_core::table::layout::tag;
use dsp_core::table::{Field, Kit as TableView, Place, TableError};
use kit::{Acceleration, KitError, binary};
use zerocopy::FromBytes;
use zerocopy::byteorder::little_endian::U16;

use crate::binary_refusals::{has_section, section_of, signed};
use crate::sample;

const TEXT: &str = r#"format = 1
name = "test"

[[object]]
name = "plain"
acceleration = 0.25
modes = []

[[object]]
name = "bar"
acceleration = "balance"
modes = [
    { frequency_hz = 440.0, decay_per_s = 4.0, gain_sine = [300.0, 100.0], gain_cosine = [-50.0, 0.0] },
    { frequency_hz = 1900.0, decay_per_s = 30.0, gain_sine = [500.0, 0.0] },
]

[[object]]
name = "rod"
acceleration = "balance"
modes = []

[[striker]]
name = "yarn"
peak_force = 20.0
contact_time_s = 0.001

[[pad]]
name = "bar"
object = "bar"
strikers = ["yarn"]
"#;

#[test]
fn balance_comes_through_text_and_bytes_unchanged() {
    let kit = sample::parse(TEXT).expect("a right text");
    let found: Vec<_> = kit.objects.iter().map(|object| object.acceleration).collect();
    assert_eq!(found, [Acceleration::Factor(0.25), Acceleration::Balance, Acceleration::Balance]);
    let text = kit::text::write(&kit);
    assert_eq!(text.matches("acceleration = \"balance\"").count(), 2);
    assert_eq!(sample::parse(&text).expect("its own text"), kit);
    let bytes = binary::build(&kit).expect("a right kit");
    assert_eq!(binary::read(&bytes).expect("its own bytes"), kit);
    assert_eq!(binary::build(&binary::read(&bytes).expect("its own bytes")).expect("the same kit"), bytes);
}

#[test]
fn reader_without_the_section_finds_the_factor_of_48_khz_at_the_first_position() {
    let bytes = binary::build(&sample::parse(TEXT).expect("a right text")).expect("a right kit");
    let view = TableView::parse(&bytes).expect("a right kit");
    let object = view.objects().nth(1).expect("the bar");
    // The formula of docs/kit-format.md at 48 kHz: Σ r^n sin nθ = r sin θ / |1-p|², and so on.
    let expected = [(440.0f64, 4.0f64, 300.0, -50.0), (1900.0, 30.0, 500.0, 0.0)].map(|(f, d, sine, cosine)| {
        let (r, angle) = ((-d / 48_000.0).exp(), std::f64::consts::TAU * f / 48_000.0);
        let distance = 1.0 - 2.0 * r * angle.cos() + r * r;
        (sine * r * angle.sin() + cosine * (1.0 - r * angle.cos())) / distance - cosine / 2.0
    });
    let expected = -(expected[0] + expected[1]) / 48_000.0;
    assert!((f64::from(object.acceleration()) / expected - 1.0).abs() < 1e-5, "{}", object.acceleration());
    assert_eq!([0, 1, 2, 3].map(|index| view.is_balanced(index)), [false, true, true, false]);
}

#[test]
fn kit_without_balance_has_no_section_for_it() {
    let text = TEXT.replace("\"balance\"", "0.5");
    let bytes = binary::build(&sample::parse(&text).expect("a right text")).expect("a right kit");
    TableView::parse(&bytes).expect("a right kit");
    assert!(!has_section(&bytes, tag::BALANCE));
}

#[test]
fn other_words_and_types_of_an_acceleration_are_refused_with_their_line() {
    let refusal = |value: &str| {
        let text = TEXT.replacen("\"balance\"", value, 1);
        sample::parse(&text).expect_err("a wrong text").to_string()
    };
    assert_eq!(
        refusal("\"balanced\""),
        "test.toml:11:16: acceleration = \"balanced\": must be a number or \"balance\""
    );
    let message = refusal("[1.0]");
    assert!(
        message.starts_with("test.toml:11:16: ") && message.ends_with("an array: must be a number or \"balance\""),
        "{message}"
    );
}

/// Refusal of the bytes after a change of the section's numbers: a count, and the index of each
/// object.
fn foreign(change: impl FnOnce(&mut [U16])) -> TableError {
    let bytes = binary::build(&sample::parse(TEXT).expect("a right text")).expect("a right kit");
    let (mut body, range) = section_of(&bytes, tag::BALANCE);
    change(<[U16]>::mut_from_bytes(&mut body[range]).expect("whole numbers"));
    match binary::read(&signed(&body)).expect_err("wrong bytes") {
        KitError::Binary { error, .. } => error,
        other => panic!("{other}"),
    }
}

#[test]
fn foreign_bytes_of_the_balance_section_are_refused_by_name() {
    // The section holds the count 2, the indices 1 and 2, and two bytes of zeros.
    assert!(matches!(foreign(|body| body[0].set(0)), TableError::Count { field: Field::Acceleration, value: 0, .. }));
    assert!(matches!(foreign(|body| body[0].set(4)), TableError::LengthMismatch { expected: 12, found: 8, .. }));
    assert!(matches!(foreign(|body| body[2].set(3)), TableError::Dangling { index: 3, count: 3, .. }));
    assert!(matches!(foreign(|body| body[2].set(1)), TableError::Count { field: Field::Object, value: 1, min: 2, .. }));
    assert_eq!(foreign(|body| body[3].set(1)), TableError::NotZero { place: Place::Kit, field: Field::Padding });
}
