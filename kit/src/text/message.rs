//! The TOML reader's messages, in words that name keys, types and ranges as the format page does.

/// Rewords a message of the TOML reader. Messages of this crate's own readers stay as they are.
pub(super) fn plain(message: &str) -> String {
    let message = message.trim_end();
    if let Some((key, allowed)) = split(message, "unknown field ", ", expected ") {
        return format!("unknown key {key}: must be {allowed}");
    }
    if let Some(key) = message.strip_prefix("missing field ") {
        return format!("the key {key} is missing; add it");
    }
    if let Some((found, expected)) =
        split(message, "invalid type: ", ", expected ").or_else(|| split(message, "invalid value: ", ", expected "))
    {
        return format!("{}: must be {}", type_name(found), expected_name(expected));
    }
    if let Some((found, expected)) = split(message, "invalid length ", ", expected ") {
        return format!("an array of length {found}: must be {expected}");
    }
    if message.contains("number overflowed") {
        return "this number is too large for any key; give one that its key allows (docs/kit-format.md)".to_owned();
    }
    if message.contains("duplicate key") {
        return "this key is there twice; keep one of the two".to_owned();
    }
    if message.contains(": must be ") {
        return message.replace('\n', ", ");
    }
    "this is not TOML; check the quotes, brackets, commas and equals signs of this line".to_owned()
}

/// The parts of a message behind `start` and behind the first `middle`.
fn split<'m>(message: &'m str, start: &str, middle: &str) -> Option<(&'m str, &'m str)> {
    message.strip_prefix(start)?.split_once(middle)
}

fn type_name(found: &str) -> &str {
    match found {
        "sequence" => "an array",
        "map" => "a table",
        other => other,
    }
}

fn expected_name(expected: &str) -> &str {
    match expected {
        "f32" | "f64" => "a number",
        "i64" => "a whole number",
        "u8" => "a whole number from 0 to 255",
        "u32" => "a whole number from 0 to 4294967295",
        "a sequence" => "an array",
        table if table == "a map" || table.starts_with("struct ") => "a table",
        other => other,
    }
}
