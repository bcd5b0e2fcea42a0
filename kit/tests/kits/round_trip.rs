//! Kits come through text and binary unchanged, bit for bit.

use kit::{Acceleration, Gain, KitError, Mode, Pulse, binary, text};
use proptest::prelude::*;

use crate::{arbitrary, sample};

proptest! {
    #![proptest_config(ProptestConfig::with_cases(512))]

    #[test]
    fn every_valid_kit_goes_through_binary_and_text_unchanged(kit in arbitrary::kit()) {
        let bytes = binary::build(&kit)?;
        let read = binary::read(&bytes)?;
        prop_assert_eq!(&read, &kit);
        let written = text::write(&read);
        let parsed = sample::parse(&written)?;
        // Bytes are compared because they tell -0.0 from 0.0, which `==` does not.
        prop_assert_eq!(binary::build(&parsed)?, bytes);
        prop_assert_eq!(text::write(&parsed), written);
    }
}

#[test]
fn text_has_all_keys_and_is_read_back_unchanged() -> Result<(), KitError> {
    let mut kit = sample::kit();
    kit.objects.truncate(1);
    kit.strikers.truncate(1);
    kit.pads.truncate(1);
    kit.objects[0].source = "a \"marimba\",\n440 Hz \\ é".to_owned();
    kit.objects[0].modes.truncate(2);
    kit.objects[0].modes[1].gains = vec![Gain { sine: 1e-7, cosine: -0.0 }];
    kit.strikers[0].modes.clear();
    let written = text::write(&kit);
    assert_eq!(
        written,
        r#"format = 1
name = "test"

[[object]]
name = "bar"
source = "a \"marimba\",\n440 Hz \\ é"
licence = "CC0-1.0"
reference_force = 1.0
acceleration = 0.0
modes = [
    { frequency_hz = 110.0, decay_per_s = 2.0, gain_sine = 512.0, gain_cosine = -0.25 },
    { frequency_hz = 220.0, decay_per_s = 2.1, gain_sine = 1e-7, gain_cosine = -0.0 },
]

[[striker]]
name = "yarn"
source = ""
licence = ""
pulse = "hertz"
peak_force = 20.0
peak_exponent = 1.2
contact_time_s = 0.001
contact_exponent = -0.2
restitution = 0.45
modes = []

[[pad]]
name = "bar"
object = "bar"
strikers = ["yarn"]
level_db = -6.0
pan = 0.0
striker_weight = 1.0
choke_t60_s = 0.1
midi_notes = [60]
"#
    );
    assert_eq!(sample::parse(&written)?, kit);
    Ok(())
}

#[test]
fn missing_key_has_its_default() -> Result<(), KitError> {
    let kit = sample::parse(
        r#"
        format = 1
        name = "short"
        [[object]]
        name = "bar"
        modes = [ { frequency_hz = 220, decay_per_s = 3, gain_sine = 512 } ]
        [[striker]]
        name = "yarn"
        peak_force = 20
        contact_time_s = 1e-3
        [[pad]]
        name = "bar"
        object = "bar"
        strikers = ["yarn"]
        "#,
    )?;
    let object = &kit.objects[0];
    assert_eq!((object.source.as_str(), object.licence.as_str()), ("", ""));
    assert_eq!((object.reference_force, object.acceleration), (1.0, Acceleration::NONE));
    assert_eq!(
        object.modes,
        [Mode { frequency_hz: 220.0, decay_per_s: 3.0, gains: vec![Gain { sine: 512.0, cosine: 0.0 }] }]
    );
    let striker = &kit.strikers[0];
    assert_eq!(striker.pulse, Pulse::Hertz);
    assert_eq!((striker.peak_exponent, striker.contact_exponent), (1.2, -0.2));
    assert!(striker.modes.is_empty());
    let pad = &kit.pads[0];
    assert_eq!((pad.level_db, pad.pan, pad.striker_weight, pad.choke_t60_s), (0.0, 0.0, 1.0, 0.1));
    assert!(pad.midi_notes.is_empty());
    Ok(())
}

#[test]
fn missing_gain_is_zero_at_every_position() -> Result<(), KitError> {
    let kit = sample::parse(
        r#"
        format = 1
        [[object]]
        name = "bar"
        modes = [
            { frequency_hz = 100, decay_per_s = 1 },
            { frequency_hz = 220, decay_per_s = 3, gain_cosine = [1, 2.5] },
            { frequency_hz = 300, decay_per_s = 3, gain_sine = [-1, -2] },
        ]
        "#,
    )?;
    let gains: Vec<Vec<(f32, f32)>> = kit.objects[0]
        .modes
        .iter()
        .map(|mode| mode.gains.iter().map(|gain| (gain.sine, gain.cosine)).collect())
        .collect();
    assert_eq!(gains, [vec![(0.0, 0.0), (0.0, 0.0)], vec![(0.0, 1.0), (0.0, 2.5)], vec![(-1.0, 0.0), (-2.0, 0.0)]]);
    Ok(())
}

#[test]
fn table_file_needs_neither_name_nor_pads() -> Result<(), KitError> {
    let kit = sample::parse("format = 1\n")?;
    assert_eq!(kit.name, text::UNTITLED);
    assert!(kit.objects.is_empty() && kit.strikers.is_empty() && kit.pads.is_empty());
    Ok(())
}

#[test]
fn included_objects_and_strikers_come_first_and_in_order() -> Result<(), KitError> {
    let object = |name: &str| format!("[[object]]\nname = \"{name}\"\nmodes = []\n");
    let striker = |name: &str| format!("[[striker]]\nname = \"{name}\"\npeak_force = 1\ncontact_time_s = 0.001\n");
    let first = format!("format = 1\nname = \"ignored\"\n{}{}", object("b"), striker("s"));
    let second = format!("format = 1\n{}", object("a"));
    let main = format!(
        "format = 1\nname = \"main\"\ninclude = [\"first.toml\", \"second.toml\"]\n{}\
         [[pad]]\nname = \"p\"\nobject = \"a\"\nstrikers = [\"s\"]\n",
        object("c")
    );
    let kit = sample::parse_with(&main, &[("first.toml", &first), ("second.toml", &second)])?;
    assert_eq!(kit.name, "main");
    assert_eq!(kit.objects.iter().map(|object| object.name.as_str()).collect::<Vec<_>>(), ["b", "a", "c"]);
    assert_eq!(kit.strikers.len(), 1);
    assert_eq!(sample::parse(&text::write(&kit))?, kit, "written text needs no includes");
    Ok(())
}

#[test]
fn kit_of_512_modes_fits_24_kilobytes() -> Result<(), KitError> {
    let mut kit = sample::kit();
    kit.objects = vec![sample::object("bar", sample::bank(128, 1)), sample::object("string", sample::bank(384, 1))];
    kit.strikers.iter_mut().for_each(|striker| striker.modes.clear());
    let bytes = binary::build(&kit)?;
    assert!(bytes.len() <= 24 * 1024, "{} bytes", bytes.len());
    Ok(())
}

#[test]
fn kit_of_the_format_page_is_valid() -> Result<(), KitError> {
    let page = include_str!("../../../docs/kit-format.md");
    let example = page.split("```toml\n").nth(1).and_then(|rest| rest.split("```").next()).unwrap_or("");
    let kit = sample::parse(example)?;
    assert_eq!((kit.objects.len(), kit.strikers.len(), kit.pads.len()), (1, 1, 1));
    Ok(())
}
