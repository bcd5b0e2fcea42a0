//! Section "Events" of docs/kit-format.md.

use std::path::Path;

/// Event of a pad.
pub(crate) struct Event {
    /// Time in samples, not rounded.
    pub(crate) at: f64,
    pub(crate) pad: String,
    pub(crate) action: Action,
}

pub(crate) enum Action {
    Strike { velocity: f64, position: f64, striker: String },
    Choke,
    Release,
}

/// Reads a file of events at a sample rate.
pub(crate) fn read(path: &Path, fs: f64) -> Vec<Event> {
    let mut reader = csv::ReaderBuilder::new().trim(csv::Trim::All).comment(Some(b'#')).from_path(path).unwrap();
    let columns = reader.headers().unwrap().clone();
    let events = reader.records().map(|record| {
        let record = record.unwrap();
        let field = |name| columns.iter().position(|column| column == name).map_or("", |column| &record[column]);
        let number = |name| field(name).parse::<f64>().unwrap_or(0.0);
        let strike = || Action::Strike {
            velocity: f64::from(number("velocity") as f32),
            position: f64::from(number("position") as f32),
            striker: field("striker").to_owned(),
        };
        Event {
            at: if field("sample").is_empty() { rounded(number("time_s") * fs) } else { number("sample") },
            pad: field("pad").to_owned(),
            action: match field("action") {
                "" | "strike" => strike(),
                "choke" => Action::Choke,
                "release" => Action::Release,
                other => panic!("action {other}"),
            },
        }
    });
    events.collect()
}

/// Rounds a time in samples to 2^-32 of a sample, but not up to the next whole sample.
fn rounded(at: f64) -> f64 {
    let steps = 2f64.powi(32);
    at.floor() + (at.fract() * steps).round().min(steps - 1.0) / steps
}
