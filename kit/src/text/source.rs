//! The text of a file, and the version of its format.

/// Version of the text form that this crate reads and writes.
pub const FORMAT: i64 = 1;

/// Name of a kit whose text has no pads and gives no name.
pub const UNTITLED: &str = "untitled";

/// Text of one file.
#[derive(Clone, Debug)]
pub struct SourceText {
    /// Name of the file in errors.
    pub file: String,
    /// Content of the file.
    pub text: String,
}
