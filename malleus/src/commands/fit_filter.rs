//! `malleus fit --dynamic-filter`: fits noise through a moving filter to a recording, with modes
//! beside the filter or loops round it.

use std::time::Instant;

use ::fit::dynamic_filter::study::heard_in;
use ::fit::dynamic_filter::table::{Beside, Fitted, fitted};
use ::fit::render;
use ::fit::score::quantile;
use ::fit::table::Provenance;
use malleus::wave::write_mono;
use serde::Serialize;

use super::fit_job::{Job, with_file};
use crate::arguments::{BesideName, FitArguments};

/// Report on the fit of one recording (docs/json.md).
#[derive(Debug, Serialize)]
pub(super) struct FilterReport {
    /// Number of modes beside the filter.
    pub(super) modes: usize,
    /// Number of loops round the filter.
    pub(super) loops: usize,
    /// Order of the filter, 1 or 2.
    order: u8,
    /// Number of breakpoints of the filter's path.
    breakpoints: usize,
    /// Number of Bark bands within 40 dB of the recording's loudest one.
    pub(super) bands: usize,
    /// Number of those bands that decay in the instrument's sound within 15 % of the recording.
    pub(super) bands_within_15_percent: usize,
    /// Median relative error of the decays of those bands.
    pub(super) median_error: f64,
    /// Largest relative error of the decays of those bands.
    worst_error: f64,
    /// Time that the fit took, in seconds.
    pub(super) seconds: f64,
}

/// Fits a recording and writes its table, and its sound if that is asked for.
///
/// `told` gets the share of the work that is done.
///
/// # Errors
/// A message that names the file that cannot be fitted or written.
pub(super) fn fit_and_write(
    arguments: &FitArguments,
    job: &Job,
    beside: BesideName,
    told: &(dyn Fn(f64) + Sync),
) -> Result<FilterReport, String> {
    let begun = Instant::now();
    let of_input = |error| with_file(&job.input, error);
    let heard = heard_in(&job.input).map_err(of_input)?;
    let file = job.input.file_name().unwrap_or_default().to_string_lossy();
    let provenance = Provenance {
        name: job.name.clone(),
        source: format!("{file}, loudest strike, dynamic filter"),
        licence: arguments.licence.clone(),
    };
    let beside = match beside {
        BesideName::Modes => Beside::Modes,
        BesideName::Loops => Beside::Loops,
    };
    let fitted = fitted(&heard, beside, &provenance, told).map_err(of_input)?;
    let text = ::kit::text::write(&fitted.table);
    ::kit::file::write_whole(&job.table, text.as_bytes()).map_err(|error| error.to_string())?;
    if let Some(path) = &arguments.render {
        const RATE_HZ: f64 = ::fit::dynamic_filter::RATE_HZ;
        let frames = (heard.length_s * RATE_HZ) as usize;
        let sound = render::by_instrument(&fitted.table, 0.0, RATE_HZ, frames).map_err(of_input)?;
        write_mono(path, RATE_HZ, &sound).map_err(|error| error.to_string())?;
    }
    Ok(report(&fitted, begun.elapsed().as_secs_f64()))
}

fn report(fitted: &Fitted, seconds: f64) -> FilterReport {
    let Fitted { table, model, bands } = fitted;
    let errors: Vec<f64> = bands.iter().map(|band| band.error()).collect();
    let filter = table.objects.first().and_then(|object| object.dynamic_filter.as_ref());
    FilterReport {
        modes: model.modes.len(),
        loops: model.loops.len(),
        order: filter.map_or(0, |filter| if filter.order == ::kit::Order::Second { 2 } else { 1 }),
        breakpoints: filter.map_or(0, |filter| filter.path.len()),
        bands: bands.len(),
        bands_within_15_percent: fitted.bands_within(),
        median_error: quantile(&errors, 0.5),
        worst_error: quantile(&errors, 1.0),
        seconds,
    }
}
