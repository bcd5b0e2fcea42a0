//! Kits by name: shipped ones, or files.

use std::path::Path;

use crate::error::KitError;
use crate::load::{Loaded, load};
use crate::shipped::{shipped, shipped_names};

/// Opens a kit by the name of a shipped one (`demo`) or by the path of its file.
///
/// A shipped kit goes before a file of the same name, so that its name means the same in every
/// folder. `./demo` is always a file.
///
/// # Errors
/// [`KitError::UnknownKit`], with the names of the shipped kits, if the name is neither that of a
/// shipped kit nor that of a file; else the errors of [`load`].
pub fn open(name_or_path: &str) -> Result<Loaded, KitError> {
    if let Some(loaded) = shipped(name_or_path) {
        return loaded;
    }
    let path = Path::new(name_or_path);
    if matches!(path.try_exists(), Ok(false)) {
        return Err(KitError::UnknownKit { name: name_or_path.to_owned(), shipped: shipped_names().collect() });
    }
    load(path)
}
