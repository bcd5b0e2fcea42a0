//! Page of one fitted recording.

use std::fmt::Write;
use std::path::Path;

use fit::recording::Fitted;
use serde::{Deserialize, Serialize};

use super::document::document;
use super::error::ReportError;
use super::figures;
use super::markup::{escaped, json_in_script, sound_uri};
use super::view::View;

/// Figures of a page that an index shows.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Summary {
    /// Name of the recording.
    pub name: String,
    /// Number of modes in the table.
    pub modes: usize,
    /// Log-spectral distance of the fit without its residual, in dB; `None` for many strikes.
    pub lsd_db: Option<f64>,
    /// Log-spectral distance of the fit with its residual, in dB; `None` for many strikes.
    pub lsd_with_residual_db: Option<f64>,
    /// Shortest and longest T60 of a mode in seconds.
    pub t60_s: [f64; 2],
    /// Contact time of the loudest strike in seconds; of many strikes that of the strongest.
    pub contact_time_s: f64,
    /// Material that the object may be made of, with the confidence of that guess (0 to 1).
    pub material: Option<(String, f64)>,
    /// T60 of the room in seconds, if a room is heard.
    pub room_t60_s: Option<f64>,
    /// Time that the fit took, in seconds.
    pub seconds: f64,
}

impl Summary {
    fn of(name: &str, fitted: &Fitted) -> Self {
        let report = &fitted.report;
        Self {
            name: name.to_owned(),
            modes: report.modes,
            lsd_db: Some(report.lsd_db),
            lsd_with_residual_db: Some(report.lsd_with_residual_db),
            t60_s: report.t60_s,
            contact_time_s: report.strikes.get(fitted.fit.loudest).map_or(0.0, |strike| strike.contact_time_s),
            material: report.material.map(|guess| (guess.name.to_owned(), guess.confidence)),
            room_t60_s: report.room.as_ref().map(|room| room.t60_s),
            seconds: report.seconds,
        }
    }

    /// Reads the summary that a page holds; `None` if the page is not that of a recording.
    pub(super) fn in_page(html: &str) -> Option<Self> {
        let (_, rest) = html.split_once(SUMMARY_OPENS)?;
        let (json, _) = rest.split_once(SCRIPT_ENDS)?;
        serde_json::from_str(json).ok()
    }
}

/// Start tag of the element that holds the summary as JSON.
const SUMMARY_OPENS: &str = "<script type=\"application/json\" id=\"summary\">";
/// Start tag of the element that holds all figures as JSON.
const REPORT_OPENS: &str = "<script type=\"application/json\" id=\"report\">";
/// End tag of both elements.
const SCRIPT_ENDS: &str = "</script>";

/// Writes the page of a fitted recording, whole or not at all.
///
/// The title of the page is `name`. The page names the file of the fitted table, `table`.
///
/// # Errors
/// [`ReportError`] with the path of the page.
pub fn write_page(path: &Path, name: &str, table: &Path, fitted: &Fitted) -> Result<(), ReportError> {
    let html = page(path, name, table, fitted)?;
    Ok(kit::file::write_whole(path, html.as_bytes())?)
}

fn page(path: &Path, name: &str, table: &Path, fitted: &Fitted) -> Result<String, ReportError> {
    let view = View::of(fitted);
    let report = &fitted.report;
    let summary = Summary::of(name, fitted);
    let sounds = view.sounds();
    let mut body = String::new();
    body += &heading(name, table, fitted);
    body += &tiles(&summary, fitted);
    body += &players(path, &view, &sounds)?;
    let charts = [
        figures::modes_over_spectrum(&view),
        figures::decays(&view),
        figures::error_over_time(&view),
        figures::loudness_error(path, &view)?,
        figures::audible_partials(&view).unwrap_or_default(),
        figures::bark_gain(&view).unwrap_or_default(),
        figures::residual(&view).unwrap_or_default(),
    ];
    body += &format!(
        "<h2>Spectrograms</h2>\n<div class=\"charts\">\n{}</div>\n",
        figures::spectrograms(path, &view, &sounds)?
    );
    body += &format!(
        "<h2>How it decays, and how near the fit is</h2>\n<div class=\"charts\">\n{}</div>\n",
        charts.concat()
    );
    body += &strikes(fitted);
    body += &partials(fitted);
    body += &modes(fitted);
    body += &rooms(fitted);
    let told: Vec<String> = report.notes.iter().map(ToString::to_string).collect();
    body += &notes(&told);
    body += &figures_as_json(path, &summary, report)?;
    Ok(document(&format!("{name}: fit"), &body))
}

/// Decisions that were made without asking; empty without any.
pub(super) fn notes(notes: &[String]) -> String {
    if notes.is_empty() {
        return String::new();
    }
    let notes: String = notes.iter().map(|note| format!("<li>{}</li>\n", escaped(note))).collect();
    format!("<h2>Decided without asking</h2>\n<ul>\n{notes}</ul>\n")
}

/// Elements that hold the summary and all figures of a page as JSON.
///
/// # Errors
/// [`ReportError::Figures`] with the path of the page.
pub(super) fn figures_as_json(path: &Path, summary: &Summary, report: &impl Serialize) -> Result<String, ReportError> {
    let json = |cause| ReportError::Figures { path: path.to_owned(), cause };
    let summary = json_in_script(&serde_json::to_string(summary).map_err(json)?);
    let figures = json_in_script(&serde_json::to_string(report).map_err(json)?);
    Ok(format!("{SUMMARY_OPENS}{summary}{SCRIPT_ENDS}\n{REPORT_OPENS}{figures}{SCRIPT_ENDS}\n"))
}

/// A figure with its name.
pub(super) fn tile(term: &str, value: &str) -> String {
    format!("<div class=\"tile\"><dt>{term}</dt><dd>{}</dd></div>\n", escaped(value))
}

fn heading(name: &str, table: &Path, fitted: &Fitted) -> String {
    let report = &fitted.report;
    let at_s = report.strikes.get(fitted.fit.loudest).map_or(0.0, |strike| strike.at_s);
    let file = report.input.file_name().unwrap_or_default().to_string_lossy();
    let table = table.file_name().unwrap_or_default().to_string_lossy();
    format!(
        "<h1>{}</h1>\n<p class=\"muted\">{}, the strike at {at_s:.3} s, {} Hz; table {}{}</p>\n",
        escaped(name),
        escaped(&file),
        report.rate_hz,
        escaped(&table),
        if fitted.fit.measured { "; force measured" } else { "" }
    )
}

fn tiles(summary: &Summary, fitted: &Fitted) -> String {
    let report = &fitted.report;
    let estimator = match report.estimator {
        fit::strike::Estimator::Modal => "modal",
        fit::strike::Estimator::Bins => "bins",
    };
    let emergent = report.emergence_db.iter().filter(|db| **db >= fit::bark::EMERGENT_DB).count();
    let with_mode = report.partials.iter().filter(|partial| partial.mode_hz.is_some()).count();
    let mut tiles = vec![
        ("Log-spectral distance", format!("{:.2} dB", report.lsd_db)),
        ("... with residual", format!("{:.2} dB", report.lsd_with_residual_db)),
        ("... in the room", report.lsd_with_room_db.map_or("none heard".to_owned(), |db| format!("{db:.2} dB"))),
        ("ERB distance", format!("{:.2} dB", report.erb_db)),
        ("... with residual", format!("{:.2} dB", report.erb_with_residual_db)),
        ("... first 0.25 s", format!("{:.2} dB", report.hearing.early_erb_db)),
        ("Loudness error", format!("{:.3}", report.hearing.loudness_error)),
        ("... first 0.25 s", format!("{:.3}", report.hearing.early_loudness_error)),
        ("Peak over the recording's", format!("{:+.1} dB", report.hearing.peak_db)),
        ("First 3 ms over the recording's", format!("{:+.1} dB", report.hearing.attack_db)),
        ("Audible partials with a mode", format!("{with_mode} of {}", report.partials.len())),
        ("... at the right level", format!("{:.0} %", 100.0 * report.hearing.partials)),
        ("Modes", format!("{}, {emergent} emergent", summary.modes)),
        ("Frequencies", format!("{:.0} to {:.0} Hz", report.frequency_hz[0], report.frequency_hz[1])),
        ("T60", format!("{} to {} s", significant(summary.t60_s[0]), significant(summary.t60_s[1]))),
        ("Contact time", format!("{:.2} ms", summary.contact_time_s * 1e3)),
        ("Material, a guess", material(summary)),
        (
            "Room",
            report
                .room
                .as_ref()
                .map_or("none heard".to_owned(), |room| format!("{:.2} s, {:.0} dB", room.t60_s, room.gain_db)),
        ),
        ("Residual bands", report.residual_bands.len().to_string()),
        ("Strikes", report.strikes.len().to_string()),
    ];
    if let Some(law) = &report.damping_law {
        tiles.push(("Spectral centroid", format!("{:.0} Hz", law.centroids.whole_hz)));
    }
    tiles.push(("Estimator, time", format!("{estimator}, {:.1} s", summary.seconds)));
    let tiles: String = tiles.iter().map(|(term, value)| tile(term, value)).collect();
    format!("<dl class=\"tiles\">\n{tiles}</dl>\n")
}

/// Guessed material and its confidence, in words.
pub(super) fn material(summary: &Summary) -> String {
    summary.material.as_ref().map_or("none".to_owned(), |(name, share)| format!("{name}, {:.0} %", share * 100.0))
}

/// Writes a time from a millisecond to minutes with two significant digits or more.
pub(super) fn significant(value: f64) -> String {
    let digits = if value < 0.01 {
        4
    } else if value < 0.1 {
        3
    } else if value < 10.0 {
        2
    } else {
        0
    };
    format!("{value:.digits$}")
}

fn players(path: &Path, view: &View<'_>, sounds: &[Vec<f32>; 3]) -> Result<String, ReportError> {
    let names = ["Recording", "Fit, modes alone", "Fit with residual"];
    let mut players = String::new();
    for (name, sound) in names.iter().zip(sounds).take(if view.has_residual() { 3 } else { 2 }) {
        let uri =
            sound_uri(sound, view.rate_hz).map_err(|cause| ReportError::Sound { path: path.to_owned(), cause })?;
        let _ = writeln!(
            players,
            "<div>{name}<audio controls preload=\"auto\" src=\"{uri}\" aria-label=\"{name}\"></audio></div>"
        );
    }
    Ok(format!(
        "<h2>Listen</h2>\n<div class=\"listen\">\n{players}</div>\n<p class=\"muted\">From the strike's onset, all at the level that puts the recording's peak at 0.9. The fit is rendered by the code that a board runs, bit for bit.</p>\n{BLIND}"
    ))
}

/// Blind comparison of the recording with the fit; the script of the page fills it with life.
const BLIND: &str = "<h2>Which one is it?</h2>\n<p class=\"blind\"><button type=\"button\">Play one of the two</button> \
    <button type=\"button\">It was the recording</button> <button type=\"button\">It was the fit</button> \
    <output>0 of 0 right; guesses are right half the time</output></p>\n";

/// Table of the audible partials, the loudest first.
fn partials(fitted: &Fitted) -> String {
    let mut partials = fitted.report.partials.clone();
    partials.sort_by(|a, b| b.level_db.total_cmp(&a.level_db));
    let rows: String = partials
        .iter()
        .map(|partial| {
            let mode = partial.mode_hz.map_or("none".to_owned(), |hz| format!("{hz:.1} Hz"));
            format!(
                "<tr><td>{:.2} s</td><td>{:.0} Hz</td><td>{:.0} dB</td><td>{:+.1} dB</td><td>{mode}</td></tr>\n",
                partial.at_s, partial.frequency_hz, partial.level_db, partial.error_db
            )
        })
        .collect();
    format!(
        "<details><summary>Audible partials</summary>\n<div class=\"scroll\"><table>\n<tr><th>from</th><th>partial</th><th>level</th><th>error of the fit</th><th>mode</th></tr>\n{rows}</table></div></details>\n"
    )
}

fn strikes(fitted: &Fitted) -> String {
    let rows: String = fitted
        .report
        .strikes
        .iter()
        .map(|strike| {
            format!(
                "<tr><td>{:.3} s</td><td>{:.3} ms</td><td>{}</td><td>{:.2} dB</td><td>{:.1} dB</td></tr>\n",
                strike.at_s,
                strike.contact_time_s * 1e3,
                strike.contact_interval_s.map_or("measured".to_owned(), |[shortest, longest]| {
                    format!("{:.2} to {:.2} ms", shortest * 1e3, longest * 1e3)
                }),
                strike.lsd_db,
                strike.residual_db
            )
        })
        .collect();
    format!(
        "<h2>Strikes</h2>\n<div class=\"scroll\"><table>\n<tr><th>at</th><th>contact time</th><th>possible by the sound</th><th>LSD of the model</th><th>energy left</th></tr>\n{rows}</table></div>\n"
    )
}

fn modes(fitted: &Fitted) -> String {
    let rows: String = fitted
        .sounding
        .iter()
        .zip(&fitted.report.emergence_db)
        .map(|(mode, emergence)| {
            let level = 20.0 * mode.amplitude.max(1e-15).log10();
            format!(
                "<tr><td>{:.2} Hz</td><td>{} s</td><td>{:.2} 1/s</td><td>{level:.1} dBFS</td><td>{emergence:.1} dB</td></tr>\n",
                mode.frequency_hz,
                significant(mode.t60_s()),
                mode.decay_per_s
            )
        })
        .collect();
    format!(
        "<details><summary>All modes</summary>\n<div class=\"scroll\"><table>\n<tr><th>frequency</th><th>T60</th><th>decay</th><th>amplitude at the strike</th><th>over the smooth part</th></tr>\n{rows}</table></div></details>\n"
    )
}

fn rooms(fitted: &Fitted) -> String {
    let Some(room) = &fitted.report.room else { return String::new() };
    let rows: String = room
        .bands
        .iter()
        .map(|band| {
            format!(
                "<tr><td>{:.0} to {:.0} Hz</td><td>{:.2} s</td><td>{:.1} dB</td></tr>\n",
                band.edges_hz[0], band.edges_hz[1], band.t60_s, band.gain_db
            )
        })
        .collect();
    format!(
        "<h2>Room</h2>\n<div class=\"scroll\"><table>\n<tr><th>band</th><th>T60</th><th>energy over the direct sound's</th></tr>\n{rows}</table></div>\n"
    )
}
