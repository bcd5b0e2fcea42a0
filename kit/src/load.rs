//! Kits from files and by name.

use std::path::Path;

use dsp_core::table::Kit as TableView;
use dsp_core::table::layout::MAGIC;

use crate::text::SourceText;
use crate::{Kit, KitError, Statistics, binary, file, shipped, shipped_names, text};

/// A kit that was found and checked.
#[derive(Clone, Debug)]
pub struct Loaded {
    /// What it holds.
    pub kit: Kit,
    /// Its binary form, for [`dsp_core::table::Kit::parse`]; of a binary file the bytes themselves, up to the kit's end.
    pub binary: Vec<u8>,
    /// Tags of the sections of a binary file that were skipped because this version does not know them. They are in
    /// `binary`, not in `kit`.
    pub skipped_sections: Vec<String>,
}

impl Loaded {
    /// Modes, ringing times and bytes.
    pub fn statistics(&self) -> Statistics {
        Statistics::of(&self.kit, self.binary.len())
    }

    pub(crate) fn from_text(
        main: &SourceText,
        include: impl FnMut(&str) -> Result<SourceText, KitError>,
    ) -> Result<Self, KitError> {
        let kit = text::parse(main, include)?;
        let binary = binary::build(&kit)?;
        Ok(Self { kit, binary, skipped_sections: Vec::new() })
    }

    fn from_binary(mut bytes: Vec<u8>) -> Result<Self, KitError> {
        let view = TableView::parse(&bytes)?;
        let skipped_sections = view.skipped_sections().map(|tag| tag.escape_ascii().to_string()).collect();
        let length = view.len_bytes();
        let kit = binary::read(&bytes)?;
        bytes.truncate(length);
        Ok(Self { kit, binary: bytes, skipped_sections })
    }
}

/// Reads a kit's file, text or binary, with the files that it includes.
///
/// A file that begins with `MALL`, or whose name ends in `.bin`, is binary, any other is text.
///
/// # Errors
/// [`KitError`] for a file that cannot be read and for the first thing that is wrong with the kit.
pub fn load(path: &Path) -> Result<Loaded, KitError> {
    let bytes = file::read_whole(path)?;
    let is_bin = path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("bin"));
    if bytes.starts_with(&MAGIC) || is_bin {
        return Loaded::from_binary(bytes).map_err(|error| match error {
            KitError::Binary { error, .. } => KitError::Binary { file: Some(path.display().to_string()), error },
            other => other,
        });
    }
    let folder = path.parent().unwrap_or(Path::new(""));
    Loaded::from_text(&source_text(path, bytes)?, |include| {
        let path = folder.join(include);
        source_text(&path, file::read_whole(&path)?)
    })
}

/// Opens a kit by the name of a shipped one (`demo`) or by the path of its file.
///
/// A shipped name goes first, so that it means the same in every folder; `./demo` is a file.
///
/// # Errors
/// [`KitError::UnknownKit`], with the names of the shipped kits, if it is neither; else as [`load`].
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

fn source_text(path: &Path, bytes: Vec<u8>) -> Result<SourceText, KitError> {
    let file = path.display().to_string();
    match String::from_utf8(bytes) {
        Ok(text) => Ok(SourceText { file, text }),
        Err(error) => Err(KitError::NotText { file, offset: error.utf8_error().valid_up_to() }),
    }
}
