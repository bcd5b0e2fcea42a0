//! Short texts of a fixed size.

use core::fmt;

/// Text of at most 24 bytes of UTF-8, such as a kit's name.
#[derive(Clone, Copy, Default, PartialEq, Eq)]
pub struct Text {
    bytes: [u8; Text::BYTES],
}

impl Text {
    /// Bytes of a text on the wire; zeros fill what the text leaves.
    pub const BYTES: usize = 24;

    /// Takes the beginning of a text, as far as it has room.
    pub fn new(text: &str) -> Self {
        let mut bytes = [0; Self::BYTES];
        let end = text.floor_char_boundary(Self::BYTES);
        for (to, from) in bytes.iter_mut().zip(text.bytes().take(end)) {
            *to = from;
        }
        Self { bytes }
    }

    /// Takes a text from the wire; `None` if it is not UTF-8.
    pub fn from_bytes(bytes: [u8; Self::BYTES]) -> Option<Self> {
        core::str::from_utf8(&bytes).is_ok().then_some(Self { bytes })
    }

    /// Bytes of the text on the wire.
    pub fn bytes(&self) -> &[u8; Self::BYTES] {
        &self.bytes
    }

    /// The text, without the zeros behind it.
    pub fn as_str(&self) -> &str {
        core::str::from_utf8(&self.bytes).unwrap_or_default().trim_end_matches('\0')
    }
}

impl fmt::Display for Text {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.as_str())
    }
}

impl fmt::Debug for Text {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        fmt::Debug::fmt(self.as_str(), f)
    }
}
