//! Page on a surface and its table.

use std::path::Path;

use fit::surface::{Report, Table};

use super::chart::{Axis, Chart};
use super::document::document;
use super::error::ReportError;
use super::markup::escaped;

/// Number of points of a chart's line at most.
const DRAWN: usize = 1200;
/// Number of shortest waves in the chart of a detail.
const DETAIL: f64 = 60.0;

/// Surface and table that a page shows.
#[derive(Clone, Copy, Debug)]
pub struct SurfacePage<'a> {
    /// Title of the page.
    pub name: &'a str,
    /// Name of the measurement's file.
    pub file: &'a str,
    /// Table that was written.
    pub table: &'a Table,
    /// Measures of the table.
    pub report: &'a Report,
    /// Decisions that were made without asking.
    pub notes: &'a [String],
}

/// Writes the page of a surface, whole or not at all.
///
/// # Errors
/// [`ReportError`] with the path of the page.
pub fn write_surface_page(path: &Path, page: &SurfacePage<'_>) -> Result<(), ReportError> {
    let report = page.report;
    let mut body = format!(
        "<h1>{}</h1>\n<p class=\"muted\">{}; {} &times; {} points, {:.2} µm apart; shortest wave {:.1} µm; curvature {:.0} 1/m rms, kurtosis {:.2} (surface {:.2})</p>\n",
        escaped(page.name),
        escaped(page.file),
        report.rows,
        page.table.heights.len() / report.rows,
        1e6 * report.step_m,
        1e6 * report.shortest_m,
        report.curvature_rms_per_m,
        report.kurtosis[1],
        report.kurtosis[0]
    );
    let detail = (DETAIL * report.shortest_m / report.step_m) as usize;
    let charts = [spectrum(report), profile("The table", page, usize::MAX), profile("Its beginning", page, detail)];
    body += &format!("<div class=\"charts\">\n{}</div>\n", charts.concat());
    if !page.notes.is_empty() {
        let notes: String = page.notes.iter().map(|note| format!("<li>{}</li>\n", escaped(note))).collect();
        body += &format!("<h2>Decided without asking</h2>\n<ul>\n{notes}</ul>\n");
    }
    let html = document(&format!("{}: surface", page.name), &body);
    Ok(kit::file::write_whole(path, html.as_bytes())?)
}

/// Levels of the curvature of surface and table over wavelength.
fn spectrum(report: &Report) -> String {
    let middle_um = |edges: [f64; 2]| 1e6 * (edges[0] * edges[1]).sqrt();
    let levels = || report.bands.iter().flat_map(|band| [band.surface_db, band.table_db]);
    let low = levels().fold(f64::INFINITY, f64::min).min(1e3);
    let high = levels().fold(f64::NEG_INFINITY, f64::max).max(low + 10.0);
    let x = Axis::decades(1e6 * report.shortest_m, 1e3, "wavelength, µm");
    let mut chart = Chart::new("Curvature in thirds of octaves", x, Axis::linear(low, high, "dB of 1/m²"));
    chart.explain("recording", "surface");
    chart.explain("fit", "table");
    chart.line("recording", report.bands.iter().map(|band| (middle_um(band.wavelengths_m), band.surface_db)));
    for band in &report.bands {
        chart.dot("fit", middle_um(band.wavelengths_m), band.table_db, 3.0);
    }
    chart.figure()
}

/// Heights of the table's first row, or of its first points.
fn profile(title: &'static str, page: &SurfacePage<'_>, points: usize) -> String {
    let row = &page.table.heights[..(page.table.heights.len() / page.report.rows).min(points)];
    let height_um = |height: &i16| 1e6 * f64::from(*height) * page.table.unit_m;
    let low = row.iter().map(height_um).fold(f64::INFINITY, f64::min);
    let high = row.iter().map(height_um).fold(f64::NEG_INFINITY, f64::max);
    let step_mm = 1e3 * page.table.step_m;
    let x = Axis::linear(0.0, row.len() as f64 * step_mm, "along the row, mm");
    let mut chart = Chart::new(title, x, Axis::linear(low, high, "height, µm"));
    let every = row.len().div_ceil(DRAWN).max(1);
    let drawn = row.iter().enumerate().step_by(every);
    chart.line("fit", drawn.map(|(index, height)| (index as f64 * step_mm, height_um(height))));
    chart.figure()
}
