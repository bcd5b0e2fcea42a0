//! Runs all sweeps as a whole: `cargo bench -p host-tests --bench nightly [-- WORDS]`.
//!
//! If WORDS is given, only sweeps run whose names contain it.
//!
//! Prints the figures and the time of each sweep, and in the end the sweeps that broke a limit. The
//! exit code is 1 if there are any.

use std::panic::catch_unwind;
use std::process::ExitCode;
use std::time::{Duration, Instant};

use host_tests::sweeps::{ALL, Extent};
use indicatif::{ProgressBar, ProgressStyle};

fn main() -> ExitCode {
    let words = std::env::args().skip(1).find(|argument| !argument.starts_with('-')).unwrap_or_default();
    let chosen: Vec<_> = ALL.iter().filter(|(name, _)| name.contains(&words)).collect();
    if chosen.is_empty() {
        let names: Vec<_> = ALL.iter().map(|(name, _)| *name).collect();
        eprintln!("no sweep's name contains {words:?}; the sweeps are:\n{}", names.join("\n"));
        return ExitCode::FAILURE;
    }
    let bar = ProgressBar::new(chosen.len() as u64);
    if let Ok(style) = ProgressStyle::with_template("{bar:30} {pos} of {len} sweeps, {elapsed}: {msg}") {
        bar.set_style(style);
    }
    bar.enable_steady_tick(Duration::from_secs(1));
    let (mut broken, began) = (Vec::new(), Instant::now());
    for (index, (name, sweep)) in chosen.iter().enumerate() {
        bar.set_message(*name);
        println!("== {} of {}: {name}", index + 1, chosen.len());
        let began = Instant::now();
        let is_kept = catch_unwind(|| sweep(Extent::Whole)).is_ok();
        println!(
            "   {}, {:.1} s",
            if is_kept { "all limits kept" } else { "LIMIT BROKEN" },
            began.elapsed().as_secs_f64()
        );
        if !is_kept {
            broken.push(*name);
        }
        bar.inc(1);
    }
    bar.finish_and_clear();
    println!("{} sweeps in {:.0} s, {} broke a limit", chosen.len(), began.elapsed().as_secs_f64(), broken.len());
    broken.iter().for_each(|name| println!("LIMIT BROKEN: {name}"));
    if broken.is_empty() { ExitCode::SUCCESS } else { ExitCode::FAILURE }
}
