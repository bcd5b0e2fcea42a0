//! The text form of a kit: TOML, for people and for version control.
//!
//! `docs/kit-format.md` lists all keys. A kit's own file may include table files of this format,
//! which hold objects and strikers. Numbers are read as f64 and rounded to f32.

mod assembly;
mod document;
mod filters;
mod message;
mod number;
mod origin;
mod pair;
mod residual;
mod source;
mod surface;
mod trigger;
mod write;

pub use source::{FORMAT, SourceText, UNTITLED};
pub use write::write;

use serde::Deserialize;
use toml::Spanned;

use crate::binary;
use crate::content::Kit;
use crate::error::{KitError, Location};
use assembly::Assembly;
use document::Document;

/// Reads a kit from text and checks it by building its binary form.
///
/// `include` fetches each file that the text includes, by the name that the text gives. The objects
/// and strikers of included files come first, in the order of the list, then those of the text.
///
/// # Errors
/// [`KitError`] with file, line and column: for text that is not TOML, for keys that are unknown,
/// missing or of the wrong type, for names that do not exist or exist twice, and for all that
/// [`binary::build`] refuses.
pub fn parse(
    main: &SourceText,
    mut include: impl FnMut(&str) -> Result<SourceText, KitError>,
) -> Result<Kit, KitError> {
    let document = read_document(main)?;
    let mut included = Vec::new();
    for name in &document.include {
        let source = include(name.get_ref()).map_err(|cause| KitError::Include {
            at: Location::of(&main.file, &main.text, name.span().start),
            cause: Box::new(cause),
        })?;
        let document = read_document(&source)?;
        check_included(&source, &document, &main.file)?;
        included.push((source, document));
    }
    if document.name.is_none() && !document.pad.is_empty() {
        return Err(KitError::MissingName { file: main.file.clone() });
    }
    let mut assembly = Assembly::new(main, document.name.as_ref());
    for (source, mut document) in included {
        // A table's room is that of its recording; a table may be played in any room.
        document.room.clear();
        assembly.add(&source, document)?;
    }
    assembly.add(main, document)?;
    let (kit, origins) = assembly.finish();
    binary::build(&kit).map_err(|error| origins.locate(error))?;
    Ok(kit)
}

/// Part of the text that says which version of the format it has, in every version.
#[derive(Deserialize)]
struct Version {
    format: Spanned<i64>,
}

fn read_document(source: &SourceText) -> Result<Document, KitError> {
    let SourceText { file, text } = source;
    let refusal = |error: toml::de::Error| KitError::Toml {
        at: Location::of(file, text, error.span().map_or(0, |span| span.start)),
        message: message::plain(error.message()),
    };
    // The version is checked first, since a newer one may have keys that this crate calls unknown.
    let version: Version = toml::from_str(text).map_err(refusal)?;
    if *version.format.get_ref() != FORMAT {
        return Err(KitError::FormatVersion {
            at: Location::of(file, text, version.format.span().start),
            found: version.format.into_inner(),
            known: FORMAT,
        });
    }
    toml::from_str(text).map_err(refusal)
}

fn check_included(source: &SourceText, document: &Document, by: &str) -> Result<(), KitError> {
    let at = |offset| Location::of(&source.file, &source.text, offset);
    if let Some(name) = document.include.first() {
        return Err(KitError::NestedInclude {
            at: at(name.span().start),
            named: name.get_ref().clone(),
            by: by.to_owned(),
        });
    }
    if let Some(background) = &document.background {
        return Err(KitError::BackgroundInInclude { at: at(background.span().start), by: by.to_owned() });
    }
    if let Some(pad) = document.pad.first() {
        return Err(KitError::PadInInclude { at: at(pad.span().start), by: by.to_owned() });
    }
    Ok(())
}
