//! `cargo bench -p fit --bench dynamic_filter [-- NAME...]`: how well damping laws of recordings survive in the dynamic filter, with at most ten
//! modes beside it or loops round it. With names, only the recordings whose names contain one of them, band by band.

use std::path::Path as FilePath;

use fit::dynamic_filter::study::{SEEDS, Way, heard_in, resynthesis};
use fit::dynamic_filter::{Comparison, compare, mean_law};
use fit::score::quantile;

fn main() {
    let folder = FilePath::new(env!("CARGO_MANIFEST_DIR")).join("../../shared/data/recordings");
    let wanted: Vec<String> = std::env::args().skip(1).filter(|argument| !argument.starts_with("--")).collect();
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
    Way::ALL.iter().for_each(|way| print!(" {} |", way.label()));
    println!("\n| --- | --- |{}", " --- |".repeat(Way::ALL.len()));
    let mut sums = vec![(0, 0); Way::ALL.len()];
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
        let mut line = String::new();
        for (way, sum) in Way::ALL.into_iter().zip(&mut sums) {
            let model = way.model(&heard);
            let compared = compare(&heard.law, mean_law(&resynthesis(&model, &heard)).as_ref());
            let errors: Vec<f64> = compared.iter().map(Comparison::error).collect();
            let within = errors.iter().filter(|error| **error <= 0.15).count();
            line += &format!(
                " {:.0}, {:.0} %: {within} ({}) |",
                100.0 * quantile(&errors, 0.5),
                100.0 * quantile(&errors, 1.0),
                model.modes.len() + model.loops.len()
            );
            sum.0 += within;
            sum.1 += errors.len();
            columns.push(compared);
        }
        println!("| {name} | {} |{line}", columns.first().map_or(0, Vec::len));
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
