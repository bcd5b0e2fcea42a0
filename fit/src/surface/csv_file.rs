//! Heights from a CSV file.

use std::borrow::Cow;
use std::path::Path;

use csv::{ReaderBuilder, StringRecord, Trim};

use kit::counting::counted;

use super::error::SurfaceError;
use super::heights::Heights;
use super::options::Note;

/// Largest error of a position, as a share of the step, at which positions are even.
const EVEN: f64 = 0.02;
/// Distance of neighbours, in usual ones, beyond which points are missing between them.
const GAP: f64 = 3.0;

/// Units in which heads of other programs' files have columns, as the last word of a name.
const OTHER_UNITS: [&str; 8] = ["km", "cm", "mm", "um", "µm", "μm", "nm", "pm"];

/// Heights of a file, with its step where it has positions, and notes on what was decided.
pub(super) fn parse(bytes: &[u8], path: &Path, step_m: Option<f64>) -> Result<(Heights, Vec<Note>), SurfaceError> {
    let bytes = with_commas(bytes);
    let mut reader =
        ReaderBuilder::new().has_headers(false).flexible(true).trim(Trim::All).comment(Some(b'#')).from_reader(&*bytes);
    let (mut values, mut columns, mut lines, mut head) = (Vec::new(), 0, Vec::new(), None);
    for (index, record) in reader.records().enumerate() {
        let at = |line: u64, cause: String| SurfaceError::CsvLine { path: path.to_owned(), line, cause };
        let record = record.map_err(|cause| at(index as u64 + 1, cause.to_string()))?;
        let line = record.position().map_or(index as u64 + 1, csv::Position::line);
        let numbers = match numbers(&record) {
            Ok(numbers) => numbers,
            // The first line may be the head, which has no numbers.
            Err(_) if index == 0 && !record.iter().any(|cell| cell.parse::<f64>().is_ok()) => {
                head = Some((line, record));
                continue;
            }
            Err(cell) => return Err(at(line, format!("{cell:?} is no number"))),
        };
        if columns == 0 {
            columns = numbers.len();
        }
        if numbers.len() != columns {
            return Err(at(line, format!("{}, {columns} before", counted(numbers.len(), "columns"))));
        }
        values.extend(numbers);
        lines.push(line);
    }
    let note = head.map(|(line, head)| of_head(&head, columns, path, line)).transpose()?.flatten();
    let step = || step_m.ok_or_else(|| SurfaceError::NoStep { path: path.to_owned() });
    let (heights, notes) = match columns {
        0 | 1 => (Heights { step_m: step()?, columns: values.len(), values }, Vec::new()),
        2 => of_positions(&values, &lines, path)?,
        columns => (Heights { step_m: step()?, columns, values }, Vec::new()),
    };
    Ok((heights, note.into_iter().chain(notes).collect()))
}

/// The file with commas between its columns: `numpy.savetxt` writes blanks there.
fn with_commas(bytes: &[u8]) -> Cow<'_, [u8]> {
    let mut lines = bytes.split(|&byte| byte == b'\n').filter(|line| !line.trim_ascii_start().starts_with(b"#"));
    if lines.any(|line| line.contains(&b',')) {
        return Cow::Borrowed(bytes);
    }
    let words = |line: &[u8]| {
        let words = line.split(u8::is_ascii_whitespace).filter(|word| !word.is_empty());
        words.collect::<Vec<_>>().join(&b',')
    };
    Cow::Owned(bytes.split(|&byte| byte == b'\n').map(words).collect::<Vec<_>>().join(&b'\n'))
}

/// Note on a head whose names are not known.
///
/// # Errors
/// [`SurfaceError::CsvHead`] if it names another unit than metres, or the height first.
fn of_head(head: &StringRecord, columns: usize, path: &Path, line: u64) -> Result<Option<Note>, SurfaceError> {
    let names: Vec<&str> = head.iter().collect();
    let refused = |cause: String| Err(SurfaceError::CsvHead { path: path.to_owned(), line, cause });
    let unit = |name: &str| {
        let mut words = name.split(|letter: char| !letter.is_alphanumeric());
        words.rfind(|word| !word.is_empty()).and_then(|word| OTHER_UNITS.iter().find(|unit| **unit == word))
    };
    if let Some((name, unit)) = names.iter().find_map(|name| Some((name, unit(name)?))) {
        return refused(format!("the column {name:?} is in {unit}"));
    }
    match (columns, &names[..]) {
        (2, ["height_m", "x_m"]) => refused("the height stands before the position".to_owned()),
        (1, ["height_m"]) | (2, ["x_m", "height_m"]) => Ok(None),
        _ => {
            let read_as = match columns {
                0 | 1 => "the column is read as heights",
                2 => "the columns are read as positions and heights",
                _ => "each line is read as a row of a map",
            };
            Ok(Some(Note::Head { head: names.join(","), read_as }))
        }
    }
}

/// Numbers of a line, NaN for an empty cell; the cell that is none.
fn numbers(record: &StringRecord) -> Result<Vec<f64>, String> {
    let number = |cell: &str| if cell.is_empty() { Ok(f64::NAN) } else { cell.parse().map_err(|_| cell.to_owned()) };
    record.iter().map(number).collect()
}

/// A profile of positions and heights, at even steps.
fn of_positions(values: &[f64], lines: &[u64], path: &Path) -> Result<(Heights, Vec<Note>), SurfaceError> {
    let (positions, heights): (Vec<f64>, Vec<f64>) = values.chunks_exact(2).map(|pair| (pair[0], pair[1])).unzip();
    if let Some(index) = positions.iter().position(|position| !position.is_finite()) {
        let cause = "the position is no finite number".to_owned();
        return Err(SurfaceError::CsvLine { path: path.to_owned(), line: lines[index], cause });
    }
    if let Some(index) = positions.windows(2).position(|pair| pair[1] <= pair[0]) {
        return Err(SurfaceError::Order { path: path.to_owned(), line: lines[index + 1] });
    }
    let mut steps: Vec<f64> = positions.windows(2).map(|pair| pair[1] - pair[0]).collect();
    steps.sort_by(f64::total_cmp);
    let widest_m = GAP * steps.get(steps.len() / 2).copied().unwrap_or(1.0);
    let (near, gaps) = steps.split_at(steps.partition_point(|&step| step <= widest_m));
    let (near_m, missing_m) = (near.iter().sum::<f64>(), gaps.iter().sum::<f64>());
    if missing_m > near_m {
        return Err(SurfaceError::Missing { percent: 100.0 * missing_m / (missing_m + near_m) });
    }
    let whole_m = positions.last().unwrap_or(&1.0) - positions.first().unwrap_or(&0.0);
    let step_m = if gaps.is_empty() { whole_m } else { near_m } / near.len().max(1) as f64;
    let is_even = |(index, x): (usize, &f64)| (x - positions[0] - index as f64 * step_m).abs() < EVEN * step_m;
    if positions.iter().enumerate().all(is_even) {
        return Ok((Heights { step_m, columns: heights.len(), values: heights }, Vec::new()));
    }
    let values = resampled(&positions, &heights, step_m, widest_m);
    Ok((Heights { step_m, columns: values.len(), values }, vec![Note::Resampled { step_m }]))
}

/// Heights at even steps by cubic pieces whose slopes are those of their neighbours' parabola; NaN
/// within pieces that are longer than `widest_m`.
fn resampled(positions: &[f64], heights: &[f64], step_m: f64, widest_m: f64) -> Vec<f64> {
    let last = positions.len() - 1;
    let rise = |index: usize| (heights[index + 1] - heights[index]) / (positions[index + 1] - positions[index]);
    let slope = |index: usize| match index {
        0 => rise(0),
        index if index == last => rise(last - 1),
        index => {
            let (before, after) = (positions[index] - positions[index - 1], positions[index + 1] - positions[index]);
            (rise(index - 1) * after + rise(index) * before) / (before + after)
        }
    };
    let mut piece = 0;
    let at = |point: usize| {
        let x = positions[0] + point as f64 * step_m;
        while piece + 1 < last && positions[piece + 1] < x {
            piece += 1;
        }
        let length = positions[piece + 1] - positions[piece];
        if length > widest_m {
            return f64::NAN;
        }
        let t = ((x - positions[piece]) / length).clamp(0.0, 1.0);
        let (from, to) = (heights[piece], heights[piece + 1]);
        let (bend, turn) = (length * slope(piece) - (to - from), (to - from) - length * slope(piece + 1));
        (1.0 - t) * from + t * to + t * (1.0 - t) * ((1.0 - t) * bend + t * turn)
    };
    let points = ((positions[last] - positions[0]) / step_m * (1.0 + 1e-9)) as usize;
    (0..=points).map(at).collect()
}
