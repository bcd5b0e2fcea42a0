//! `malleus fit`: recordings in, tables out.

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Mutex;

use ::fit::FitError;
use ::fit::recording::{Fitted, Options, Report, fit_file};
use malleus::wave::write_mono;
use rayon::prelude::*;
use serde::Serialize;

use super::{CommandError, print, print_json, progress};
use crate::FitArguments;

/// What became of one input.
#[derive(Debug, Serialize)]
struct Row {
    input: PathBuf,
    table: PathBuf,
    #[serde(flatten)]
    outcome: Outcome,
}

#[derive(Debug, Serialize)]
#[serde(rename_all = "snake_case", tag = "outcome")]
enum Outcome {
    Fitted { report: Box<Report> },
    Skipped,
    Failed { error: String },
}

/// Stack of a worker: the engine that renders tables is built there.
const STACK_BYTES: usize = 64 << 20;

pub(crate) fn run(arguments: &FitArguments) -> Result<(), CommandError> {
    let one_file = arguments.output.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("toml"));
    if one_file && arguments.input.len() > 1 {
        return Err(CommandError::OneTable { output: arguments.output.clone(), inputs: arguments.input.len() });
    }
    if arguments.render.is_some() && arguments.input.len() > 1 {
        return Err(CommandError::OneRendering { inputs: arguments.input.len() });
    }
    if !one_file {
        fs::create_dir_all(&arguments.output)?;
    }
    let jobs: Vec<(PathBuf, PathBuf)> = arguments
        .input
        .iter()
        .map(|input| {
            let file = format!("{}.toml", input.file_stem().unwrap_or_default().to_string_lossy());
            (input.clone(), if one_file { arguments.output.clone() } else { arguments.output.join(file) })
        })
        .collect();
    let bar = progress(jobs.len() as u64, "fitting");
    let workers = rayon::ThreadPoolBuilder::new()
        .stack_size(STACK_BYTES)
        .build()
        .map_err(|error| CommandError::Print(std::io::Error::other(error)))?;
    let said = Mutex::new(());
    let rows: Vec<Row> = workers.install(|| {
        jobs.par_iter()
            .map(|(input, table)| {
                let outcome = fit_one(arguments, input, table);
                bar.inc(1);
                if let Outcome::Failed { error } = &outcome {
                    let _one_at_a_time = said.lock();
                    bar.suspend(|| eprintln!("malleus: {error}"));
                }
                Row { input: input.clone(), table: table.clone(), outcome }
            })
            .collect()
    });
    bar.finish_and_clear();
    if arguments.json {
        print_json(&rows)?;
    } else {
        print(&as_text(&rows))?;
    }
    let failed = rows.iter().filter(|row| matches!(row.outcome, Outcome::Failed { .. })).count();
    if failed > 0 {
        return Err(CommandError::FitsFailed { failed, of: rows.len() });
    }
    Ok(())
}

fn fit_one(arguments: &FitArguments, input: &Path, table: &Path) -> Outcome {
    let wanted = [Some(table), arguments.render.as_deref()];
    if !arguments.redo && wanted.iter().flatten().all(|path| is_newer(path, input)) {
        return Outcome::Skipped;
    }
    match fit_and_write(arguments, input, table) {
        Ok(report) => Outcome::Fitted { report: Box::new(report) },
        Err(error) => Outcome::Failed { error },
    }
}

fn fit_and_write(arguments: &FitArguments, input: &Path, table: &Path) -> Result<Report, String> {
    let in_file = |error: FitError| match error {
        // These name the file themselves.
        FitError::Read { .. }
        | FitError::NotAudio { .. }
        | FitError::Empty { .. }
        | FitError::Channel { .. }
        | FitError::NoMicrophone { .. }
        | FitError::Rate { .. }
        | FitError::NotFinite { .. } => error.to_string(),
        other => format!("{}: {other}", input.display()),
    };
    let fitted = fit_file(input, &options(arguments)).map_err(in_file)?;
    let text = ::kit::text::write(&fitted.table);
    ::kit::file::write_whole(table, text.as_bytes()).map_err(|error| error.to_string())?;
    if let Some(path) = &arguments.render {
        write_mono(path, fitted.report.rate_hz, &aligned(&fitted)).map_err(|error| error.to_string())?;
    }
    Ok(fitted.report)
}

fn options(arguments: &FitArguments) -> Options {
    let mut options = Options {
        force_channel: arguments.force_channel,
        hits: arguments.hits.clone(),
        licence: arguments.licence.clone(),
        ..Options::default()
    };
    let within = arguments.budget.map_or(usize::MAX, ::fit::table::modes_within);
    options.strike.modes.most_modes = arguments.modes.min(within);
    options
}

/// dsp-core's rendering of the loudest strike at its place in the recording.
fn aligned(fitted: &Fitted) -> Vec<f64> {
    let onset = fitted.fit.strikes.get(fitted.fit.loudest).map_or(0, |strike| strike.hit.onset);
    let mut sound = vec![0.0; onset];
    sound.extend_from_slice(&fitted.rendering);
    sound
}

/// Whether a result is there and no older than what it was made from.
fn is_newer(result: &Path, source: &Path) -> bool {
    let time = |path: &Path| fs::metadata(path).and_then(|metadata| metadata.modified()).ok();
    time(result).zip(time(source)).is_some_and(|(result, source)| result >= source)
}

fn as_text(rows: &[Row]) -> String {
    let mut text = format!(
        "{:32} {:>5} {:>7} {:>17} {:>7} {:>7}\n",
        "recording", "modes", "LSD dB", "T60 s", "strikes", "seconds"
    );
    for row in rows {
        let name = row.input.file_name().unwrap_or_default().to_string_lossy();
        text += &match &row.outcome {
            Outcome::Fitted { report } => format!(
                "{name:32} {:>5} {:>7.2} {:>17} {:>7} {:>7.1}\n",
                report.modes,
                report.lsd_db,
                format!("{:.3} to {:.2}", report.t60_s[0], report.t60_s[1]),
                report.strikes.len(),
                report.seconds
            ),
            Outcome::Skipped => format!("{name:32} is done already ({})\n", row.table.display()),
            Outcome::Failed { .. } => format!("{name:32} failed\n"),
        };
    }
    text
}
