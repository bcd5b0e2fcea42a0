//! Measures how well the damping laws of recordings are kept by the dynamic filter.
//!
//! `cargo bench -p fit --bench dynamic_filter [-- NAME... [--ways PART]]`. The filter has at most
//! ten modes beside it or loops round it. With names, only recordings whose names contain one of
//! them are measured, band by band; with PART, only methods whose names contain it.

use std::io::Write;
use std::path::Path as FilePath;

use fit::dynamic_filter::study::{SEEDS, Way, heard_in, resynthesis};
use fit::dynamic_filter::{Comparison, compare, counted, mean_law};
use fit::score::quantile;

fn main() {
    let folder = FilePath::new(env!("CARGO_MANIFEST_DIR")).join("../../shared/data/recordings");
    let arguments: Vec<String> = std::env::args().skip(1).filter(|argument| argument != "--bench").collect();
    let split = arguments.iter().position(|argument| argument == "--ways").unwrap_or(arguments.len());
    let (wanted, parts) = arguments.split_at(split);
    let asked = |way: &Way| parts.get(1).is_none_or(|part| way.label().contains(part.as_str()));
    let ways: Vec<Way> = Way::ALL.into_iter().filter(asked).collect();
    let Ok(entries) = std::fs::read_dir(&folder) else {
        println!("{} is absent: nothing to measure", folder.display());
        return;
    };
    let mut files: Vec<_> = entries.filter_map(|entry| entry.ok().map(|entry| entry.path())).collect();
    files.retain(|path| path.extension().is_some_and(|extension| extension == "wav"));
    files.sort();
    println!(
        "Damping per Bark band against the recording's, {SEEDS} seeds: median and worst error, bands within 15 %\n"
    );
    print!("| recording | bands |");
    ways.iter().for_each(|way| print!(" {} |", way.label()));
    println!("\n| --- | --- |{}", " --- |".repeat(ways.len()));
    let mut sums = vec![(0, 0); ways.len()];
    for file in files {
        let name = file.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        if !wanted.is_empty() && !wanted.iter().any(|part| name.contains(part.as_str())) {
            continue;
        }
        let heard = match heard_in(&file) {
            Ok(heard) => heard,
            Err(error) => {
                println!("| {name} | {error} |");
                continue;
            }
        };
        let mut columns: Vec<Vec<Comparison>> = Vec::new();
        print!("| {name} | {} |", counted(&heard.law).count());
        for (way, sum) in ways.iter().zip(&mut sums) {
            let model = way.model(&heard, &|_| {});
            let compared = compare(&heard.law, mean_law(&resynthesis(&model, &heard)).as_ref());
            let errors: Vec<f64> = compared.iter().map(Comparison::error).collect();
            let within = errors.iter().filter(|error| **error <= 0.15).count();
            print!(
                " {:.0}, {:.0} %: {within} ({}) |",
                100.0 * quantile(&errors, 0.5),
                100.0 * quantile(&errors, 1.0),
                model.modes.len() + model.loops.len()
            );
            // A method takes long, so each result is shown at once.
            let _ = std::io::stdout().flush();
            sum.0 += within;
            sum.1 += errors.len();
            columns.push(compared);
        }
        println!();
        if !wanted.is_empty() {
            print_bands(&columns);
        }
    }
    print!("| all | |");
    sums.iter().for_each(|(within, of)| print!(" {within} of {of} |"));
    println!();
}

fn print_bands(columns: &[Vec<Comparison>]) {
    for (index, first) in columns.first().into_iter().flatten().enumerate() {
        let band = first.recorded;
        print!(
            "  {:2} Bark {:6.0} Hz, {:6.1} dB, {:6.1}/s:",
            band.bark,
            band.centre_hz,
            20.0 * band.gain.log10(),
            band.decay_per_s
        );
        for row in columns.iter().filter_map(|column| column.get(index)) {
            match row.decay_per_s {
                Some(decay) => print!(" {:+5.0} %", 100.0 * (decay / band.decay_per_s - 1.0)),
                None => print!("    none"),
            }
        }
        println!();
    }
}
