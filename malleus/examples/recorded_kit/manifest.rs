//! Manifest of the recordings: their origins and licences.

use std::path::Path;

use crate::failure::Failure;

/// Beginnings of the licences that ask for no credit beyond the notices in `tables/LICENSES.md`.
const WITHOUT_CREDIT: [&str; 3] = ["CC0", "MIT", "BSD"];

/// Origin and licence of a recording.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Origin {
    /// Repository, path and version.
    pub(crate) source: String,
    /// Identifier of the licence, without the manifest's remarks.
    pub(crate) licence: String,
}

/// Reads the origin of a recording from `MANIFEST.csv` in its folder.
///
/// # Errors
/// A message if the manifest cannot be read or does not list the file, or if the licence asks for
/// credit.
pub(crate) fn origin(recordings: &Path, file: &str) -> Result<Origin, Failure> {
    let path = recordings.join("MANIFEST.csv");
    let mut manifest = csv::Reader::from_path(&path).map_err(|error| format!("{}: {error}", path.display()))?;
    let columns = manifest.headers()?.clone();
    let column = |name: &str| {
        let at = columns.iter().position(|column| column == name);
        at.ok_or_else(|| format!("{}: no column {name:?}", path.display()))
    };
    let at = [column("file")?, column("source")?, column("commit_or_version")?, column("licence")?];
    for row in manifest.records() {
        let row = row?;
        let [name, source, version, licence] = at.map(|at| row.get(at).unwrap_or_default());
        if name != file {
            continue;
        }
        let licence = licence.split_whitespace().next().unwrap_or_default();
        if !WITHOUT_CREDIT.iter().any(|known| licence.starts_with(known)) {
            return Err(format!("{file}: licence {licence:?}: the kit takes {} only", WITHOUT_CREDIT.join(", ")).into());
        }
        let version: String = version.chars().take(12).collect();
        return Ok(Origin { source: format!("{source} at {version}"), licence: licence.to_owned() });
    }
    Err(format!("{}: does not list {file}", path.display()).into())
}
