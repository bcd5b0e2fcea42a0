//! Tables of a separation: those that are known, and those that it writes.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use ::fit::segment::Hit;
use ::fit::separate::{KnownModes, PartMode};
use ::fit::strike::{Fit, Mode, Strike};
use ::fit::table::{self, Provenance};
use ::kit::Kit;

/// Kind of a part of a recording.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    Object,
    Striker,
}

impl Kind {
    /// Name of the option and ending of the files of this kind.
    pub(super) fn name(self) -> &'static str {
        match self {
            Self::Object => "object",
            Self::Striker => "striker",
        }
    }
}

/// Refusal of a known table.
#[derive(Debug, thiserror::Error)]
pub(crate) enum KnownError {
    #[error("--{kind} {name:?}: no recording has this {kind}; the labels name {}", labels.join(", "))]
    NotLabelled { kind: &'static str, name: String, labels: Vec<String> },
    #[error("--{kind} {name:?} is given twice: give one table for it")]
    Twice { kind: &'static str, name: String },
    #[error("{}: the table holds no {kind} with modes: give a table that malleus separate or malleus fit wrote", path.display())]
    NoModes { kind: &'static str, path: PathBuf },
}

/// Modes of the tables that `--object` or `--striker` name, by the index of their label.
///
/// # Errors
/// [`KnownError`], or the error of reading a table.
pub(super) fn known(
    kind: Kind,
    options: &[String],
    labels: &[String],
) -> Result<Vec<Option<KnownModes>>, super::error::CommandError> {
    let mut known = vec![None; labels.len()];
    for option in options {
        let (name, path) = (option.split_once('=').map(|(name, _)| name), path_of(option));
        let stem = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        let ending = format!("-{}", kind.name());
        let name = name.map_or_else(|| stem.strip_suffix(&ending).unwrap_or(&stem).to_owned(), str::to_owned);
        let index = labels.iter().position(|label| *label == name).ok_or_else(|| KnownError::NotLabelled {
            kind: kind.name(),
            name: name.clone(),
            labels: labels.to_vec(),
        })?;
        let modes = modes_of(kind, path)?;
        if known[index].replace(modes).is_some() {
            return Err(KnownError::Twice { kind: kind.name(), name }.into());
        }
    }
    Ok(known)
}

/// Path of the table that `--object` or `--striker` names.
pub(super) fn path_of(option: &str) -> &Path {
    Path::new(option.split_once('=').map_or(option, |(_, path)| path))
}

/// Paths of the tables that a separation writes into a folder, by the index of their label.
pub(super) fn written(folder: &Path, kind: Kind, names: &[String]) -> Vec<PathBuf> {
    let mut taken: BTreeMap<String, usize> = BTreeMap::new();
    let path = |name: &String| {
        // Two names may differ in characters only that a file's name cannot have.
        let stem: String =
            name.chars().map(|c| if c.is_alphanumeric() || "-_ .".contains(c) { c } else { '-' }).collect();
        let count = taken.entry(stem.to_lowercase()).or_default();
        *count += 1;
        let number = if *count > 1 { format!("-{count}") } else { String::new() };
        folder.join(format!("{stem}{number}-{}.toml", kind.name()))
    };
    names.iter().map(path).collect()
}

fn modes_of(kind: Kind, path: &Path) -> Result<KnownModes, super::error::CommandError> {
    let kit = ::kit::load(path)?.kit;
    let modes = match kind {
        Kind::Object => kit.objects.into_iter().map(|object| object.modes).find(|modes| !modes.is_empty()),
        Kind::Striker => kit.strikers.into_iter().map(|striker| striker.modes).find(|modes| !modes.is_empty()),
    };
    let modes = modes.ok_or_else(|| KnownError::NoModes { kind: kind.name(), path: path.to_owned() })?;
    Ok(modes.iter().map(|mode| (f64::from(mode.frequency_hz), f64::from(mode.decay_per_s))).collect())
}

/// Table of a thing, with a striker of the contact time of its blows, or of a striker.
pub(super) fn of_part(kind: Kind, modes: &[PartMode], contact_time_s: f64, provenance: &Provenance) -> Kit {
    let strike = Strike {
        hit: Hit { onset: 0, end: 0 },
        contact_time_s,
        peak_force: 1.0,
        position: 0.0,
        acceleration: 0.0,
        lsd_db: 0.0,
        residual_db: 0.0,
    };
    let modes = modes.iter().map(|mode| Mode {
        frequency_hz: mode.frequency_hz,
        decay_per_s: mode.decay_per_s,
        gains: vec![mode.gain],
    });
    let fit = Fit { modes: modes.collect(), strikes: vec![strike], ..Fit::silent(44_100.0) };
    let mut table = table::of_fit(&fit, provenance);
    for striker in &mut table.strikers {
        striker.restitution = 1.0;
        if kind == Kind::Striker {
            striker.name = ::kit::item_name(&provenance.name, "");
            striker.modes = std::mem::take(&mut table.objects[0].modes);
        }
    }
    if kind == Kind::Striker {
        table.objects.clear();
    }
    table
}
