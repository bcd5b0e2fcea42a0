//! Files that `malleus shape` writes: all are checked before anything is solved, and the first one
//! is put in its place when all are ready.

use std::path::{Path, PathBuf};

use ::kit::file::{check_writable, write_together};
use ::shape::file::ShapeFile;

use super::error::CommandError;
use super::output::refuse_input;
use super::shape_report;
use crate::arguments::ShapeArguments;

/// Paths that the command writes to.
pub(super) struct Outputs {
    /// All of them.
    paths: Vec<PathBuf>,
    /// Folder of the page, if one was asked for.
    folder: Option<PathBuf>,
    /// Page in that folder.
    pub(super) page: Option<PathBuf>,
}

impl Outputs {
    /// Checks that all outputs can be written, to different files that the command does not read.
    pub(super) fn check(arguments: &ShapeArguments, input: &Path, output: &Path) -> Result<Self, CommandError> {
        let files = [Some(output), arguments.render.as_deref(), arguments.tuned.as_deref()];
        let mut paths: Vec<PathBuf> = files.into_iter().flatten().map(Path::to_owned).collect();
        let page = arguments.report.as_deref().map(shape_report::check).transpose()?;
        paths.extend(page.clone());
        let absolute = |path: &PathBuf| std::path::absolute(path).unwrap_or(path.clone());
        for (number, path) in paths.iter().enumerate() {
            refuse_input(path, [input])?;
            if paths.iter().take(number).any(|other| absolute(other) == absolute(path)) {
                return Err(CommandError::SameOutput { output: path.clone() });
            }
            // The page's folder need not exist yet.
            if page.as_ref() != Some(path) {
                check_writable(path)?;
            }
        }
        Ok(Self { paths, folder: arguments.report.clone(), page })
    }

    /// Refuses to write over a file that the shape file names.
    pub(super) fn refuse_named(&self, input: &Path, file: &ShapeFile) -> Result<(), CommandError> {
        let named = [&file.shape.outline, &file.shape.surface, &file.material.damping];
        let beside = input.parent().unwrap_or(Path::new(""));
        let named: Vec<PathBuf> = named.into_iter().flatten().map(|name| beside.join(name)).collect();
        self.paths.iter().try_for_each(|path| refuse_input(path, named.iter().map(PathBuf::as_path)))
    }

    /// Writes all files, or none of them.
    pub(super) fn write(&self, files: &[(&Path, Vec<u8>)]) -> Result<(), CommandError> {
        let made = self.folder.as_deref().map(shape_report::make).transpose()?.unwrap_or_default();
        let files: Vec<(&Path, &[u8])> = files.iter().map(|(path, bytes)| (*path, bytes.as_slice())).collect();
        let written = write_together(&files);
        if written.is_err() {
            // The first error is reported. Folders that are not empty stay.
            made.iter().rev().for_each(|folder| drop(std::fs::remove_dir(folder)));
        }
        Ok(written?)
    }
}
