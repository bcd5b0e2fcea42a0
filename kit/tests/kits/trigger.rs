//! Trigger settings of pads: the table `[pad.trigger]` and the section `trig`.

use dsp_core::table::Kit as TableView;
use dsp_core::trigger::{Mode, Settings};
use kit::{Kit, Pad, binary, text};

use crate::sample;

fn with_trigger(keys: &str) -> String {
    let text = text::write(&sample::kit());
    // The sample's second pad is the last table of its text.
    format!("{text}\n[pad.trigger]\n{keys}\n")
}

fn refusal(keys: &str) -> String {
    let loaded = sample::parse(&with_trigger(keys)).and_then(|kit| binary::build(&kit));
    loaded.expect_err("a wrong table").to_string()
}

fn settings(kit: &Kit) -> Vec<Settings> {
    let bytes = binary::build(kit).expect("a valid kit");
    let view = TableView::parse(&bytes).expect("what was built");
    Settings::of_kit(&view).collect()
}

#[test]
fn kit_without_trigger_tables_has_no_section_and_gives_every_pad_its_defaults() {
    let bytes = binary::build(&sample::kit()).expect("a valid kit");
    assert!(!bytes.windows(4).any(|tag| tag == b"trig"));
    assert_eq!(settings(&sample::kit()), [Settings::of_unset_pad(0), Settings::of_unset_pad(1)]);
}

#[test]
fn missing_trigger_key_has_its_default_and_pads_without_a_table_are_off() {
    let kit = sample::parse(&with_trigger("mode = \"direct\"\nchannel = 3\nthreshold = 0.01")).expect("a valid text");
    let [first, second] = settings(&kit)[..] else { panic!("two pads") };
    assert_eq!((first.mode, first.button), (Mode::Off, None));
    let usual = Settings::of_unset_pad(1);
    assert_eq!(second, Settings { mode: Mode::Direct, channel: 3, threshold: 0.01, button: None, ..usual });
}

#[test]
fn invalid_trigger_table_is_refused_with_its_key_and_what_is_allowed() {
    for (keys, expected) in [
        ("chanel = 1", "unknown key `chanel`"),
        ("mode = \"loud\"", "mode = \"loud\": must be one of \"velocity\", \"direct\", \"off\""),
        ("channel = 16", "channel = 16: must be from 0 to 15"),
        ("rim_channel = 255", "rim_channel = 255: must be from 0 to 15"),
        ("rim_channel = 1\nrim_striker = 0", "rim_channel = 1: another sensor or pad has that input already"),
        ("rim_channel = 2\nrim_striker = 1", "rim_striker = 1: must be from 0 to 0"),
        ("threshold = 0.0", "threshold = 0: must be from 0.001 to 0.5"),
        ("scan_time_s = nan", "scan_time_s = NaN: must be from 0.001 to 0.01"),
        ("crosstalk_db = 3.0", "crosstalk_db = 3: must be from -60 to 0"),
    ] {
        let message = refusal(keys);
        assert!(message.contains(expected), "{keys}: {message}");
        assert!(message.starts_with("test.toml") || message.contains("pad 1 \"string\""), "{message}");
    }
}

#[test]
fn two_pads_on_one_channel_are_refused() {
    let mut kit = sample::kit();
    for pad in &mut kit.pads {
        *pad = Pad { trigger: Some(Settings { button: None, ..Settings::of_unset_pad(0) }), ..pad.clone() };
    }
    let message = binary::build(&kit).expect_err("two pads on channel 0").to_string();
    assert!(message.contains("pad 1 \"string\": channel = 0: another sensor or pad"), "{message}");
}
