//! Numbers of things in messages.

use std::fmt::Display;

/// Plurals whose singular is not the plural without its s, each with its singular.
const IRREGULAR: [(&str, &str); 3] = [("entries", "entry"), ("halves", "half"), ("touches", "touch")];

/// Returns a number of things in words, where `things` is their plural, which ends in -s.
///
/// ```
/// # use kit::counting::counted;
/// assert_eq!(counted(1_u64, "pads"), "1 pad");
/// assert_eq!(counted(2_usize, "program changes"), "2 program changes");
/// assert_eq!(counted(1_usize, "halves"), "1 half");
/// ```
pub fn counted<N: Display + PartialEq + From<u8>>(count: N, things: &str) -> String {
    let irregular = IRREGULAR.into_iter().find(|(plural, _)| *plural == things).map(|(_, singular)| singular);
    match count == N::from(1) {
        true => format!("1 {}", irregular.or(things.strip_suffix('s')).unwrap_or(things)),
        false => format!("{count} {things}"),
    }
}
