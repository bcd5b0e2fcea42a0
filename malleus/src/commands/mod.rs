//! The commands: each reads its files, lets the library work, shows progress and writes.

pub(crate) mod board;
pub(crate) mod demo;
pub(crate) mod fit;
mod fit_filter;
mod fit_names;
pub(crate) mod kit;
mod kit_check;
mod kit_new;
pub(crate) mod play;

use std::io::Write;

use dsp_core::fixed::FULL_SCALE_24_BIT;
use indicatif::{ProgressBar, ProgressStyle};
use malleus::events::EventsError;
use malleus::plot::PlotError;
use malleus::render::instrument::RenderError;
use malleus::wave::WaveError;

/// Why a command failed: what, where, and what to do.
#[derive(Debug, thiserror::Error)]
pub(crate) enum CommandError {
    #[error(transparent)]
    Kit(#[from] ::kit::KitError),
    #[error("{kit}: {error}")]
    Table { kit: String, error: dsp_core::table::TableError },
    #[error(transparent)]
    Events(#[from] EventsError),
    #[error(transparent)]
    Wave(#[from] WaveError),
    #[error(transparent)]
    File(#[from] ::kit::file::FileError),
    #[error(transparent)]
    Plot(#[from] PlotError),
    #[error(transparent)]
    Report(#[from] malleus::report::ReportError),
    #[error("{kit}: {error}")]
    Render { kit: String, error: RenderError },
    #[error("{kit}: object {object:?} at {rate}: {what}")]
    Filters { kit: String, object: String, rate: dsp_core::SampleRate, what: String },
    #[error("{kit}: the reference refuses: {error}")]
    Law { kit: String, error: reference::Error },
    #[error("{kit}: unknown pad {name:?}; the kit has {pads}")]
    UnknownPad { kit: String, name: String, pads: String },
    #[error("{kit}: the kit has no pads: nothing can be played; bind its objects to pads (docs/kit-format.md)")]
    NoPads { kit: String },
    #[error(
        "{file}: its rate is {file_rate}, --rate or --board asks for {rate}; a force is not resampled: leave it out, or convert the file"
    )]
    RateMismatch { file: String, file_rate: dsp_core::SampleRate, rate: dsp_core::SampleRate },
    #[error(
        "{file}: it would play for {seconds:.0} s, at most {longest:.0} are rendered at once; play a part of it, or a shorter --tail"
    )]
    TooLong { file: String, seconds: f64, longest: f64 },
    #[error(transparent)]
    Board(#[from] virtual_board::BoardError),
    #[error("{file} cannot be read: {error}")]
    Unreadable { file: String, error: std::io::Error },
    #[error("the log cannot be written: {error}")]
    Log { error: ::kit::file::FileError },
    #[error("{}: one table cannot hold {inputs} recordings: give a folder", output.display())]
    OneTable { output: std::path::PathBuf, inputs: usize },
    #[error("--render takes one recording at a time, not {inputs}")]
    OneRendering { inputs: usize },
    #[error("{failed} of {of} recordings could not be fitted; the others are written")]
    FitsFailed { failed: usize, of: usize },
    #[error("the report cannot be printed: {0}")]
    Print(#[from] std::io::Error),
    #[error("the report cannot be written as JSON: {0}")]
    Json(#[from] serde_json::Error),
}

/// What a board leaves out of a kit, or why it refuses it; a line each.
fn left_out(kit: &str, board: virtual_board::Board, table: &dsp_core::table::Kit<'_>) -> Vec<String> {
    let name = board.name();
    match malleus::render::board::leaves_out(board, table) {
        Ok(reasons) => reasons.iter().map(|reason| format!("{kit}: {name} leaves out: {reason}")).collect(),
        Err(error) => vec![format!("{kit}: {name} refuses it and plays its built-in kit: {error}")],
    }
}

/// A progress bar on stderr, shown where that is a terminal.
fn progress(length: u64, what: &'static str) -> ProgressBar {
    // A template that indicatif refuses would be a mistake in this line; its own default serves then.
    let style = ProgressStyle::with_template("{msg:28} {wide_bar} {percent:>3} % {eta}");
    ProgressBar::new(length).with_style(style.unwrap_or_else(|_| ProgressStyle::default_bar())).with_message(what)
}

/// Prints to stdout; a reader that has gone away (`| head`) is no failure.
fn print(text: &str) -> Result<(), CommandError> {
    match std::io::stdout().lock().write_all(text.as_bytes()) {
        Err(error) if error.kind() == std::io::ErrorKind::BrokenPipe => Ok(()),
        other => Ok(other?),
    }
}

fn print_json(report: &impl serde::Serialize) -> Result<(), CommandError> {
    print(&format!("{}\n", serde_json::to_string_pretty(report)?))
}

/// Peak of 24-bit frames in dBFS; `None` for silence.
fn peak_dbfs(frames: &[[i32; 2]]) -> Option<f64> {
    let peak = frames.iter().flatten().map(|sample| sample.unsigned_abs()).max().unwrap_or(0);
    (peak > 0).then(|| 20.0 * (f64::from(peak) / f64::from(FULL_SCALE_24_BIT)).log10())
}
