//! `malleus surface`: a measured surface becomes a table of heights.

use std::path::{Path, PathBuf};

use ::fit::surface::{self, Options, Report, Source};
use kit::counting::counted;
use malleus::report::{SurfacePage, write_surface_page};
use serde::Serialize;

use super::error::CommandError;
use super::output::{print, print_json, progress, refuse_input};
use crate::arguments::SurfaceArguments;

/// Steps of the progress bar.
const STEPS: u64 = 100;

/// Report that `--json` prints (docs/json.md).
#[derive(Debug, Serialize)]
struct SurfaceReport<'a> {
    input: &'a Path,
    table: &'a Path,
    /// Path of the page, if one was asked for.
    page: Option<&'a Path>,
    /// Decisions that were made without asking.
    notes: &'a [String],
    #[serde(flatten)]
    report: &'a Report,
}

pub(crate) fn run(arguments: &SurfaceArguments) -> Result<(), CommandError> {
    refuse_input(&arguments.output, [arguments.input.as_path()])?;
    let bar = progress(STEPS, "making the surface's table");
    let (heights, read_notes) = surface::read(&arguments.input, arguments.step)?;
    let options = Options {
        height_scale: arguments.height_scale,
        points: arguments.points,
        source: match (arguments.section, arguments.map) {
            (Some(section), _) => Source::Section(section),
            (None, true) => Source::Map,
            (None, false) => Source::Statistics,
        },
        extend_to_m: arguments.extend_to,
        tip_radius_m: arguments.tip_radius,
        seed: arguments.seed,
    };
    let told = |share: f64| bar.set_position((share * STEPS as f64) as u64);
    let (table, report, notes) = surface::fit(heights, &options, told)?;
    bar.finish_and_clear();
    let notes: Vec<String> = read_notes.iter().chain(&notes).map(ToString::to_string).collect();
    let name = arguments.input.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    let file = arguments.input.file_name().unwrap_or_default().to_string_lossy();
    let text = table.to_toml(&name, &format!("{file} (malleus surface)"), &arguments.licence);
    ::kit::file::write_whole(&arguments.output, text.as_bytes())?;
    let page = arguments.report.as_ref().map(|folder| page_in(folder, &name)).transpose()?;
    if let Some(path) = &page {
        let shown = SurfacePage { name: &name, file: &file, table: &table, report: &report, notes: &notes };
        write_surface_page(path, &shown)?;
    }
    let report = SurfaceReport {
        input: &arguments.input,
        table: &arguments.output,
        page: page.as_deref(),
        notes: &notes,
        report: &report,
    };
    if arguments.json { print_json(&report) } else { print(&as_text(&report)) }
}

/// Path of a page in its folder, which is made if it does not exist.
fn page_in(folder: &Path, name: &str) -> Result<PathBuf, CommandError> {
    std::fs::create_dir_all(folder).map_err(|cause| ::kit::file::FileError {
        action: "made",
        path: folder.to_owned(),
        cause,
    })?;
    Ok(folder.join(format!("{name}.html")))
}

fn as_text(shown: &SurfaceReport<'_>) -> String {
    let report = shown.report;
    let mut text = format!(
        "{}: {} x {} points, {:.2} µm apart, {:.1} mm a row, {} bytes\n",
        shown.table.display(),
        report.rows,
        report.columns,
        1e6 * report.step_m,
        1e3 * report.length_m,
        report.flash_bytes
    );
    text += &format!(
        "shortest wave {:.1} µm; heights {:.3} µm rms; curvature {:.0} 1/m rms, kurtosis {:.2} (surface {:.2})\n",
        1e6 * report.shortest_m,
        1e6 * report.rms_m,
        report.curvature_rms_per_m,
        report.kurtosis[1],
        report.kurtosis[0]
    );
    if !report.bands.is_empty() {
        text += &format!(
            "curvature in {} of a third of an octave: {:.2} dB rms from the surface's, at most {:.2} dB\n",
            counted(report.bands.len(), "bands"),
            report.band_rms_db,
            report.band_max_db
        );
    }
    shown.notes.iter().for_each(|note| text += &format!("note: {note}\n"));
    if let Some(page) = shown.page {
        text += &format!("page: {}\n", page.display());
    }
    text
}
