//! Kits from files.

use std::path::Path;

use dsp_core::table::Kit as TableView;
use dsp_core::table::layout::MAGIC;

use crate::content::Kit;
use crate::error::KitError;
use crate::statistics::Statistics;
use crate::text::SourceText;
use crate::{binary, file, text};

/// Kit that has been read and checked, with its binary form.
#[derive(Clone, Debug)]
pub struct Loaded {
    /// Content of the kit.
    pub kit: Kit,
    /// Binary form of the kit, for [`dsp_core::table::Kit::parse`].
    ///
    /// For a binary file these are its own bytes, up to the end of the kit.
    pub binary: Vec<u8>,
    /// Tags of the sections of a binary file that were skipped, because this version does not know
    /// them.
    ///
    /// These sections are in `binary`, but not in `kit`.
    pub skipped_sections: Vec<String>,
}

impl Loaded {
    /// Statistics of the kit: numbers of modes, ringing times and bytes.
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

/// Reads the file of a kit, text or binary, and the files that it includes.
///
/// A file that begins with `MALL`, or whose name ends in `.bin`, is read as binary, any other as
/// text.
///
/// # Errors
/// [`KitError`] for a file that cannot be read, and for the first thing that is wrong with the kit.
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

fn source_text(path: &Path, bytes: Vec<u8>) -> Result<SourceText, KitError> {
    let file = path.display().to_string();
    match String::from_utf8(bytes) {
        Ok(text) => Ok(SourceText { file, text }),
        Err(error) => Err(KitError::NotText { file, offset: error.utf8_error().valid_up_to() }),
    }
}
