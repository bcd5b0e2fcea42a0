//! CSV in UTF-8, as lists of events, motions and labels have it: one header line, fields that may
//! be quoted with `"`, spaces round a field, lines of spaces and lines that begin with `#` ignored.

mod tidied;

use dsp_core::table::{Kit, Pad};

pub use tidied::tidied;

/// Reason for which bytes are no CSV with the wanted columns.
#[derive(Debug)]
pub(crate) enum TextFault {
    /// The byte at `offset` is not UTF-8, or is a NUL.
    NotText { offset: usize },
    /// A line, counted from 1, has another number of fields than the header.
    FieldCount { line: u64, found: u64, expected: u64 },
    /// The header repeats a column or has an unknown one.
    Header(String),
}

/// Refuses bytes that are not UTF-8 or hold a NUL, which no text has.
pub(crate) fn check_text(bytes: &[u8]) -> Result<(), TextFault> {
    let text = std::str::from_utf8(bytes).map_err(|error| TextFault::NotText { offset: error.valid_up_to() })?;
    text.find('\0').map_or(Ok(()), |offset| Err(TextFault::NotText { offset }))
}

/// Reader of the lines of a file that lies in memory, [`tidied`].
pub fn reader(bytes: &[u8]) -> ::csv::Reader<&[u8]> {
    ::csv::ReaderBuilder::new().trim(::csv::Trim::All).comment(Some(b'#')).from_reader(bytes)
}

/// The fault behind an error of the CSV reader.
///
/// Text that lies in memory can only fail by its number of fields. Any other error would be that of
/// a byte that is not text.
pub(crate) fn of_reader(error: &::csv::Error, bytes: &[u8]) -> TextFault {
    let position = error.position();
    match error.kind() {
        ::csv::ErrorKind::UnequalLengths { expected_len, len, .. } => TextFault::FieldCount {
            line: position.map_or(0, |position| line_at(position, bytes)),
            found: *len,
            expected: *expected_len,
        },
        _ => TextFault::NotText { offset: position.map_or(0, |position| position.byte() as usize) },
    }
}

/// Line of the record at a position of the reader, counted from 1. The reader's own number is that
/// of the first empty line or comment before the record.
pub fn line_at(position: &::csv::Position, bytes: &[u8]) -> u64 {
    let rest = bytes.get(position.byte() as usize..).unwrap_or_default();
    let is_skipped = |line: &&[u8]| line.is_empty() || *line == b"\r" || line.starts_with(b"#");
    position.line() + rest.split(|&byte| byte == b'\n').take_while(is_skipped).count() as u64
}

/// Known columns of a file, and where its header has them.
pub(crate) struct Columns<'n> {
    names: &'n [&'static str],
    places: Vec<Option<usize>>,
}

impl<'n> Columns<'n> {
    /// Finds the columns `names` in a header. A column may be missing.
    ///
    /// # Errors
    /// [`TextFault::Header`] for a column that is there twice or is not among `names`.
    pub(crate) fn find(header: &::csv::StringRecord, names: &'n [&'static str]) -> Result<Self, TextFault> {
        let mut places = vec![None; names.len()];
        for (place, name) in header.iter().enumerate() {
            match names.iter().position(|column| *column == name) {
                Some(column) if places[column].is_none() => places[column] = Some(place),
                Some(_) => return Err(TextFault::Header(format!("the column `{name}` is there twice"))),
                None => return Err(TextFault::Header(format!("the column `{name}` is unknown"))),
            }
        }
        Ok(Self { names, places })
    }

    /// True if the header has this column.
    pub(crate) fn has(&self, column: &str) -> bool {
        self.place(column).is_some()
    }

    fn place(&self, column: &str) -> Option<usize> {
        let index = self.names.iter().position(|known| *known == column)?;
        self.places[index]
    }
}

/// One line of a file behind the header.
pub(crate) struct Row<'a> {
    /// Line of the file, counted from 1.
    pub(crate) line: u64,
    /// Columns of the file.
    pub(crate) columns: &'a Columns<'a>,
    record: &'a ::csv::StringRecord,
}

impl<'a> Row<'a> {
    /// The line that a record came from.
    pub(crate) fn new(record: &'a ::csv::StringRecord, columns: &'a Columns<'a>, bytes: &[u8]) -> Self {
        Self { line: record.position().map_or(0, |position| line_at(position, bytes)), columns, record }
    }

    /// Text of a column; empty if the file does not have the column.
    pub(crate) fn field(&self, column: &str) -> &'a str {
        self.columns.place(column).and_then(|place| self.record.get(place)).unwrap_or("")
    }
}

/// Pad of this name with its number, counted from 0; if there is none, the names that the kit has.
pub(crate) fn pad_named<'k>(kit: &Kit<'k>, name: &str) -> Result<(u8, Pad<'k>), String> {
    let found = (0u8..=254).zip(kit.pads()).find(|(_, pad)| pad.name() == name);
    found.ok_or_else(|| {
        let names: Vec<_> = kit.pads().map(|pad| pad.name()).collect();
        format!("unknown pad; the kit has {}", names.join(", "))
    })
}

/// Number of the pad's striker of this name, counted from 0, the first one for no name; if there is
/// none, the names that the pad has.
pub(crate) fn striker_named(kit: &Kit<'_>, pad: Pad<'_>, name: &str) -> Result<u8, String> {
    if name.is_empty() {
        return Ok(0);
    }
    let found = (0u8..).zip(kit.strikers_of(pad)).find(|(_, striker)| striker.name() == name);
    found.map(|(index, _)| index).ok_or_else(|| {
        let names: Vec<_> = kit.strikers_of(pad).map(|striker| striker.name()).collect();
        format!("unknown striker; pad {} has {}", pad.name(), names.join(", "))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_are_counted_with_the_empty_ones_and_comments_before_them() {
        let bytes = b"# a\r\n\r\na,b\n1,2\n# c\n\n#d\n3,4\n\n5,6";
        let mut reader = reader(bytes);
        let header = reader.headers().expect("a header").clone();
        let columns = Columns::find(&header, &["a", "b"]).expect("both are known");
        let records: Vec<_> = reader.records().map(|record| record.expect("two fields")).collect();
        let lines: Vec<u64> = records.iter().map(|record| Row::new(record, &columns, bytes).line).collect();
        assert_eq!(lines, [4, 8, 10]);
    }
}
