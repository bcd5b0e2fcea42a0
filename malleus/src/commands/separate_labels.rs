//! Labels of recordings: who strikes what, as CSV with the columns `recording,object,striker`.

use std::path::{Path, PathBuf};

use kit::counting::counted;
use malleus::csv_text;

/// Columns of the file, in any order.
const COLUMNS: [&str; 3] = ["recording", "object", "striker"];

/// Refusal of a file of labels.
#[derive(Debug, thiserror::Error)]
pub(crate) enum LabelsError {
    #[error("{}: line {line} cannot be read as CSV in UTF-8: give lines of recording,object,striker", path.display())]
    NotCsv { path: PathBuf, line: u64 },
    #[error("{}: the first line, {head:?}, does not name {missing}: it has to be the head recording,object,striker", path.display())]
    Columns { path: PathBuf, head: String, missing: String },
    #[error("{}: line {line} has {}, and the head names {}: give a recording, what is struck, and what strikes it", path.display(), counted(*found, "fields"), counted(*expected, "columns"))]
    FieldCount { path: PathBuf, line: u64, found: u64, expected: u64 },
    #[error("{}: line {line}: the field {column:?} is empty: name the recording, what is struck, and what strikes it", path.display())]
    EmptyField { path: PathBuf, line: u64, column: &'static str },
    #[error("{}: line {line} names {recording:?}, which is none of the recordings given: give that file, or remove the line", path.display())]
    NoSuchRecording { path: PathBuf, line: u64, recording: String },
    #[error("{}: line {line} names {recording:?}, which {count} of the recordings are called: name it by its path", path.display())]
    Ambiguous { path: PathBuf, line: u64, recording: String, count: usize },
    #[error("{}: line {line} names {recording:?} again: label each recording once", path.display())]
    Twice { path: PathBuf, line: u64, recording: String },
    #[error("{}: it has no label in {}: add a line recording,object,striker for it", recording.display(), path.display())]
    NoLabel { path: PathBuf, recording: PathBuf },
}

/// Thing and striker of each recording, by index, and the names of both.
#[derive(Debug, PartialEq, Eq)]
pub(super) struct Labels {
    /// Names of the things in the order of the recordings.
    pub(super) objects: Vec<String>,
    /// Names of the strikers in the order of the recordings.
    pub(super) strikers: Vec<String>,
    /// Indices of thing and striker of each recording.
    pub(super) of_recording: Vec<[usize; 2]>,
}

/// Reads the labels of recordings from the bytes of a file at `path`.
///
/// A recording is named by its path as it was given, or by its file's name, with or without the
/// ending. Lines that begin with `#` are comments.
///
/// # Errors
/// [`LabelsError`] for the first line that is wrong, and for a recording without label.
pub(super) fn parse(bytes: &[u8], path: &Path, recordings: &[PathBuf]) -> Result<Labels, LabelsError> {
    let bytes = &csv_text::tidied(bytes)[..];
    let mut reader = csv_text::reader(bytes);
    let path = || path.to_owned();
    let not_csv = |error: &::csv::Error| {
        let line = error.position().map_or(1, |position| csv_text::line_at(position, bytes));
        match *error.kind() {
            ::csv::ErrorKind::UnequalLengths { expected_len: expected, len: found, .. } => {
                LabelsError::FieldCount { path: path(), line, found, expected }
            }
            _ => LabelsError::NotCsv { path: path(), line },
        }
    };
    let header = reader.headers().map_err(|error| not_csv(&error))?.clone();
    let places = COLUMNS.map(|column| header.iter().position(|name| name == column));
    let [Some(recording), Some(object), Some(striker)] = places else {
        let missing = COLUMNS.iter().zip(places).filter(|(_, place)| place.is_none());
        let missing = missing.map(|(column, _)| *column).collect::<Vec<_>>().join(", ");
        let head = header.iter().collect::<Vec<_>>().join(",");
        return Err(LabelsError::Columns { path: path(), head, missing });
    };
    let places = [recording, object, striker];
    let mut of_recording: Vec<Option<[String; 2]>> = vec![None; recordings.len()];
    for record in reader.records() {
        let record = record.map_err(|error| not_csv(&error))?;
        let line = record.position().map_or(0, |position| csv_text::line_at(position, bytes));
        let mut fields = [""; 3];
        for ((field, place), column) in fields.iter_mut().zip(places).zip(COLUMNS) {
            *field = record.get(place).unwrap_or_default();
            if field.is_empty() {
                return Err(LabelsError::EmptyField { path: path(), line, column });
            }
        }
        let [recording, object, striker] = fields.map(str::to_owned);
        let named: Vec<usize> = named(&recording, recordings);
        let index = match named[..] {
            [index] => index,
            [] => return Err(LabelsError::NoSuchRecording { path: path(), line, recording }),
            _ => return Err(LabelsError::Ambiguous { path: path(), line, recording, count: named.len() }),
        };
        if of_recording[index].replace([object, striker]).is_some() {
            return Err(LabelsError::Twice { path: path(), line, recording });
        }
    }
    let mut labels = Labels { objects: Vec::new(), strikers: Vec::new(), of_recording: Vec::new() };
    for (label, recording) in of_recording.into_iter().zip(recordings) {
        let [object, striker] =
            label.ok_or_else(|| LabelsError::NoLabel { path: path(), recording: recording.clone() })?;
        labels.of_recording.push([index_of(&mut labels.objects, object), index_of(&mut labels.strikers, striker)]);
    }
    Ok(labels)
}

/// Index of a name in a list, to which it is added if it is new.
fn index_of(names: &mut Vec<String>, name: String) -> usize {
    names.iter().position(|known| *known == name).unwrap_or_else(|| {
        names.push(name);
        names.len() - 1
    })
}

/// Indices of the recordings that a label names: by path, else by file name, else by stem.
fn named(label: &str, recordings: &[PathBuf]) -> Vec<usize> {
    let matching = |part: &dyn Fn(&Path) -> bool| -> Vec<usize> {
        recordings.iter().enumerate().filter(|(_, path)| part(path)).map(|(index, _)| index).collect()
    };
    let by_path = matching(&|path| path == Path::new(label));
    if !by_path.is_empty() {
        return by_path;
    }
    let by_name = matching(&|path| path.file_name().is_some_and(|name| name.to_string_lossy() == label));
    if !by_name.is_empty() {
        return by_name;
    }
    matching(&|path| path.file_stem().is_some_and(|stem| stem.to_string_lossy() == label))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn labels(text: &str) -> Result<Labels, String> {
        let recordings = ["a/one.wav", "a/two.wav", "b/two.wav"].map(PathBuf::from);
        parse(text.as_bytes(), Path::new("labels.csv"), &recordings).map_err(|error| error.to_string())
    }

    #[test]
    fn recordings_are_named_by_path_file_name_or_stem() {
        let labels = labels("striker,recording,object\nfork,one,mug\nfork,a/two.wav,cup\nspoon,b/two.wav,mug\n");
        let labels = labels.expect("valid labels");
        assert_eq!(
            (labels.objects, labels.strikers),
            (["mug", "cup"].map(str::to_owned).to_vec(), ["fork", "spoon"].map(str::to_owned).to_vec())
        );
        assert_eq!(labels.of_recording, [[0, 0], [1, 0], [0, 1]]);
    }

    #[test]
    fn spaces_before_quotes_and_lines_of_spaces_change_no_label() {
        let tight = "recording,object,striker\none,\"a mug, blue\",fork\na/two.wav,cup,fork\nb/two.wav,cup,spoon\n";
        let loose = tight.replace(',', ", ").replace("\"a mug, ", "\"a mug,").replace('\n', "\n   \n");
        assert!(loose.contains(", \"a mug"), "{loose}");
        assert_eq!(labels(&loose).expect("valid labels"), labels(tight).expect("valid labels"));
    }

    #[test]
    fn labels_that_are_wrong_are_refused_with_their_line() {
        let head = "recording,object,striker\n";
        for (text, expected) in [
            (
                "recording,object\none,mug\n",
                "the first line, \"recording,object\", does not name striker: it has to be",
            ),
            (
                "one.wav,mug,fork\n",
                "\"one.wav,mug,fork\", does not name recording, object, striker: it has to be the head",
            ),
            (&format!("{head}three.wav,mug,fork\n"), "line 2 names \"three.wav\", which is none of the recordings"),
            (&format!("{head}two,mug,fork\n"), "line 2 names \"two\", which 2 of the recordings are called"),
            (&format!("{head}one,mug,fork\none.wav,mug,fork\n"), "line 3 names \"one.wav\" again"),
            (&format!("{head}one,,fork\n"), "line 2: the field \"object\" is empty"),
            (&format!("{head}one,mug\n"), "line 2 has 2 fields, and the head names 3 columns"),
            (&format!("{head}\n# two\n \none,,fork\n"), "line 5: the field \"object\" is empty"),
            (&format!("{head}one,mug,fork\na/two.wav,cup,fork\n"), "b/two.wav: it has no label"),
        ] {
            let error = labels(text).expect_err(text);
            assert!(error.contains(expected), "{error}");
        }
    }
}
