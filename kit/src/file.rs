//! Whole files: they are read at once, and written under another name before they get their own.

use std::fs::{self, File, OpenOptions};
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU32, Ordering};
use std::time::Duration;

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
        let is_folder_needed = matches!(cause.kind(), io::ErrorKind::AlreadyExists | io::ErrorKind::NotADirectory);
        if *action == "made" && is_folder_needed {
            return "cannot be made: there is a file where a folder is needed; give another path".to_owned();
        }
        let advice = match (*action, cause.kind()) {
            ("read", io::ErrorKind::NotFound) => "; check its name and folder",
            ("read", io::ErrorKind::IsADirectory) => "; give a file in it",
            ("written", io::ErrorKind::NotFound) => "; make its folder first",
            ("written", io::ErrorKind::IsADirectory) => "; give a file in it",
            ("read" | "written", io::ErrorKind::NotADirectory) => "; what should be its folder is a file",
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
    write_together(&[(path, bytes)])
}

/// Writes several files as [`write_whole`] does: the first one gets its name when the bytes of all
/// are on the disk.
///
/// # Errors
/// [`FileError`] with the first path that cannot be written, and the reason. No new file is left
/// behind, and no old one changed, unless a rename fails after another one.
pub fn write_together(files: &[(&Path, &[u8])]) -> Result<(), FileError> {
    let failed = |path: &Path| {
        let path = path.to_owned();
        move |cause| FileError { action: "written", path, cause }
    };
    let stage = |&(path, bytes): &(&Path, &[u8])| Staged::new(path, bytes).map_err(failed(path));
    let staged = files.iter().map(stage).collect::<Result<Vec<Staged>, FileError>>()?;
    staged.into_iter().zip(files).try_for_each(|(staged, (path, bytes))| staged.place(bytes).map_err(failed(path)))
}

/// Checks that a file can be written: that its folder exists and takes files, and that the path
/// leads to no folder. Leaves nothing behind. Pipes and terminals are not opened.
///
/// # Errors
/// [`FileError`] with the path and the reason.
pub fn check_writable(path: &Path) -> Result<(), FileError> {
    let checked = match fs::metadata(path) {
        Ok(there) if there.is_dir() => Err(io::ErrorKind::IsADirectory.into()),
        Ok(there) if !there.is_file() => Ok(()),
        _ => Staged::new(path, &[]).map(drop),
    };
    checked.map_err(|cause| FileError { action: "written", path: path.to_owned(), cause })
}

/// File whose bytes are on the disk under another name, which is removed unless it is placed.
enum Staged {
    Beside {
        beside: PathBuf,
        target: PathBuf,
    },
    /// Pipe or terminal.
    Open(File),
}

impl Staged {
    fn new(path: &Path, bytes: &[u8]) -> io::Result<Self> {
        let existing = fs::metadata(path).ok();
        if existing.as_ref().is_some_and(|there| !there.is_file()) {
            return Ok(Self::Open(OpenOptions::new().write(true).open(path)?));
        }
        let target = if existing.is_some() { fs::canonicalize(path)? } else { path.to_owned() };
        let (beside, mut file) = create_beside(&target)?;
        let staged = Self::Beside { beside, target };
        file.write_all(bytes)?;
        if let Some(there) = existing {
            file.set_permissions(there.permissions())?;
        }
        file.sync_all()?;
        Ok(staged)
    }

    /// Gives the file its name, or a pipe its bytes.
    fn place(mut self, bytes: &[u8]) -> io::Result<()> {
        match &mut self {
            Self::Beside { beside, target } => fs::rename(beside, target),
            Self::Open(file) => file.write_all(bytes),
        }
    }
}

impl Drop for Staged {
    fn drop(&mut self) {
        if let Self::Beside { beside, .. } = self {
            // After a rename there is nothing to remove. The first error of a failure is reported;
            // if removing fails, too, its cause is the same.
            let _ = fs::remove_file(beside);
        }
    }
}

/// Creates a new file in the folder of `target`, under a name that no other process or thread uses.
fn create_beside(target: &Path) -> io::Result<(PathBuf, File)> {
    static NEXT: AtomicU32 = AtomicU32::new(0);
    loop {
        let number = NEXT.fetch_add(1, Ordering::Relaxed);
        let beside = target.with_file_name(format!(".malleus-{}-{number}.part", std::process::id()));
        match OpenOptions::new().write(true).create_new(true).open(&beside) {
            Ok(file) => {
                target.parent().into_iter().for_each(remove_left);
                return Ok((beside, file));
            }
            // The file was left by a killed process that had this process's id.
            Err(error) if error.kind() == io::ErrorKind::AlreadyExists => {}
            Err(error) => return Err(error),
        }
    }
}

/// Age of a file that was left by a process, beyond which it is removed. Where several machines
/// share a folder, the processes of the others are not known.
const LEFT_FOR: Duration = Duration::from_secs(60);

/// Removes the files that processes which were killed have left in a folder, where the system tells
/// which processes run.
fn remove_left(folder: &Path) {
    let processes = Path::new("/proc");
    let folder = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
    let (true, Ok(entries)) = (processes.join("self").exists(), fs::read_dir(folder)) else { return };
    for entry in entries.flatten() {
        let name = entry.file_name();
        let numbers = name.to_str().and_then(|name| name.strip_prefix(".malleus-")?.strip_suffix(".part"));
        let process = numbers.and_then(|numbers| numbers.split_once('-')?.0.parse::<u32>().ok());
        let is_running = process.is_none_or(|process| processes.join(process.to_string()).exists());
        let age = entry.metadata().and_then(|there| there.modified()).ok().and_then(|time| time.elapsed().ok());
        if !is_running && age.is_some_and(|age| age > LEFT_FOR) {
            // A file that cannot be removed does no harm to the one that is written.
            let _ = fs::remove_file(entry.path());
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::time::SystemTime;

    #[test]
    fn files_of_processes_that_were_killed_are_removed_by_the_next_one() {
        let folder = std::env::temp_dir().join(format!("malleus-left-{}", std::process::id()));
        fs::create_dir_all(&folder).expect("made");
        // No process has a number this large.
        let left = folder.join(format!(".malleus-{}-0.part", u32::MAX));
        let own = folder.join(format!(".malleus-{}-4000000000.part", std::process::id()));
        let fresh = folder.join(format!(".malleus-{}-1.part", u32::MAX));
        for path in [&left, &own, &fresh] {
            let file = File::create(path).expect("written");
            let age = if *path == fresh { Duration::ZERO } else { 2 * LEFT_FOR };
            file.set_modified(SystemTime::now() - age).expect("set");
        }
        write_whole(&folder.join("new"), b"new").expect("written");
        assert_eq!(left.exists(), !Path::new("/proc/self").exists());
        assert!(own.exists() && fresh.exists() && folder.join("new").exists());
        fs::remove_dir_all(&folder).expect("removed");
    }

    #[test]
    fn files_that_are_written_together_stay_as_they_were_if_one_cannot_be() {
        let folder = std::env::temp_dir().join(format!("malleus-together-{}", std::process::id()));
        fs::create_dir_all(&folder).expect("made");
        let (old, new, missing) = (folder.join("old"), folder.join("new"), folder.join("missing/file"));
        fs::write(&old, "old").expect("written");
        let names = || fs::read_dir(&folder).expect("a folder").count();
        for last in [missing.as_path(), folder.as_path()] {
            let files: [(&Path, &[u8]); 3] = [(&old, b"changed"), (&new, b"new"), (last, b"never")];
            assert_eq!(write_together(&files).expect_err("refused").path, last);
            assert_eq!((fs::read(&old).expect("there"), names()), (b"old".to_vec(), 1));
            assert!(check_writable(last).is_err());
        }
        assert!(check_writable(&old).is_ok() && check_writable(&new).is_ok());
        assert_eq!((fs::read(&old).expect("there"), names()), (b"old".to_vec(), 1));
        write_together(&[(&old, b"changed"), (&new, b"new")]).expect("written");
        assert_eq!(
            (fs::read(&old).expect("there"), fs::read(&new).expect("there"), names()),
            (b"changed".to_vec(), b"new".to_vec(), 2)
        );
        fs::remove_dir_all(&folder).expect("removed");
    }
}
