//! Numbers of things in messages.

use std::fmt::Display;

/// Returns a number of things in words, where `things` is their plural in -s.
///
/// ```
/// # use malleus::counting::counted;
/// assert_eq!(counted(1_u64, "pads"), "1 pad");
/// assert_eq!(counted(2_usize, "program changes"), "2 program changes");
/// ```
pub fn counted<N: Display + PartialEq + From<u8>>(count: N, things: &str) -> String {
    match count == N::from(1) {
        true => format!("1 {}", things.strip_suffix('s').unwrap_or(things)),
        false => format!("{count} {things}"),
    }
}
