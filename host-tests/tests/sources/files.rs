//! The Rust files of the repository.

use std::fs;
use std::path::{Path, PathBuf};

/// Rust file of the repository.
pub(crate) struct Source {
    /// Path of the file from the repository's folder.
    pub(crate) path: String,
    pub(crate) text: String,
}

/// Folder of the repository.
pub(crate) fn repository() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

/// Reads all Rust files of all crates, sorted by path. Cargo's build folders are left out.
pub(crate) fn all() -> Vec<Source> {
    let mut found = Vec::new();
    collect(&repository(), "", &mut found);
    found.sort_by(|a, b| a.path.cmp(&b.path));
    assert!(found.len() > 100, "{} Rust files in the repository", found.len());
    found
}

fn collect(folder: &Path, place: &str, found: &mut Vec<Source>) {
    for entry in fs::read_dir(folder).expect("a folder of the repository can be read") {
        let entry = entry.expect("an entry of a folder can be read");
        let name = entry.file_name().to_string_lossy().into_owned();
        let path = entry.path();
        let place = if place.is_empty() { name.clone() } else { format!("{place}/{name}") };
        if path.is_dir() {
            if !name.starts_with('.') && !path.join("CACHEDIR.TAG").exists() {
                collect(&path, &place, found);
            }
        } else if name.ends_with(".rs") {
            let text = fs::read_to_string(&path).expect("a Rust file is text");
            found.push(Source { path: place, text });
        }
    }
}
