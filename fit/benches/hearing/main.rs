//! Measures fits of recordings as an ear hears them, as a Markdown table, with medians.
//!
//! Compares dsp-core's rendering of each fitted table, residual included, with the recording
//! (docs/fit.md defines the measures). A second table counts what is wrong with the tables
//! themselves (`table.rs` defines the columns).
//!
//! `cargo bench -p fit --bench hearing [-- MODES ...] [NAME ...] [FOLDER]`: 64 modes by default;
//! recordings whose names contain one of the NAMEs; the FOLDER of ../shared/data, `recordings` by
//! default. Renderings go to the folder that the variable `RENDERINGS` names. Seconds are the CPU
//! time of the one thread that makes a fit.

mod table;

use std::path::{Path, PathBuf};

use cpu_time::ThreadTime;
use fit::FitError;
use fit::hearing::{Heard, Scores};
use fit::recording::{Options, fit_file};
use fit::score::quantile;
use rayon::prelude::*;
use table::Checks;

struct Row {
    name: String,
    modes: usize,
    scores: Scores,
    seconds: f64,
    checks: Checks,
}

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).filter(|argument| !argument.starts_with("--")).collect();
    let mut numbers: Vec<usize> = arguments.iter().filter_map(|argument| argument.parse().ok()).collect();
    if numbers.is_empty() {
        numbers.push(64);
    }
    let words: Vec<&String> = arguments.iter().filter(|argument| argument.parse::<usize>().is_err()).collect();
    let beside = || Path::new(env!("CARGO_MANIFEST_DIR")).join("../../shared/data");
    let data = std::env::var_os("SHARED_DATA").map_or_else(beside, PathBuf::from);
    let (folders, names): (Vec<&String>, Vec<&String>) = words.into_iter().partition(|word| data.join(word).is_dir());
    let folder = data.join(folders.first().map_or("recordings", |folder| folder.as_str()));
    let Ok(entries) = std::fs::read_dir(&folder) else {
        println!("no recordings at {}: nothing to measure", folder.display());
        return;
    };
    let mut files: Vec<PathBuf> = entries.filter_map(|entry| Some(entry.ok()?.path())).collect();
    files.retain(|file| {
        let name = file.file_name().unwrap_or_default().to_string_lossy();
        file.extension().is_some_and(|ending| ending == "wav")
            && (names.is_empty() || names.iter().any(|wanted| name.contains(wanted.as_str())))
    });
    files.sort();
    for modes in numbers {
        let rows: Vec<Result<Row, FitError>> = files.par_iter().map(|file| row(file, modes)).collect();
        println!(
            "| recording | modes | LSD, dB | ERB distance, dB | first 0.25 s | loudness error | first 0.25 s | partials | peak, dB | attack, dB | seconds |"
        );
        println!("| --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- |");
        let mut good = Vec::new();
        for row in rows {
            match row {
                Ok(row) => {
                    println!("{}", line(&row.name, row.modes, row.scores, row.seconds));
                    good.push(row);
                }
                Err(error) => println!("{error}"),
            }
        }
        let half = |first: usize| good.iter().skip(first).step_by(2).collect::<Vec<&Row>>();
        for (name, rows) in
            [("median", good.iter().collect()), ("of the 1st, 3rd, ...", half(0)), ("of the 2nd, 4th, ...", half(1))]
        {
            println!("{}", medians(name, &rows));
        }
        let share = |is: &dyn Fn(&Row) -> bool| good.iter().filter(|row| is(row)).count();
        println!(
            "{} of {} peak at most 3 dB above their recording; the attack of {} is within 3 dB; longest fit {:.1} s\n",
            share(&|row| row.scores.peak_db <= 3.0),
            good.len(),
            share(&|row| row.scores.attack_db.abs() <= 3.0),
            good.iter().map(|row| row.seconds).fold(0.0, f64::max)
        );
        println!("| table | {}\n|{}", Checks::HEAD, " --- |".repeat(1 + Checks::HEAD.matches('|').count()));
        for row in &good {
            println!("| {} | {}", row.name, row.checks.line());
        }
        println!();
    }
}

/// Line of the medians of rows.
fn medians(name: &str, rows: &[&Row]) -> String {
    let median = |value: &dyn Fn(&Row) -> f64| quantile(&rows.iter().map(|row| value(row)).collect::<Vec<_>>(), 0.5);
    let scores = Scores {
        lsd_db: median(&|row| row.scores.lsd_db),
        erb_db: median(&|row| row.scores.erb_db),
        early_erb_db: median(&|row| row.scores.early_erb_db),
        loudness_error: median(&|row| row.scores.loudness_error),
        early_loudness_error: median(&|row| row.scores.early_loudness_error),
        partials: median(&|row| row.scores.partials),
        peak_db: median(&|row| row.scores.peak_db),
        attack_db: median(&|row| row.scores.attack_db),
    };
    line(name, median(&|row| row.modes as f64) as usize, scores, median(&|row| row.seconds))
}

fn line(name: &str, modes: usize, scores: Scores, seconds: f64) -> String {
    format!(
        "| {} | {} | {:.2} | {:.2} | {:.2} | {:.3} | {:.3} | {:.2} | {:+.1} | {:+.1} | {:.1} |",
        name,
        modes,
        scores.lsd_db,
        scores.erb_db,
        scores.early_erb_db,
        scores.loudness_error,
        scores.early_loudness_error,
        scores.partials,
        scores.peak_db,
        scores.attack_db,
        seconds
    )
}

fn row(file: &Path, modes: usize) -> Result<Row, FitError> {
    let mut options = Options::default();
    options.strike.modes.most_modes = modes;
    let start = ThreadTime::now();
    let fitted = fit_file(file, &options)?;
    let seconds = start.elapsed().as_secs_f64();
    let strike = &fitted.fit.strikes[fitted.fit.loudest];
    let rate_hz = fitted.recording.rate_hz;
    let (onset, end) = (strike.hit.onset, strike.hit.end);
    let heard = Heard::new(&fitted.recording.samples, rate_hz, onset, end);
    let name = file.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    if let Some(folder) = std::env::var_os("RENDERINGS") {
        let path = Path::new(&folder).join(format!("{name}-{modes}@{onset}.wav"));
        write(&path, rate_hz, onset, &fitted.whole).map_err(|error| FitError::Render(error.to_string()))?;
    }
    Ok(Row {
        modes: fitted.fit.modes.len(),
        scores: heard.scores(&fitted.whole),
        seconds,
        checks: Checks::of(&fitted, &heard),
        name,
    })
}

/// Writes a rendering in floating point, behind as many samples of silence as precede the strike.
fn write(path: &Path, rate_hz: f64, onset: usize, sound: &[f64]) -> Result<(), hound::Error> {
    let spec = hound::WavSpec {
        channels: 1,
        sample_rate: rate_hz as u32,
        bits_per_sample: 32,
        sample_format: hound::SampleFormat::Float,
    };
    let mut writer = hound::WavWriter::create(path, spec)?;
    for sample in std::iter::repeat_n(&0.0, onset).chain(sound) {
        writer.write_sample(*sample as f32)?;
    }
    writer.finalize()
}
