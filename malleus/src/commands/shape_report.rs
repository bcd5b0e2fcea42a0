//! `malleus shape --report`: the page of a shape.

use std::path::{Path, PathBuf};

use ::shape::file::ShapeFile;
use ::shape::solve::Solved;
use malleus::report::{SHAPE_PAGE_FILE, ShapePage, is_shape_page, write_shape_page};

use super::error::CommandError;
use super::output::progress;
use super::shape::ShapeError;
use super::shape_sound;
use crate::arguments::ShapeArguments;

/// Checks that a page can be written into a folder, before anything is solved.
///
/// # Errors
/// [`ShapeError`] if the folder is a file, or holds another page under the same name.
pub(super) fn check(folder: &Path) -> Result<(), ShapeError> {
    if folder.exists() && !folder.is_dir() {
        return Err(ShapeError::ReportIsFile { path: folder.to_owned() });
    }
    let page = folder.join(SHAPE_PAGE_FILE);
    let is_other = page.exists() && !std::fs::read_to_string(&page).is_ok_and(|html| is_shape_page(&html));
    if is_other { Err(ShapeError::OtherPage { path: page }) } else { Ok(()) }
}

/// Writes the page of a shape into a folder, which is made if it does not exist; returns its path.
pub(super) fn write(
    folder: &Path,
    arguments: &ShapeArguments,
    file: &ShapeFile,
    table: kit::Kit,
    solved: &Solved,
) -> Result<PathBuf, CommandError> {
    let of = |path: &Option<PathBuf>| {
        path.as_deref().and_then(Path::file_name).unwrap_or_default().to_string_lossy().into_owned()
    };
    let output = arguments.output.as_deref().unwrap_or(Path::new(""));
    let positions = solved.modes.first().map_or(1, |mode| mode.gains.len());
    let slowest = solved.modes.iter().map(|mode| mode.decay_per_s).fold(f64::INFINITY, f64::min);
    let ring_s = 3.0 * std::f64::consts::LN_10 / slowest;
    let bar = progress(positions as u64, "rendering the strikes");
    let sounds = shape_sound::strikes(output, table, positions, ring_s, || bar.inc(1))?;
    bar.finish_and_clear();
    std::fs::create_dir_all(folder).map_err(|cause| ::kit::file::FileError {
        action: "made",
        path: folder.to_owned(),
        cause,
    })?;
    let path = folder.join(SHAPE_PAGE_FILE);
    let page = ShapePage {
        name: &file.name,
        file: &of(&arguments.input),
        table: &of(&arguments.output),
        kind: file.shape.kind,
        material: file.material.name.as_deref(),
        error: arguments.error,
        solved,
        sounds: &sounds,
        rate_hz: shape_sound::RATE_HZ,
    };
    write_shape_page(&path, &page)?;
    Ok(path)
}
