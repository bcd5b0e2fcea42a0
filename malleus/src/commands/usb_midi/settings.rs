//! Settings of a board as the user writes and reads them.

use cable::{Answer, HostError, Key, Link, Refusal, Request, Value, ValueRange};

use super::ask;
use crate::commands::error::CommandError;

/// Change of a setting; without a value the kit's own or the firmware's holds again.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Change {
    key: Key,
    value: Option<Value>,
}

/// Reads a change such as `threshold.0=0.01` or `channel=`.
pub(super) fn parse(text: &str) -> Result<Change, String> {
    let (name, value) = text.split_once('=').ok_or("must be NAME=VALUE, or NAME= for no value of the board's own")?;
    let key = parse_key(name)?;
    let value = match (value, key.range()) {
        ("", _) => None,
        (value, ValueRange::Number(min, max)) => {
            let number = value.parse().ok().filter(|number| (min..=max).contains(number));
            Some(Value::Number(number.ok_or(format!("{name} must be from {min} to {max}"))?))
        }
        (value, ValueRange::Count(min, max)) => {
            let count = value.parse().ok().filter(|count| (min..=max).contains(count));
            Some(Value::Count(count.ok_or(format!("{name} must be a whole number from {min} to {max}"))?))
        }
    };
    Ok(Change { key, value })
}

fn parse_key(name: &str) -> Result<Key, String> {
    let (kind, piezo) = name.split_once('.').map_or((name, None), |(kind, piezo)| (kind, piezo.parse().ok()));
    match (kind, piezo, name.contains('.')) {
        ("threshold", Some(piezo), _) => Ok(Key::Threshold { piezo }),
        ("curve", Some(piezo), _) => Ok(Key::Curve { piezo }),
        ("channel", _, false) => Ok(Key::Channel),
        ("level", _, false) => Ok(Key::Level),
        ("start-slot", _, false) => Ok(Key::StartSlot),
        _ => Err(format!(
            "there is no setting {name:?}; there are threshold.0, curve.0 (and of each other piezo), channel, level, start-slot"
        )),
    }
}

fn line(key: Key, value: Option<Value>) -> String {
    let name = match key {
        Key::Threshold { piezo } => format!("threshold.{piezo}"),
        Key::Curve { piezo } => format!("curve.{piezo}"),
        Key::Channel => "channel".to_owned(),
        Key::Level => "level".to_owned(),
        Key::StartSlot => "start-slot".to_owned(),
    };
    match value {
        Some(Value::Number(number)) => format!("{name}={number}\n"),
        Some(Value::Count(count)) => format!("{name}={count}\n"),
        None => format!("{name}=\n"),
    }
}

/// Changes settings, or lists all of them if there is nothing to change.
pub(super) fn settings_over(
    link: &mut impl Link<Error = CommandError>,
    changes: &[Change],
) -> Result<String, CommandError> {
    for &Change { key, value } in changes {
        ask(link, Request::Set { key, value })?;
    }
    match changes {
        [] => list(link),
        changes => Ok(changes.iter().map(|change| line(change.key, change.value)).collect()),
    }
}

fn list(link: &mut impl Link<Error = CommandError>) -> Result<String, CommandError> {
    let piezos = (0..=u8::MAX).flat_map(|piezo| [Key::Threshold { piezo }, Key::Curve { piezo }]);
    let mut text = String::new();
    for key in [Key::Channel, Key::Level, Key::StartSlot].into_iter().chain(piezos) {
        match ask(link, Request::Get { key }) {
            Ok(Answer::Setting { value, .. }) => text += &line(key, value),
            // The board has no more piezos.
            Err(CommandError::Cable(HostError::Refused(Refusal::SettingRange { .. }))) => break,
            Ok(_) => return Err(CommandError::Cable(HostError::BadAnswer)),
            Err(error) => return Err(error),
        }
    }
    Ok(text)
}
