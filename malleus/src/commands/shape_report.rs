//! `malleus shape --report`: the page of a shape.

use std::path::{Path, PathBuf};

use ::kit::file::FileError;
use ::shape::file::ShapeFile;
use ::shape::solve::Solved;
use malleus::report::{SHAPE_PAGE_FILE, ShapePage, is_shape_page, shape_html};

use super::error::CommandError;
use super::output::progress;
use super::shape::ShapeError;
use super::shape_sound;
use crate::arguments::ShapeArguments;

/// Checks that a page can be written into a folder, before anything is solved; returns the path of
/// the page.
///
/// # Errors
/// [`ShapeError`] if the folder is a file, or holds another page under the same name, and the
/// system's reason if the folder cannot be made or written to.
pub(super) fn check(folder: &Path) -> Result<PathBuf, CommandError> {
    let there = std::path::absolute(folder).unwrap_or(folder.to_owned());
    let there = there.ancestors().find(|folder| folder.exists()).unwrap_or(folder);
    if !there.is_dir() {
        return Err(ShapeError::ReportIsFile { path: there.to_owned() }.into());
    }
    let page = folder.join(SHAPE_PAGE_FILE);
    let is_other = page.exists() && !std::fs::read_to_string(&page).is_ok_and(|html| is_shape_page(&html));
    if is_other {
        return Err(ShapeError::OtherPage { path: page }.into());
    }
    // No file has this name.
    let beside = there.join(".malleus-page");
    let as_folder = |error: FileError| FileError { path: folder.to_owned(), ..error };
    ::kit::file::check_writable(&beside).map_err(as_folder)?;
    Ok(page)
}

/// Makes a folder and those around it; returns the ones that did not exist, the outermost first.
pub(super) fn make(folder: &Path) -> Result<Vec<PathBuf>, FileError> {
    let missing = folder.ancestors().take_while(|folder| !folder.as_os_str().is_empty() && !folder.exists());
    let mut made: Vec<PathBuf> = missing.map(Path::to_owned).collect();
    made.reverse();
    let failed = |cause| FileError { action: "made", path: folder.to_owned(), cause };
    std::fs::create_dir_all(folder).map_err(failed)?;
    Ok(made)
}

/// Makes the page of a shape, which is to be written to a path.
pub(super) fn page(
    path: &Path,
    arguments: &ShapeArguments,
    file: &ShapeFile,
    table: kit::Kit,
    solved: &Solved,
) -> Result<String, CommandError> {
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
    Ok(shape_html(path, &page)?)
}
