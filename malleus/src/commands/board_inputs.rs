//! Inputs and outputs of `malleus board run`, which are checked before the run.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use dsp_core::table::layout::MAGIC;
use virtual_board::{Board, PiezoPin, PiezoSignal};

use super::board::RunArguments;
use super::error::CommandError;
use super::output::{refuse_input, refuse_same};

/// Refusal of an input of `malleus board run`.
#[derive(Debug, thiserror::Error)]
pub(crate) enum BoardInputError {
    #[error(
        "{}: is a kit as text, and a board reads binary kits; make one by `malleus kit build {} -o KIT.bin`, and give that",
        file.display(), file.display()
    )]
    TextKit { file: PathBuf },
    #[error("{}: is no binary kit, which begins with MALL; give one that malleus kit build made", file.display())]
    NoKit { file: PathBuf },
    #[error("--pins names {parts} parts, and {board} has {piezos} piezos; name at most {piezos}")]
    TooManyPins { parts: usize, board: &'static str, piezos: usize },
    #[error("--piezo gives piezo {piezo} two signals; give one, or add them up in one file")]
    PiezoTwice { piezo: usize },
    #[error(
        "{}: cannot reach the board, because --pins wires no piezo to pin {piezo}; give `piezo` there, or leave the signal out",
        file.display()
    )]
    NoPiezo { piezo: usize, file: PathBuf },
}

/// Checks that the outputs are different files that the command does not read, and that they can be
/// written.
///
/// # Errors
/// [`CommandError`] with the first output that is refused.
pub(super) fn check_outputs(arguments: &RunArguments) -> Result<(), CommandError> {
    let outputs = [&arguments.output, &arguments.midi_out];
    let outputs: Vec<&Path> = outputs.into_iter().flatten().map(PathBuf::as_path).collect();
    let named = [Some(&arguments.image), arguments.kit.as_ref(), arguments.midi.as_ref(), arguments.sysex.as_ref()];
    let signals = arguments.piezo.iter().map(|piezo| piezo_and_file(piezo).1);
    let inputs: Vec<&Path> = named.into_iter().flatten().map(PathBuf::as_path).chain(signals).collect();
    refuse_same(&outputs)?;
    for output in outputs {
        refuse_input(output, inputs.iter().copied())?;
        kit::file::check_writable(output)?;
    }
    Ok(())
}

/// Reads a file whole.
///
/// # Errors
/// [`CommandError::Unreadable`] with its path.
pub(super) fn read(path: &Path) -> Result<Vec<u8>, CommandError> {
    std::fs::read(path).map_err(|error| CommandError::Unreadable { file: path.display().to_string(), error })
}

/// Reads a binary kit. What is wrong in it is for the firmware to find.
///
/// # Errors
/// [`CommandError`] for a file that cannot be read, or that is no binary kit.
pub(super) fn read_kit(path: &Path) -> Result<Vec<u8>, CommandError> {
    let bytes = read(path)?;
    if bytes.starts_with(&MAGIC) {
        return Ok(bytes);
    }
    let file = path.to_owned();
    let is_text = path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("toml"));
    let refused = if is_text { BoardInputError::TextKit { file } } else { BoardInputError::NoKit { file } };
    Err(refused.into())
}

/// Returns the parts at the pins of a board's piezos.
///
/// # Errors
/// [`BoardInputError::TooManyPins`] if there are more parts than pins.
pub(super) fn pins(arguments: &RunArguments) -> Result<Vec<PiezoPin>, BoardInputError> {
    let (parts, piezos) = (arguments.pins.len(), arguments.board.wiring().piezos.len());
    match parts > piezos {
        true => Err(BoardInputError::TooManyPins { parts, board: Board::name(arguments.board), piezos }),
        false => Ok(arguments.pins.iter().map(|&part| part.into()).collect()),
    }
}

/// Reads the signals of the piezos, at most one for each.
///
/// # Errors
/// [`CommandError`] for a file that cannot be read, a second signal of a piezo, or a pin without a
/// piezo.
pub(super) fn signals(arguments: &RunArguments, pins: &[PiezoPin]) -> Result<Vec<PiezoSignal>, CommandError> {
    let mut seen = BTreeSet::new();
    let mut signals = Vec::new();
    for (piezo, file) in arguments.piezo.iter().map(|argument| piezo_and_file(argument)) {
        if !seen.insert(piezo) {
            return Err(BoardInputError::PiezoTwice { piezo }.into());
        }
        if pins.get(piezo).is_some_and(|&part| part != PiezoPin::Circuit) {
            return Err(BoardInputError::NoPiezo { piezo, file: file.to_owned() }.into());
        }
        signals.push(PiezoSignal::from_wav(piezo, arguments.piezo_start, file)?);
    }
    Ok(signals)
}

/// Returns the number of the piezo and the file of its signal, which `[PIEZO=]HIT.wav` names.
fn piezo_and_file(argument: &str) -> (usize, &Path) {
    let numbered = argument.split_once('=').and_then(|(piezo, path)| Some((piezo.parse().ok()?, path)));
    let (piezo, path) = numbered.unwrap_or((0, argument));
    (piezo, Path::new(path))
}
