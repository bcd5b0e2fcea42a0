//! Whole files: they are read at once, and written under another name before they get their own.

use std::fs::{self, File, OpenOptions};
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU32, Ordering};

/// Failure to read or write a file, or to make a folder.
#[derive(Debug, thiserror::Error)]
#[error("{}: {}", path.display(), self.reason())]
pub struct FileError {
    /// The failed action: `read`, `written` or `made`.
    pub action: &'static str,
    /// Path of the file or folder.
    pub path: PathBuf,
    /// Error of the operating system.
    #[source]
    pub cause: io::Error,
}

impl FileError {
    /// Failed action and the operating system's reason in words, and what to do about it, without
    /// the path.
    ///
    /// The number that the standard library adds to a reason is left out.
    pub fn reason(&self) -> String {
        let Self { action, cause, .. } = self;
        let cause_text = cause.to_string();
        let reason = cause_text.split(" (os error").next().unwrap_or_default();
        let advice = match (*action, cause.kind()) {
            ("read", io::ErrorKind::NotFound) => "; check its name and folder",
            ("read", io::ErrorKind::IsADirectory) => "; give a file in it",
            ("written", io::ErrorKind::NotFound) => "; make its folder first",
            _ => "",
        };
        format!("cannot be {action}: {reason}{advice}")
    }
}

/// Reads a whole file into memory.
///
/// # Errors
/// [`FileError`] with the path and the reason.
pub fn read_whole(path: &Path) -> Result<Vec<u8>, FileError> {
    fs::read(path).map_err(|cause| FileError { action: "read", path: path.to_owned(), cause })
}

/// Writes a whole file so that, whatever happens, it has either its old content or the new one.
///
/// The bytes go to a new file in the same folder, which is synced and then renamed to `path`. A
/// link is followed, and an existing file keeps its permissions. If `path` exists but is not a
/// regular file, such as a pipe or a terminal, it is written to directly.
///
/// # Errors
/// [`FileError`] with the path and the reason. No new file is left behind.
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
        // The first error is reported. If removing fails, too, its cause is the same.
        let _ = fs::remove_file(&beside);
    }
    written
}

/// Creates a new file in the folder of `target`, under a name that no other process or thread uses.
fn create_beside(target: &Path) -> io::Result<(PathBuf, File)> {
    static NEXT: AtomicU32 = AtomicU32::new(0);
    loop {
        let number = NEXT.fetch_add(1, Ordering::Relaxed);
        let beside = target.with_file_name(format!(".malleus-{}-{number}.part", std::process::id()));
        match OpenOptions::new().write(true).create_new(true).open(&beside) {
            Ok(file) => return Ok((beside, file)),
            // The file was left by a killed process that had this process's id.
            Err(error) if error.kind() == io::ErrorKind::AlreadyExists => {}
            Err(error) => return Err(error),
        }
    }
}
