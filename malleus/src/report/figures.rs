//! Charts of a page, from the figures of a fit.

use std::path::Path;

use fit::bark::EMERGENT_DB;

use super::chart::{Axis, Chart};
use super::markup::data_uri;
use super::view::{View, envelope_db};
use crate::plot::{PlotError, SPECTROGRAM_HZ, signed_png, spectrogram_pngs};

/// Width of a spectrogram in pixels.
const COLUMNS: u32 = 640;
/// Height of a spectrogram in pixels.
const ROWS: u32 = 300;
/// Number of points of a spectrum's line.
const POINTS: usize = 420;
/// Range of levels of a spectrum, in dB below its loudest line.
const RANGE_DB: f64 = 90.0;
/// Label of an axis of level.
const LEVEL: &str = "level, dB";
/// Label of an axis of T60.
const T60: &str = "T60, s";

/// Charts of the spectrograms of the recording and of the fit.
pub(super) fn spectrograms(path: &Path, view: &View<'_>, sounds: &[Vec<f32>; 3]) -> Result<String, PlotError> {
    let shown: Vec<&[f32]> = sounds.iter().map(|sound| &sound[..view.shown]).collect();
    let pictures = spectrogram_pngs(path, &shown, view.rate_hz, COLUMNS, ROWS)?;
    let titles = ["Recording", "Fit, modes alone", "Fit with residual"];
    let charts = titles.into_iter().zip(pictures).take(if view.has_residual() { 3 } else { 2 }).map(|(title, png)| {
        let (time, frequency) = (
            Axis::linear(0.0, view.shown_s(), "time from the strike, s"),
            Axis::frequency(SPECTROGRAM_HZ.0, SPECTROGRAM_HZ.1),
        );
        let mut chart = Chart::new(title, time, frequency);
        chart.picture(&data_uri("image/png", &png));
        chart.figure()
    });
    Ok(charts.collect())
}

/// Chart of the loudness error over time and frequency.
///
/// # Errors
/// [`PlotError`] if the picture cannot be encoded.
pub(super) fn loudness_error(path: &Path, view: &View<'_>) -> Result<String, PlotError> {
    let map = view.loudness_errors();
    let frames = map.first().map_or(0, Vec::len);
    if frames == 0 {
        return Ok(String::new());
    }
    let highest_hz = SPECTROGRAM_HZ.1.min(0.45 * view.rate_hz);
    let centres = fit::hearing::centres_hz(view.rate_hz);
    let ratio = highest_hz / SPECTROGRAM_HZ.0;
    let at = |column: u32, row: u32| {
        let hz = SPECTROGRAM_HZ.0 * ratio.powf((f64::from(row) + 0.5) / f64::from(ROWS));
        let band = centres.partition_point(|centre| *centre < hz).min(map.len() - 1);
        let frame = frames * column as usize / COLUMNS as usize;
        map[band].get(frame).copied().unwrap_or(0.0)
    };
    let png = signed_png(path, COLUMNS, ROWS, at)?;
    let time = Axis::linear(0.0, frames as f64 * 0.002, "time from the strike, s");
    let mut chart = Chart::new(
        "Loudness error (red: too loud, blue: too soft)",
        time,
        Axis::frequency(SPECTROGRAM_HZ.0, highest_hz),
    );
    chart.picture(&data_uri("image/png", &png));
    Ok(chart.figure())
}

/// Chart of the modes over the spectrum of the recording.
pub(super) fn modes_over_spectrum(view: &View<'_>) -> String {
    let range_hz = (SPECTROGRAM_HZ.0, SPECTROGRAM_HZ.1.min(0.5 * view.rate_hz));
    let heard = view.spectrum(view.heard);
    let loudest = heard.0.iter().copied().fold(f64::MIN_POSITIVE, f64::max);
    let axis = Axis::linear(-RANGE_DB, 5.0, LEVEL);
    let mut chart = Chart::new("Modes over the spectrum", Axis::frequency(range_hz.0, range_hz.1), axis);
    chart.explain("recording", "recording");
    chart.explain("fit", "modes");
    chart.explain("fit hollow", "modes in the smooth part");
    chart.line("recording", envelope_db(&heard, range_hz, POINTS, loudest));
    let shown_s = view.shown_s();
    for (mode, emergence) in view.fitted.sounding.iter().zip(&view.fitted.report.emergence_db) {
        let heard = -(-mode.decay_per_s * shown_s).exp_m1();
        let peak = 0.5 * mode.amplitude * heard * view.rate_hz / mode.decay_per_s;
        let class = if *emergence >= EMERGENT_DB { "fit" } else { "fit hollow" };
        chart.stem(class, mode.frequency_hz, 20.0 * (peak / loudest).log10());
    }
    chart.figure()
}

/// Chart of the audible partials: where and how loud they are, and which have a mode.
///
/// `None` if no partial is audible.
pub(super) fn audible_partials(view: &View<'_>) -> Option<String> {
    let partials = &view.fitted.report.partials;
    let levels = || partials.iter().map(|partial| partial.level_db);
    let (softest, loudest) = (levels().reduce(f64::min)?, levels().reduce(f64::max)?);
    let range_hz = (SPECTROGRAM_HZ.0, SPECTROGRAM_HZ.1.min(0.5 * view.rate_hz));
    let axis = Axis::linear((softest - 10.0).max(-10.0), loudest + 5.0, "level, dB SPL");
    let mut chart = Chart::new("Audible partials", Axis::frequency(range_hz.0, range_hz.1), axis);
    chart.explain("law", "with a mode, level right");
    chart.explain("noise", "with a mode, off by over 3 dB");
    chart.explain("fit hollow", "without a mode");
    for partial in partials {
        let class = match partial.mode_hz {
            None => "fit hollow",
            Some(_) if partial.error_db.abs() > fit::hearing::RIGHT_DB => "noise",
            Some(_) => "law",
        };
        chart.stem(class, partial.frequency_hz, partial.level_db);
    }
    Some(chart.figure())
}

/// Chart of T60 over frequency: of the modes, of the damping law and of the room.
pub(super) fn decays(view: &View<'_>) -> String {
    let report = &view.fitted.report;
    let modes = &view.fitted.sounding;
    let energy = |mode: &fit::modes::DampedSine| mode.amplitude * mode.amplitude / mode.decay_per_s;
    let most = modes.iter().map(energy).fold(f64::MIN_POSITIVE, f64::max);
    let law: Vec<(f64, f64)> =
        report.damping_law.iter().flat_map(|law| &law.bands).map(|band| (band.centre_hz, band.t60_s())).collect();
    let room = report.room.iter().flat_map(|room| &room.bands);
    let all = modes
        .iter()
        .map(|mode| mode.t60_s())
        .chain(law.iter().map(|point| point.1))
        .chain(room.clone().map(|band| band.t60_s));
    let (low, high) = all.fold((f64::INFINITY, 0.0_f64), |(low, high), t60| (low.min(t60), high.max(t60)));
    let range_hz = (SPECTROGRAM_HZ.0, SPECTROGRAM_HZ.1.min(0.5 * view.rate_hz));
    let axis = Axis::decades(low.clamp(1e-3, 1e2), high.clamp(2e-3, 1e2), T60);
    let mut chart = Chart::new("Decay", Axis::frequency(range_hz.0, range_hz.1), axis);
    chart.explain("fit", "modes (size: energy)");
    chart.explain("law", "damping law");
    for mode in modes {
        // The radius goes from 1.5, for modes 60 dB below the strongest, to 6.5.
        let level = (1.0 + (energy(mode) / most).log10() / 6.0).clamp(0.0, 1.0);
        chart.dot("fit", mode.frequency_hz, mode.t60_s(), 1.5 + 5.0 * level);
    }
    chart.line("law wide", law);
    if report.room.is_some() {
        chart.explain("room", "room");
        for band in room {
            chart.level("room wide", band.edges_hz[0], band.edges_hz[1], band.t60_s);
        }
    }
    chart.figure()
}

/// Chart of the damping law's gain over frequency, with the spectral centroids.
pub(super) fn bark_gain(view: &View<'_>) -> Option<String> {
    let law = view.fitted.report.damping_law.as_ref()?;
    let loudest = law.bands.iter().map(|band| band.gain).fold(f64::MIN_POSITIVE, f64::max);
    let range_hz = (SPECTROGRAM_HZ.0, SPECTROGRAM_HZ.1.min(0.5 * view.rate_hz));
    let mut chart =
        Chart::new("Gain on the Bark scale", Axis::frequency(range_hz.0, range_hz.1), Axis::linear(-70.0, 5.0, LEVEL));
    chart.explain("law", "gain Λ");
    chart.explain("mark", "spectral centroids");
    let points: Vec<(f64, f64)> =
        law.bands.iter().map(|band| (band.centre_hz, 20.0 * (band.gain / loudest).log10())).collect();
    for &(frequency_hz, level_db) in &points {
        chart.dot("law", frequency_hz, level_db, 3.0);
    }
    chart.line("law", points);
    let centroids = law.centroids;
    for (name, frequency_hz) in [("G2", centroids.below_hz), ("G1", centroids.whole_hz), ("G3", centroids.above_hz)] {
        chart.upright("mark", frequency_hz, name);
    }
    Some(chart.figure())
}

/// Charts of the residual's bands: their level at the strike, and their T60.
pub(super) fn residual(view: &View<'_>) -> Option<String> {
    let bands = &view.fitted.report.residual_bands;
    if bands.is_empty() {
        return None;
    }
    let range_hz = (SPECTROGRAM_HZ.0, SPECTROGRAM_HZ.1.min(0.5 * view.rate_hz));
    let level = |weight: f64| 20.0 * weight.max(1e-9).log10();
    let highest = bands.iter().map(|band| level(band.weight)).fold(-200.0, f64::max);
    let top = (highest / 10.0).ceil() * 10.0;
    let mut levels = Chart::new(
        "Residual: level at the strike",
        Axis::frequency(range_hz.0, range_hz.1),
        Axis::linear(top - 80.0, top, "rms, dBFS"),
    );
    // A band of 0 dB/s has no T60: 10 s stand for it.
    let t60_s = |decay_db_per_s: f64| (60.0 / decay_db_per_s.max(6.0)).max(1e-3);
    let (low, high) = bands
        .iter()
        .map(|band| t60_s(band.decay_db_per_s))
        .fold((f64::INFINITY, 0.0_f64), |(low, high), t60| (low.min(t60), high.max(t60)));
    let mut decays =
        Chart::new("Residual: decay", Axis::frequency(range_hz.0, range_hz.1), Axis::decades(low, high, T60));
    for band in bands {
        levels.bar("noise", band.edges_hz[0], band.edges_hz[1], level(band.weight));
        decays.level("noise wide", band.edges_hz[0], band.edges_hz[1], t60_s(band.decay_db_per_s));
    }
    Some(levels.figure() + &decays.figure())
}

/// Chart of the log-spectral distance over time.
pub(super) fn error_over_time(view: &View<'_>) -> String {
    let modes = view.distance_over_time(view.modes);
    let with_residual = view.distance_over_time(view.with_residual);
    let most = modes.iter().chain(&with_residual).map(|point| point.1).fold(5.0, f64::max);
    let few = modes.len() < FEW_FRAMES;
    let time = Axis::linear(0.0, view.shown_s(), "time from the strike, s");
    let mut chart = Chart::new("Error over time", time, Axis::linear(0.0, most, "log-spectral distance, dB"));
    chart.explain("fit", "modes alone");
    let end_s = view.lsd_end_s();
    chart.upright("mark", end_s, "end of the LSD's stretch");
    if view.has_residual() {
        chart.explain("noise", "with residual");
        draw_frames(&mut chart, "noise", with_residual, few);
    }
    draw_frames(&mut chart, "fit", modes, few);
    chart.figure()
}

/// Number of frames below which each is drawn as a dot, too: a line through one frame is invisible.
const FEW_FRAMES: usize = 4;

fn draw_frames(chart: &mut Chart, class: &str, frames: Vec<(f64, f64)>, dots: bool) {
    for &(time_s, db) in frames.iter().filter(|_| dots) {
        chart.dot(class, time_s, db, 3.0);
    }
    chart.line(class, frames);
}
