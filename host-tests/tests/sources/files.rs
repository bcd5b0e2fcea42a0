//! The Rust and assembly files of the repository.

use std::fs;
use std::path::{Path, PathBuf};

/// Rust or assembly file of the repository.
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
    let found = with_ending(".rs");
    assert!(found.len() > 100, "{} Rust files in the repository", found.len());
    found
}

/// Reads all assembly files of all crates, sorted by path.
pub(crate) fn assembly() -> Vec<Source> {
    let found = with_ending(".s");
    assert!(found.len() > 5, "{} assembly files in the repository", found.len());
    found
}

fn with_ending(ending: &str) -> Vec<Source> {
    let mut found = Vec::new();
    collect(&repository(), "", ending, &mut found);
    found.sort_by(|a, b| a.path.cmp(&b.path));
    found
}

fn collect(folder: &Path, place: &str, ending: &str, found: &mut Vec<Source>) {
    for entry in fs::read_dir(folder).expect("a folder of the repository can be read") {
        let entry = entry.expect("an entry of a folder can be read");
        let name = entry.file_name().to_string_lossy().into_owned();
        let path = entry.path();
        let place = if place.is_empty() { name.clone() } else { format!("{place}/{name}") };
        if path.is_dir() {
            if !name.starts_with('.') && !path.join("CACHEDIR.TAG").exists() {
                collect(&path, &place, ending, found);
            }
        } else if name.ends_with(ending) {
            let text = fs::read_to_string(&path).expect("a source file is text");
            found.push(Source { path: place, text });
        }
    }
}
