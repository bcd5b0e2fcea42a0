//! Names of items that come from a user's words.

/// Maximum length of an item's name.
const LONGEST: usize = 24;

/// Name that the format accepts: printable ASCII without comma and quote, at most 24 characters
/// with its `ending`, which must be shorter. Words of which nothing is left become "object".
pub fn item_name(wanted: &str, ending: &str) -> String {
    let plain = |c: char| if (' '..='~').contains(&c) && c != ',' && c != '"' { c } else { '-' };
    let name: String = wanted.trim().chars().map(plain).take(LONGEST.saturating_sub(ending.len())).collect();
    let name = name.trim();
    format!("{}{ending}", if name.is_empty() { "object" } else { name })
}
