//! Measures the improvement by each stage, as a Markdown table.
//!
//! Shows distances of dsp-core's renderings from the recordings: of the modes alone, and of the
//! whole fitted table, at equal numbers of modes, averaged over 20 noises.
//!
//! `cargo bench -p fit --bench stages [-- MODES] [NAME ...]`: 64 modes by default; recordings whose
//! names contain one of the NAMEs.

use std::path::{Path, PathBuf};

use fit::FitError;
use fit::recording::{Options, fit_file};
use fit::score::quantile;
use fit::stages::{Distances, PlayedTable, RecordedStrike};
use rayon::prelude::*;

const DRAWS: u32 = 20;

struct Row {
    name: String,
    modes: usize,
    alone: Distances,
    whole: Distances,
    stages: String,
}

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).filter(|argument| !argument.starts_with("--")).collect();
    let modes = arguments.iter().find_map(|argument| argument.parse().ok()).unwrap_or(64);
    let names: Vec<&String> = arguments.iter().filter(|argument| argument.parse::<usize>().is_err()).collect();
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../shared/data/recordings");
    let Ok(entries) = std::fs::read_dir(&folder) else {
        println!("no recordings at ../shared/data/recordings beside the repository: nothing to measure");
        return;
    };
    let mut files: Vec<PathBuf> = entries.filter_map(|entry| Some(entry.ok()?.path())).collect();
    files.retain(|file| {
        let name = file.file_name().unwrap_or_default().to_string_lossy();
        file.extension().is_some_and(|ending| ending == "wav")
            && (names.is_empty() || names.iter().any(|wanted| name.contains(wanted.as_str())))
    });
    files.sort();
    let rows: Vec<Result<Row, FitError>> = files.par_iter().map(|file| row(file, modes)).collect();
    println!(
        "| recording | modes | ERB distance, dB: modes alone | all stages | change | first 0.25 s: modes alone | all | LSD, dB: modes alone | all | stages |"
    );
    println!("| --- | --- | --- | --- | --- | --- | --- | --- | --- | --- |");
    let mut good = Vec::new();
    for row in rows {
        match row {
            Ok(row) => {
                println!(
                    "| {} | {} | {:.2} | {:.2} | {:+.0} % | {:.2} | {:.2} | {:.2} | {:.2} | {} |",
                    row.name,
                    row.modes,
                    row.alone.erb_db,
                    row.whole.erb_db,
                    change(row.alone.erb_db, row.whole.erb_db),
                    row.alone.early_erb_db,
                    row.whole.early_erb_db,
                    row.alone.lsd_db,
                    row.whole.lsd_db,
                    row.stages
                );
                good.push(row);
            }
            Err(error) => println!("{error}"),
        }
    }
    let median = |value: &dyn Fn(&Row) -> f64| quantile(&good.iter().map(value).collect::<Vec<_>>(), 0.5);
    let most = good.iter().map(|row| row.whole.lsd_db - row.alone.lsd_db).fold(f64::NEG_INFINITY, f64::max);
    println!(
        "\nmedian change of the ERB distance {:+.1} % (first 0.25 s {:+.1} %); LSD: median {:.2} dB alone, {:.2} with all, largest rise {most:+.2} dB",
        median(&|row| change(row.alone.erb_db, row.whole.erb_db)),
        median(&|row| change(row.alone.early_erb_db, row.whole.early_erb_db)),
        median(&|row| row.alone.lsd_db),
        median(&|row| row.whole.lsd_db),
    );
}

fn change(from: f64, to: f64) -> f64 {
    100.0 * (to / from - 1.0)
}

fn row(file: &Path, modes: usize) -> Result<Row, FitError> {
    let mut options = Options::default();
    options.strike.modes.most_modes = modes;
    let fitted = fit_file(file, &options)?;
    let strike = &fitted.fit.strikes[fitted.fit.loudest];
    let (before, samples) = fitted.recording.samples[..strike.hit.end].split_at(strike.hit.onset);
    let heard = RecordedStrike::new(before, samples, fitted.recording.rate_hz, strike.position);
    let alone = heard.distances(&fitted.rendering);
    let PlayedTable { table, distances: whole, .. } = heard.play(fitted.table, DRAWS)?;
    let residual = table.objects.iter().find_map(|object| object.residual.as_ref());
    let mut stages = Vec::new();
    if let Some(residual) = residual {
        stages.push(format!("residual, {} bands", residual.weight.iter().filter(|weight| **weight > 0.0).count()));
    }
    if !table.room.is_empty() {
        stages.push("room".to_owned());
    }
    Ok(Row {
        name: file.file_stem().unwrap_or_default().to_string_lossy().into_owned(),
        modes: fitted.fit.modes.len(),
        alone,
        whole,
        stages: stages.join(", "),
    })
}
