//! The measured data that some tests compare with. It lies beside the project and is not part of it.

use std::path::{Path, PathBuf};

/// The path of a data file, or `None`, having said so, where the data are absent.
pub fn find(name: &str) -> Option<PathBuf> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../shared/data").join(name);
    if path.exists() {
        return Some(path);
    }
    println!("ABSENT: {} is not there; this comparison with measured data was not made", path.display());
    None
}
