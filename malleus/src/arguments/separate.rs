//! Arguments of `malleus separate`.

use std::path::PathBuf;

use clap::Args;

use super::parse_modes;

/// Arguments of `malleus separate`.
#[derive(Debug, Args)]
pub(crate) struct SeparateArguments {
    /// Recordings: WAV, FLAC, AIFF, Ogg Vorbis, MP3, AAC, ALAC or CAF
    #[arg(required = true, value_name = "RECORDING")]
    pub(crate) input: Vec<PathBuf>,
    /// Who strikes what: CSV in UTF-8 with the columns recording,object,striker, one line a
    /// recording, named by its path or by its file's name
    #[arg(long, value_name = "LABELS.csv")]
    pub(crate) labels: PathBuf,
    /// Folder for the stems NAME-object.wav, NAME-striker.wav and NAME-rest.wav and the tables; it
    /// is made if it does not exist
    #[arg(short, long, value_name = "DIR")]
    pub(crate) output: PathBuf,
    /// Known table of a thing, whose modes are kept; without NAME it is that of the thing called
    /// like the file
    #[arg(long, value_name = "[NAME=]TABLE.toml")]
    pub(crate) object: Vec<String>,
    /// Known table of a striker, whose modes are kept; without NAME it is that of the striker
    /// called like the file
    #[arg(long, value_name = "[NAME=]TABLE.toml")]
    pub(crate) striker: Vec<String>,
    /// Maximum number of modes of each thing and of each striker
    #[arg(long, value_name = "N", default_value = "40", value_parser = parse_modes)]
    pub(crate) modes: usize,
    /// Materials to choose from [default: all that are known]
    #[arg(long, value_name = "NAME,NAME", value_delimiter = ',')]
    pub(crate) materials: Vec<String>,
    /// Licence of the recordings, kept in the tables
    #[arg(long, value_name = "TEXT", default_value = "")]
    pub(crate) licence: String,
    /// Print a machine-readable report on stdout (docs/json.md)
    #[arg(long)]
    pub(crate) json: bool,
}
