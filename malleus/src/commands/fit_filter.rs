//! `malleus fit --dynamic-filter`: a recording as noise through a moving filter, with modes beside it or loops round it.

use std::time::Instant;

use ::fit::dynamic_filter::study::heard_in;
use ::fit::dynamic_filter::table::{Beside, Fitted, fitted};
use ::fit::score::quantile;
use ::fit::table::Provenance;
use ::fit::{FitError, render};
use malleus::wave::write_mono;
use serde::Serialize;

use super::fit::Job;
use crate::{BesideName, FitArguments};

/// What became of a recording.
#[derive(Debug, Serialize)]
pub(super) struct FilterReport {
    /// Modes beside the filter, loops round it, its order, its breakpoints.
    pub(super) modes: usize,
    pub(super) loops: usize,
    order: u8,
    breakpoints: usize,
    /// Bark bands within 40 dB of the recording's loudest.
    pub(super) bands: usize,
    /// Of those, whose decay the instrument's sound has within 15 %.
    pub(super) bands_within_15_percent: usize,
    /// Median and worst error of their decays.
    pub(super) median_error: f64,
    worst_error: f64,
    /// Seconds that it took.
    pub(super) seconds: f64,
}

pub(super) fn fit_and_write(arguments: &FitArguments, job: &Job, beside: BesideName) -> Result<FilterReport, FitError> {
    let begun = Instant::now();
    let heard = heard_in(&job.input)?;
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
    let fitted = fitted(&heard, beside, &provenance)?;
    let text = ::kit::text::write(&fitted.table);
    let written = ::kit::file::write_whole(&job.table, text.as_bytes());
    written.map_err(|error| FitError::Render(error.to_string()))?;
    if let Some(path) = &arguments.render {
        const RATE_HZ: f64 = ::fit::dynamic_filter::RATE_HZ;
        let sound = render::by_instrument(&fitted.table, 0.0, RATE_HZ, (heard.length_s * RATE_HZ) as usize)?;
        write_mono(path, RATE_HZ, &sound).map_err(|error| FitError::Render(error.to_string()))?;
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
