//! A small kit for tests to change, and functions that read text without files.

use std::io;
use std::path::Path;

use kit::file::FileError;
use kit::text::SourceText;
use kit::{Acceleration, Gain, Kit, KitError, Mode, Object, Pad, Pulse, Striker};

/// Modes with gains at a number of positions.
pub(crate) fn bank(modes: usize, positions: usize) -> Vec<Mode> {
    (0..modes)
        .map(|index| Mode {
            frequency_hz: 110.0 * (index + 1) as f32,
            decay_per_s: 2.0 + 0.1 * index as f32,
            gains: vec![Gain { sine: 512.0 / (index + 1) as f32, cosine: -0.25 }; positions],
        })
        .collect()
}

pub(crate) fn object(name: &str, modes: Vec<Mode>) -> Object {
    Object {
        name: name.to_owned(),
        source: "made for this test".to_owned(),
        licence: "CC0-1.0".to_owned(),
        reference_force: 1.0,
        acceleration: Acceleration::NONE,
        modes,
        residual: None,
        dynamic_filter: None,
        biquads: None,
        surface: None,
    }
}

pub(crate) fn striker(name: &str) -> Striker {
    Striker {
        name: name.to_owned(),
        source: String::new(),
        licence: String::new(),
        pulse: Pulse::Hertz,
        peak_force: 20.0,
        peak_exponent: 1.2,
        contact_time_s: 0.001,
        contact_exponent: -0.2,
        restitution: Striker::DEFAULT_RESTITUTION,
        scrape: None,
        roll: None,
        modes: bank(1, 1),
    }
}

pub(crate) fn pad(name: &str, object: &str, striker: &str) -> Pad {
    Pad {
        name: name.to_owned(),
        object: object.to_owned(),
        strikers: vec![striker.to_owned()],
        level_db: -6.0,
        pan: 0.0,
        striker_weight: 1.0,
        choke_t60_s: 0.1,
        midi_notes: vec![60],
        note_off: kit::NoteOff::Nothing,
        trigger: None,
    }
}

/// The sample kit: two objects, two strikers, two pads.
pub(crate) fn kit() -> Kit {
    Kit {
        name: "test".to_owned(),
        objects: vec![object("bar", bank(4, 1)), object("string", bank(3, 2))],
        strikers: vec![striker("yarn"), striker("wood")],
        pads: vec![pad("bar", "bar", "yarn"), Pad { midi_notes: vec![61], ..pad("string", "string", "wood") }],
        background: None,
        room: vec![],
        headphone_db: None,
        surfaces: Vec::new(),
    }
}

/// Parses a text that includes no files.
pub(crate) fn parse(text: &str) -> Result<Kit, KitError> {
    parse_with(text, &[])
}

/// Parses a text that includes files, which are given by their names and texts.
pub(crate) fn parse_with(text: &str, includes: &[(&str, &str)]) -> Result<Kit, KitError> {
    let source = |file: &str, text: &str| SourceText { file: file.to_owned(), text: text.to_owned() };
    kit::text::parse(&source("test.toml", text), |name| match includes.iter().find(|(file, _)| *file == name) {
        Some((file, text)) => Ok(source(file, text)),
        None => {
            let cause = io::ErrorKind::NotFound.into();
            Err(KitError::File(FileError { action: "read", path: Path::new(name).to_owned(), cause }))
        }
    })
}
