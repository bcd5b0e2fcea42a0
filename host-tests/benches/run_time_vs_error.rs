//! Prints run time against error of all kernels and rivals, and writes the page, the picture and
//! the JSON: see [`host_tests::run_time`].

use std::error::Error;
use std::path::Path;

use host_tests::on_chip::{BankOnChip, scenes};
use host_tests::run_time::report::Report;
use host_tests::run_time::{accuracy, cycles_over_modes, measure, rivals};
use host_tests::single_mode::{Case, grid};
use indicatif::{ProgressBar, ProgressStyle};

/// Number of frequencies of the grid.
const FREQUENCIES: u32 = 40;
/// Step between the cases of the grid that are compared bit for bit: 20 cases, of all decays and
/// both rates.
const SAMPLED: usize = 21;
/// Number of ticks that are compared.
const COMPARED_TICKS: usize = 200;

fn main() -> Result<(), Box<dyn Error>> {
    let cases = grid(FREQUENCIES, 1.0);
    let progress = progress(cases.len() as u64, "error over the grid, on the PC")?;
    let accuracies = accuracy::measure(&cases, || progress.inc(1));
    progress.finish_and_clear();

    let mut chip = BankOnChip::new()?;
    let progress = self::progress(accuracies.len() as u64, "run time on the virtual core")?;
    let kernels = measure::kernel_rows(&mut chip, &accuracies, || progress.inc(1))?;
    progress.finish_and_clear();

    let progress = self::progress(2, "bits, and whole scenes")?;
    let sample: Vec<Case> = cases.iter().step_by(SAMPLED).copied().collect();
    let (bank_bits, rival_bits) = measure::compare_bits(&mut chip, &sample, &rivals::all(), COMPARED_TICKS)?;
    progress.inc(1);
    let scenes = scenes::measure_all()?;
    progress.finish_and_clear();

    let progress = self::progress(cycles_over_modes::MODES.len() as u64, "cycles over modes")?;
    let cycles_over_modes = cycles_over_modes::measure(&cycles_over_modes::MODES, || progress.inc(1))?;
    progress.finish_and_clear();

    let report = Report { kernels, scenes, cycles_over_modes, bank_bits, rival_bits };
    print!("{}", report.markdown());
    let workspace = Path::new(env!("CARGO_MANIFEST_DIR")).parent().ok_or("this crate lies in a workspace")?;
    for path in report.write(workspace)? {
        eprintln!("wrote {}", path.display());
    }
    let different = bank_bits.different + rival_bits.different;
    if different > 0 {
        return Err(format!("{different} samples of the virtual core differ from the PC's").into());
    }
    Ok(())
}

/// Progress bar on stderr; if stderr is no terminal, prints one line instead.
fn progress(length: u64, what: &'static str) -> Result<ProgressBar, Box<dyn Error>> {
    let bar = ProgressBar::new(length)
        .with_style(ProgressStyle::with_template("{msg:32} {wide_bar} {percent:>3} % {eta}")?)
        .with_message(what);
    if bar.is_hidden() {
        eprintln!("{what} ...");
    }
    Ok(bar)
}
