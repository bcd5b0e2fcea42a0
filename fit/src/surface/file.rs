//! Files of heights.

use std::path::Path;

use super::error::SurfaceError;
use super::heights::Heights;
use super::options::Note;
use super::{csv_file, npy_file};

/// Reads a profile or a map from an NPY or a CSV file.
///
/// An NPY file has one or two dimensions and heights in metres: floats of 16 to 64 bits, or
/// integers of 8 to 64. A CSV file has numbers in metres, separated by commas or blanks, below a
/// head or none: a column of heights, two columns of position and height, or a map with a row a
/// line. A missing point is an empty cell or `nan`. `step_m` is the distance of points if the file
/// does not tell it.
///
/// # Errors
/// [`SurfaceError`] if the file cannot be read, is none of these, or does not tell its step.
pub fn read(path: &Path, step_m: Option<f64>) -> Result<(Heights, Vec<Note>), SurfaceError> {
    if let Some(step_m) = step_m.filter(|step_m| !(1e-9..=0.1).contains(step_m)) {
        return Err(SurfaceError::Range { option: "--step", value: step_m, range: "give 1e-9 to 0.1 m" });
    }
    let bytes = std::fs::read(path).map_err(|cause| SurfaceError::Read { path: path.to_owned(), cause })?;
    let ending = path.extension().map(|ending| ending.to_string_lossy().to_lowercase());
    match ending.as_deref() {
        Some("npy") => {
            let (values, columns) = npy_file::parse(&bytes, path)?;
            let step_m = step_m.ok_or_else(|| SurfaceError::NoStep { path: path.to_owned() })?;
            Ok((Heights { step_m, columns, values }, Vec::new()))
        }
        Some("csv") => csv_file::parse(&bytes, path, step_m),
        _ => Err(SurfaceError::Format { path: path.to_owned() }),
    }
}
