//! The room in text: an invalid one is refused with its place.

use crate::sample;

const TEXT: &str = r#"format = 1
name = "test"

[[room]]
from_hz = 0
gain = 1.5
decay_per_s = 5.0

[[room]]
from_hz = 2000
gain = 0.5
decay_per_s = 14.25

[[object]]
name = "bar"
modes = []
"#;

fn refusal(from: &str, to: &str) -> String {
    assert_eq!(TEXT.matches(from).count(), 1, "{from:?} stands there once");
    sample::parse(&TEXT.replace(from, to)).expect_err("a wrong text").to_string()
}

#[test]
fn room_comes_through_text_and_bytes_unchanged() {
    let kit = sample::parse(TEXT).expect("a right text");
    assert_eq!(kit.room[1], kit::RoomBand { from_hz: 2_000.0, gain: 0.5, decay_per_s: 14.25 });
    assert_eq!(sample::parse(&kit::text::write(&kit)).expect("its own text"), kit);
    let bytes = kit::binary::build(&kit).expect("a right kit");
    assert_eq!(kit::binary::read(&bytes).expect("its own bytes"), kit);
}

#[test]
fn band_made_of_t60_and_energy_has_this_t60_and_energy() {
    let band = kit::RoomBand::new(500.0, 1.2, -9.0);
    assert!((band.t60_s() - 1.2).abs() < 1e-6 && (band.energy_db() + 9.0).abs() < 1e-5);
}

#[test]
fn bands_out_of_order_or_range_are_refused_with_their_place() {
    assert_eq!(
        refusal("from_hz = 0\n", "from_hz = 20\n"),
        "test.toml:4:1: room, band 0: from_hz = 20: must be from 0 to 0"
    );
    assert_eq!(
        refusal("from_hz = 2000", "from_hz = 0.5"),
        "test.toml:9:1: room, band 1: from_hz = 0.5: must be from 1 to 96000"
    );
    assert_eq!(refusal("gain = 1.5", "gain = -1.5"), "test.toml:4:1: room, band 0: gain = -1.5: must be from 0 to 100");
    assert_eq!(
        refusal("decay_per_s = 14.25", "decay_per_s = 0.1"),
        "test.toml:9:1: room, band 1: decay_per_s = 0.1: must be from 0.3 to 150"
    );
    let third = "[[room]]\nfrom_hz = 1500\ngain = 0.5\ndecay_per_s = 5.0\n\n[[object]]";
    assert_eq!(
        refusal("[[object]]", third),
        "test.toml:14:1: room, band 2: from_hz = 1500: must be at least 1 Hz above the edge before it, 2000"
    );
    assert!(refusal("decay_per_s = 5.0", "decay = 5.0").contains("decay"));
}

#[test]
fn room_of_more_than_8_bands_is_refused() {
    let bands: String =
        (3..12).map(|band| format!("[[room]]\nfrom_hz = {band}000\ngain = 0.5\ndecay_per_s = 5.0\n")).collect();
    let message = refusal("[[object]]", &format!("{bands}[[object]]"));
    assert_eq!(message, "test.toml:4:1: room: from_hz = 11: must be from 1 to 8");
}

#[test]
fn room_of_an_included_file_is_left_out() {
    let main = "format = 1\ninclude = [\"bar.toml\"]\n";
    assert!(sample::parse_with(main, &[("bar.toml", TEXT)]).expect("right texts").room.is_empty());
    let own = "format = 1\ninclude = [\"bar.toml\"]\n\n[[room]]\nfrom_hz = 0\ngain = 0.25\ndecay_per_s = 3.0\n";
    let room = sample::parse_with(own, &[("bar.toml", TEXT)]).expect("right texts").room;
    assert_eq!(room, [kit::RoomBand { from_hz: 0.0, gain: 0.25, decay_per_s: 3.0 }]);
}
