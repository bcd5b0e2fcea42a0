//! Output that the commands share: progress on stderr, text and JSON on stdout.

use std::collections::BTreeSet;
use std::io::{self, Write};
use std::path::Path;

use dsp_core::fixed::FULL_SCALE_24_BIT;
use indicatif::{ProgressBar, ProgressStyle};

use super::error::CommandError;

/// Creates a progress bar of `length` steps on stderr, which is shown only in a terminal.
pub(super) fn progress(length: u64, what: &'static str) -> ProgressBar {
    // indicatif would refuse the template only for a mistake in this line. Its own default serves
    // then.
    let style = ProgressStyle::with_template("{msg:28} {wide_bar} {percent:>3} % {eta}");
    ProgressBar::new(length).with_style(style.unwrap_or_else(|_| ProgressStyle::default_bar())).with_message(what)
}

/// True if a file's name ends in an extension, in upper or lower case.
pub(super) fn has_extension(path: &Path, wanted: &str) -> bool {
    path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case(wanted))
}

/// Refuses to write over a file that the command reads.
///
/// # Errors
/// [`CommandError::OutputIsInput`] if both paths lead to one file.
pub(super) fn refuse_input<'p>(output: &Path, inputs: impl IntoIterator<Item = &'p Path>) -> Result<(), CommandError> {
    // A path that leads nowhere is no file yet.
    let Ok(written) = output.canonicalize() else { return Ok(()) };
    match inputs.into_iter().any(|input| input.canonicalize().is_ok_and(|read| read == written)) {
        true => Err(CommandError::OutputIsInput { output: output.to_owned() }),
        false => Ok(()),
    }
}

/// Refuses two outputs at one path.
///
/// # Errors
/// [`CommandError::SameOutput`] with the first path that is named again.
pub(super) fn refuse_same(outputs: &[&Path]) -> Result<(), CommandError> {
    let absolute = |path: &Path| std::path::absolute(path).unwrap_or(path.to_owned());
    let mut seen = BTreeSet::new();
    match outputs.iter().find(|path| !seen.insert(absolute(path))) {
        Some(again) => Err(CommandError::SameOutput { output: again.to_path_buf() }),
        None => Ok(()),
    }
}

/// Prints text to stdout. A reader that has closed its end, such as `| head`, is no failure.
pub(super) fn print(text: &str) -> Result<(), CommandError> {
    match io::stdout().lock().write_all(text.as_bytes()) {
        Err(error) if error.kind() == io::ErrorKind::BrokenPipe => Ok(()),
        other => Ok(other?),
    }
}

/// Prints a report as JSON to stdout.
pub(super) fn print_json(report: &impl serde::Serialize) -> Result<(), CommandError> {
    print(&format!("{}\n", serde_json::to_string_pretty(report)?))
}

/// Peak of 24-bit frames in dBFS; `None` for silence.
pub(super) fn peak_dbfs(frames: &[[i32; 2]]) -> Option<f64> {
    let peak = frames.iter().flatten().map(|sample| sample.unsigned_abs()).max().unwrap_or(0);
    (peak > 0).then(|| 20.0 * (f64::from(peak) / f64::from(FULL_SCALE_24_BIT)).log10())
}
