//! Whole files: read at once, written beside their place and then renamed into it.

use std::fs::{self, File, OpenOptions};
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU32, Ordering};

/// A file that cannot be read or written.
#[derive(Debug, thiserror::Error)]
#[error("{}: cannot be {action}: {cause}", path.display())]
pub struct FileError {
    /// `read` or `written`.
    pub action: &'static str,
    /// The file.
    pub path: PathBuf,
    /// Why.
    #[source]
    pub cause: io::Error,
}

/// Reads a whole file.
///
/// # Errors
/// [`FileError`] with path and cause.
pub fn read_whole(path: &Path) -> Result<Vec<u8>, FileError> {
    fs::read(path).map_err(|cause| FileError { action: "read", path: path.to_owned(), cause })
}

/// Writes a whole file so that, whatever happens, either the old content stands there or the new one.
///
/// The bytes go to a new file in the same folder, which is synced and renamed onto `path`; a link is followed, and the
/// permissions of a file that was there stay. What is there but is no regular file (a pipe, a terminal) is written to directly.
///
/// # Errors
/// [`FileError`] with path and cause; nothing is left behind.
pub fn write_whole(path: &Path, bytes: &[u8]) -> Result<(), FileError> {
    try_write(path, bytes).map_err(|cause| FileError { action: "written", path: path.to_owned(), cause })
}

fn try_write(path: &Path, bytes: &[u8]) -> io::Result<()> {
    let existing = fs::metadata(path).ok();
    if existing.as_ref().is_some_and(|there| !there.is_file()) {
        return OpenOptions::new().write(true).open(path)?.write_all(bytes);
    }
    let target = if existing.is_some() { fs::canonicalize(path)? } else { path.to_owned() };
    let (beside, mut file) = create_beside(&target)?;
    let written = file
        .write_all(bytes)
        .and_then(|()| existing.map_or(Ok(()), |there| file.set_permissions(there.permissions())))
        .and_then(|()| file.sync_all())
        .and_then(|()| fs::rename(&beside, &target));
    if written.is_err() {
        // The first error is the one to report; should removing fail too, its cause is the same.
        let _ = fs::remove_file(&beside);
    }
    written
}

/// A new file in the folder of `target`, under a name that no other process or thread uses.
fn create_beside(target: &Path) -> io::Result<(PathBuf, File)> {
    static NEXT: AtomicU32 = AtomicU32::new(0);
    loop {
        let number = NEXT.fetch_add(1, Ordering::Relaxed);
        let beside = target.with_file_name(format!(".malleus-{}-{number}.part", std::process::id()));
        match OpenOptions::new().write(true).create_new(true).open(&beside) {
            Ok(file) => return Ok((beside, file)),
            // Left by a process of the same id that was killed.
            Err(error) if error.kind() == io::ErrorKind::AlreadyExists => {}
            Err(error) => return Err(error),
        }
    }
}
