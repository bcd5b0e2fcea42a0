//! `malleus fit`: fits recordings and writes their tables, sounds and pages.

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Mutex;
use std::sync::atomic::{AtomicU64, Ordering};

use ::fit::material::{self, Interval, Material};
use ::fit::recording::{Fitted, Options, Report, fit_file};
use ::fit::strike::Estimator;
use ::kit::counting::counted;
use ::kit::file::check_writable;
use malleus::report;
use malleus::wave::write_mono;
use rayon::prelude::*;
use serde::Serialize;

use super::error::CommandError;
use super::fit_filter::{self, FilterReport};
use super::fit_job::{Job, with_file};
use super::fit_names as names;
use super::fit_strikes::{self, StrikesReport};
use super::output::{has_extension, print, print_json, progress, refuse_input, refuse_same};
use crate::arguments::{EstimatorName, FitArguments};

/// One input and the outcome of its fit, a row of the report.
#[derive(Debug, Serialize)]
struct Row {
    input: PathBuf,
    table: PathBuf,
    #[serde(skip_serializing_if = "Option::is_none")]
    page: Option<PathBuf>,
    #[serde(flatten)]
    outcome: Outcome,
}

#[derive(Debug, Serialize)]
#[serde(rename_all = "snake_case", tag = "outcome")]
enum Outcome {
    Fitted { report: Box<Report> },
    Filtered { report: Box<FilterReport> },
    Together { report: Box<StrikesReport> },
    Skipped,
    Failed { error: String },
}

/// Steps of the progress bar for one recording.
const STEPS: u64 = 100;
/// Stack of a worker thread in bytes: the engine that renders tables is built on it.
const STACK_BYTES: usize = 64 << 20;

pub(crate) fn run(arguments: &FitArguments) -> Result<(), CommandError> {
    material::named(&arguments.materials)?;
    let one_file = has_extension(&arguments.output, "toml");
    if one_file && arguments.input.len() > 1 {
        return Err(CommandError::OneTable { output: arguments.output.clone(), inputs: arguments.input.len() });
    }
    if !one_file && arguments.output.is_file() {
        return Err(CommandError::NoTable { output: arguments.output.clone() });
    }
    if arguments.render.is_some() && arguments.input.len() > 1 {
        return Err(CommandError::OneRendering { inputs: arguments.input.len() });
    }
    if arguments.events.is_some() && arguments.input.len() > 1 {
        return Err(CommandError::OneEvents { inputs: arguments.input.len() });
    }
    if arguments.estimator == EstimatorName::Descent && arguments.events.is_none() {
        return Err(CommandError::DescentWithoutEvents);
    }
    if arguments.estimator != EstimatorName::Descent && arguments.steps.is_some() {
        return Err(CommandError::StepsWithoutDescent);
    }
    if !one_file {
        make_folder(&arguments.output)?;
    }
    if let Some(folder) = &arguments.report {
        make_folder(folder)?;
    }
    let jobs: Vec<Job> = names::of_inputs(&arguments.input)
        .into_iter()
        .map(|(input, name)| Job {
            table: if one_file { arguments.output.clone() } else { arguments.output.join(format!("{name}.toml")) },
            page: arguments.report.as_ref().map(|folder| folder.join(format!("{name}.html"))),
            input,
            name,
        })
        .collect();
    check_outputs(arguments, &jobs, one_file)?;
    let bar = progress(STEPS * jobs.len() as u64, "fitting");
    let workers = rayon::ThreadPoolBuilder::new().stack_size(STACK_BYTES).build().map_err(CommandError::Workers)?;
    let said = Mutex::new(());
    let rows: Vec<Row> = workers.install(|| {
        jobs.par_iter()
            .map(|job| {
                let done = AtomicU64::new(0);
                let told = |share: f64| {
                    let now = (share * STEPS as f64) as u64;
                    bar.inc(now.saturating_sub(done.fetch_max(now, Ordering::Relaxed)));
                };
                let outcome = fit_one(arguments, job, &told);
                told(1.0);
                if let Outcome::Failed { error } = &outcome {
                    let _one_at_a_time = said.lock();
                    bar.suspend(|| eprintln!("malleus: {error}"));
                }
                Row { input: job.input.clone(), table: job.table.clone(), page: job.page.clone(), outcome }
            })
            .collect()
    });
    bar.finish_and_clear();
    if let Some(folder) = &arguments.report {
        report::write_index(folder, &failures(&rows))?;
    }
    if arguments.json {
        print_json(&rows)?;
    } else {
        print(&as_text(&rows, arguments.bar.or(arguments.disc).is_some()))?;
    }
    let failed = rows.iter().filter(|row| matches!(row.outcome, Outcome::Failed { .. })).count();
    if failed > 0 {
        return Err(CommandError::FitsFailed { failed, of: rows.len() });
    }
    Ok(())
}

fn make_folder(path: &Path) -> Result<(), CommandError> {
    fs::create_dir_all(path)
        .map_err(|cause| CommandError::File(::kit::file::FileError { action: "made", path: path.to_owned(), cause }))
}

/// Checks that all outputs are different files that the command does not read, and that those named
/// one by one can be written.
fn check_outputs(arguments: &FitArguments, jobs: &[Job], one_file: bool) -> Result<(), CommandError> {
    let named = [one_file.then_some(&arguments.output), arguments.render.as_ref(), arguments.events.as_ref()];
    let named = named.into_iter().flatten().map(PathBuf::as_path);
    let in_folders = jobs.iter().flat_map(|job| [(!one_file).then_some(&job.table), job.page.as_ref()]);
    let all: Vec<&Path> = named.clone().chain(in_folders.flatten().map(PathBuf::as_path)).collect();
    refuse_same(&all)?;
    all.iter().try_for_each(|path| refuse_input(path, arguments.input.iter().map(PathBuf::as_path)))?;
    // What is done already is not written again.
    if !jobs.iter().all(|job| is_done(arguments, job)) {
        named.into_iter().try_for_each(check_writable)?;
    }
    Ok(())
}

/// True if all results of a recording exist, are no older than it, and are not to be made anew.
fn is_done(arguments: &FitArguments, job: &Job) -> bool {
    let wanted =
        [Some(job.table.as_path()), arguments.render.as_deref(), arguments.events.as_deref(), job.page.as_deref()];
    !arguments.redo && wanted.iter().flatten().all(|path| is_newer(path, &job.input))
}

fn fit_one(arguments: &FitArguments, job: &Job, told: &(dyn Fn(f64) + Sync)) -> Outcome {
    if is_done(arguments, job) {
        return Outcome::Skipped;
    }
    let outcome = match (arguments.dynamic_filter, &arguments.events) {
        (None, Some(events)) => fit_strikes::fit_and_write(arguments, job, events, told)
            .map(|report| Outcome::Together { report: Box::new(report) }),
        (None, None) => fit_and_write(arguments, job).map(|report| Outcome::Fitted { report: Box::new(report) }),
        (Some(beside), _) => fit_filter::fit_and_write(arguments, job, beside, told)
            .map(|report| Outcome::Filtered { report: Box::new(report) }),
    };
    outcome.unwrap_or_else(|error| Outcome::Failed { error })
}

fn fit_and_write(arguments: &FitArguments, job: &Job) -> Result<Report, String> {
    let Job { input, name, table, page } = job;
    let materials = material::named(&arguments.materials).map_err(|error| error.to_string())?;
    let fitted = fit_file(input, &options(arguments, materials)).map_err(|error| with_file(input, error))?;
    let text = ::kit::text::write(&fitted.table);
    ::kit::file::write_whole(table, text.as_bytes()).map_err(|error| error.to_string())?;
    if let Some(path) = &arguments.render {
        write_mono(path, fitted.report.rate_hz, &aligned(&fitted)).map_err(|error| error.to_string())?;
    }
    if let Some(path) = page {
        report::write_page(path, name, table, &fitted).map_err(|error| error.to_string())?;
    }
    Ok(fitted.report)
}

/// Names of the recordings that could not be fitted, each with the reason.
fn failures(rows: &[Row]) -> Vec<(String, String)> {
    let failure = |row: &Row| match &row.outcome {
        Outcome::Failed { error } => {
            Some((row.input.file_name().unwrap_or_default().to_string_lossy().into_owned(), error.clone()))
        }
        Outcome::Fitted { .. } | Outcome::Filtered { .. } | Outcome::Together { .. } | Outcome::Skipped => None,
    };
    rows.iter().filter_map(failure).collect()
}

fn options(arguments: &FitArguments, materials: Vec<Material>) -> Options {
    let mut options = Options {
        force_channel: arguments.force_channel,
        hits: arguments.hits.clone(),
        licence: arguments.licence.clone(),
        solid: arguments.bar.or(arguments.disc),
        materials,
        ..Options::default()
    };
    let within = arguments.budget.map_or(usize::MAX, ::fit::table::modes_within);
    options.strike.estimator = match arguments.estimator {
        // A descent fits many strikes (`fit_strikes`), and never one.
        EstimatorName::Modal | EstimatorName::Descent => Estimator::Modal,
        EstimatorName::Bins => Estimator::Bins,
    };
    let most = arguments.modes.unwrap_or(options.strike.estimator.usual_modes());
    options.strike.modes.most_modes = most.min(within);
    options
}

/// The instrument's sound of the loudest strike, at the place where the strike is in the recording.
fn aligned(fitted: &Fitted) -> Vec<f64> {
    let onset = fitted.fit.strikes.get(fitted.fit.loudest).map_or(0, |strike| strike.hit.onset);
    let mut sound = vec![0.0; onset];
    sound.extend_from_slice(&fitted.whole);
    sound
}

/// True if the result is a file and no older than its source. A folder or a pipe is no result.
fn is_newer(result: &Path, source: &Path) -> bool {
    let time = |path: &Path| fs::metadata(path).and_then(|metadata| metadata.modified()).ok();
    result.is_file() && time(result).zip(time(source)).is_some_and(|(result, source)| result >= source)
}

/// Row of a fitted recording, and what else there is to say of it.
fn fitted_row(name: &str, report: &Report, has_solid: bool) -> String {
    let [shortest_s, longest_s] = report.t60_s;
    let t60 = if report.modes == 0 { "-".to_owned() } else { format!("{shortest_s:.3} to {longest_s:.2}") };
    let (modes, strikes) = (report.modes, report.strikes.len());
    let mut text =
        format!("{name:32} {modes:>5} {:>7.2} {t60:>17} {strikes:>7} {:>7.1}\n", report.lsd_db, report.seconds);
    report.notes.iter().for_each(|note| text += &format!("  {note}\n"));
    text + &modulus_line(report.young_modulus_pa.as_ref(), has_solid)
}

/// Line of Young's modulus below a row; empty unless the size of the thing is known.
pub(super) fn modulus_line(modulus: Option<&Interval>, has_solid: bool) -> String {
    let Some(modulus) = modulus.filter(|_| has_solid) else { return String::new() };
    let [estimate, low, high] = [modulus.estimate, modulus.low, modulus.high].map(|pascals| 1e-9 * pascals);
    format!("  Young's modulus {estimate:.2} GPa, from {low:.2} to {high:.2} in nine of ten\n")
}

/// Rows of all recordings; `has_solid` if the size of the things is known.
fn as_text(rows: &[Row], has_solid: bool) -> String {
    let has_filters = rows.iter().any(|row| matches!(row.outcome, Outcome::Filtered { .. }));
    let head = ["recording", "modes", "LSD dB", "T60 s", "strikes", "seconds"];
    let [name, modes, lsd, t60, strikes, seconds] = head;
    let head = format!("{name:32} {modes:>5} {lsd:>7} {t60:>17} {strikes:>7} {seconds:>7}\n");
    let mut text = if has_filters { String::new() } else { head };
    for row in rows {
        let name = row.input.file_name().unwrap_or_default().to_string_lossy();
        text += &match &row.outcome {
            Outcome::Fitted { report } => fitted_row(&name, report, has_solid),
            Outcome::Filtered { report } => format!(
                "{name:32} {}, {}: decay within 15 % in {} of {}, median error {:.0} %, {:.1} s\n",
                counted(report.modes, "modes"),
                counted(report.loops, "loops"),
                report.bands_within_15_percent,
                counted(report.bands, "Bark bands"),
                100.0 * report.median_error,
                report.seconds
            ),
            Outcome::Together { report } => fit_strikes::row(&name, report, has_solid),
            Outcome::Skipped => format!("{name:32} is done already ({}): --redo fits it anew\n", row.table.display()),
            Outcome::Failed { .. } => format!("{name:32} failed\n"),
        };
    }
    text
}
