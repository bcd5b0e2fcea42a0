//! Measures of a surface's table against the surface.

use serde::Serialize;

use super::error::SurfaceError;
use super::heights::Heights;
use super::statistics::Curvature;
use super::table::Table;
use super::waves::{curvatures, excess_kurtosis, frequency_per_m, spectrum};

/// Longest wavelength in metres of the bands that are compared.
const LONGEST_M: f64 = 1e-3;
/// Least number of the table's waves in a band that is compared.
const LEAST_WAVES: f64 = 3.0;
/// Shortest wavelength of these bands in shortest waves.
const ABOVE_SHORTEST: f64 = 1.2;

/// Level of the curvature in a third of an octave.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct BandLevel {
    /// Wavelengths of the band in metres, the shorter first.
    pub wavelengths_m: [f64; 2],
    /// Mean square of the surface's curvature in dB of 1/m².
    pub surface_db: f64,
    /// Mean square of the table's curvature in dB of 1/m².
    pub table_db: f64,
}

/// Measures of a table, read from its quantised heights, against the surface.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Report {
    /// Shortest wavelength of the table in metres.
    pub shortest_m: f64,
    /// Distance of the table's points in metres.
    pub step_m: f64,
    /// Number of rows; 1 for a profile.
    pub rows: usize,
    /// Number of points of a row.
    pub columns: usize,
    /// Length in metres of a row, of a column in a map whose rows are flat, after which it begins
    /// anew.
    pub length_m: f64,
    /// Rms of the table's heights in metres.
    pub rms_m: f64,
    /// Rms of the table's curvature along its rows in 1/m, across them where rows are flat.
    pub curvature_rms_per_m: f64,
    /// Excess kurtosis of the surface's curvature and of the table's; 0 for a normal distribution.
    pub kurtosis: [f64; 2],
    /// Share of the table's curvature power below its shortest wavelength, in percent.
    pub below_shortest_percent: f64,
    /// Thirds of octaves from 1 mm down to 1.2 shortest wavelengths, 3.6 measured ones if the
    /// spectrum was extended, as far as three of the table's waves lie in them.
    pub bands: Vec<BandLevel>,
    /// Rms of the bands' differences in dB; 0 without bands.
    pub band_rms_db: f64,
    /// Largest difference of a band in dB; 0 without bands.
    pub band_max_db: f64,
    /// Bytes of flash that the table takes in a kit, with what is derived from its heights.
    pub flash_bytes: usize,
}

/// Measures of a table against the curvature of the surface it was made of, of which it keeps waves
/// down to `kept_m`; those of a map whose rows are flat are taken across its rows, `is_turned`.
///
/// # Errors
/// [`SurfaceError::NotOfKit`] if no kit takes the table.
pub(super) fn report(
    table: &Table,
    (surface, kept_m): (&Curvature, f64),
    is_turned: bool,
) -> Result<Report, SurfaceError> {
    let values = table.heights.iter().map(|height| f64::from(*height) * table.unit_m).collect();
    let heights = Heights { step_m: table.step_m, columns: table.heights.len() / table.rows, values };
    let Heights { columns, values: heights, .. } = if is_turned { heights.turned() } else { heights };
    let mean_square = |values: &[f64]| values.iter().map(|x| x * x).sum::<f64>() / values.len().max(1) as f64;
    let all: Vec<f64> = heights.chunks_exact(columns).flat_map(|row| curvatures(row, table.step_m)).collect();
    let power = table_power(&all, columns, table.step_m);
    let length_m = columns as f64 * table.step_m;
    let waves = |[shorter, longer]: [f64; 2]| length_m / shorter - length_m / longer;
    let bands: Vec<BandLevel> = thirds(table.shortest_m.max(kept_m))
        .into_iter()
        .filter(|wavelengths_m| waves(*wavelengths_m) >= LEAST_WAVES)
        .map(|wavelengths_m| {
            let edges_per_m = [1.0 / wavelengths_m[1], 1.0 / wavelengths_m[0]];
            let surface_db = decibels(surface.power(edges_per_m));
            BandLevel { wavelengths_m, surface_db, table_db: decibels(power(edges_per_m)) }
        })
        .collect();
    let differences: Vec<f64> = bands.iter().map(|band| band.table_db - band.surface_db).collect();
    Ok(Report {
        shortest_m: table.shortest_m,
        step_m: table.step_m,
        rows: table.rows,
        columns: table.heights.len() / table.rows,
        length_m,
        rms_m: mean_square(&heights).sqrt(),
        curvature_rms_per_m: mean_square(&all).sqrt(),
        kurtosis: [excess_kurtosis(&surface.all_sorted()), excess_kurtosis(&all)],
        below_shortest_percent: below_percent(power, table.shortest_m),
        band_rms_db: mean_square(&differences).sqrt(),
        band_max_db: differences.iter().fold(0.0, |most: f64, difference| most.max(difference.abs())),
        bands,
        flash_bytes: table.bytes_of_kit()?,
    })
}

/// Share of the curvature power of a profile's table below its shortest wave, in percent.
pub(super) fn below_shortest_percent(table: &Table) -> f64 {
    let heights: Vec<f64> = table.heights.iter().map(|height| f64::from(*height) * table.unit_m).collect();
    let curvatures = curvatures(&heights, table.step_m);
    below_percent(table_power(&curvatures, heights.len(), table.step_m), table.shortest_m)
}

fn below_percent(power: impl Fn([f64; 2]) -> f64, shortest_m: f64) -> f64 {
    let all = power([0.0, f64::INFINITY]).max(f64::MIN_POSITIVE);
    100.0 * power([(1.0 + 1e-9) / shortest_m, f64::INFINITY]) / all
}

/// Mean square of the waves of rows in a band, above the first frequency and up to the second.
fn table_power(curvatures: &[f64], columns: usize, step_m: f64) -> impl Fn([f64; 2]) -> f64 {
    let spectra: Vec<_> = curvatures.chunks_exact(columns).map(spectrum).collect();
    move |edges_per_m| {
        let is_within = |bin: &usize| {
            let frequency = frequency_per_m(*bin, columns, step_m);
            frequency > edges_per_m[0] && frequency <= edges_per_m[1]
        };
        let of_row = |bins: &Vec<fourier::Complex<f64>>| -> f64 {
            (0..bins.len()).filter(is_within).map(|bin| bins[bin].norm_sqr()).sum()
        };
        2.0 * spectra.iter().map(of_row).sum::<f64>() / ((columns as f64).powi(2) * spectra.len() as f64)
    }
}

/// Wavelengths of thirds of octaves from 1 mm down, the shorter first.
fn thirds(shortest_m: f64) -> Vec<[f64; 2]> {
    let factor = 2f64.powf(-1.0 / 3.0);
    let mut all = Vec::new();
    let mut upper = LONGEST_M;
    while upper * factor >= ABOVE_SHORTEST * shortest_m {
        all.push([upper * factor, upper]);
        upper *= factor;
    }
    all
}

fn decibels(power: f64) -> f64 {
    10.0 * power.max(1e-300).log10()
}
