//! Page of a recording whose strikes were fitted together.

use std::fmt::Write;
use std::path::Path;

use fit::multi_strike::{Estimate, ModeEstimate};
use serde::Serialize;

use super::document::document;
use super::error::ReportError;
use super::markup::{escaped, sound_uri};
use super::page::{Summary, figures_as_json, notes, significant, tile};
use super::strikes_figures::{Figures, deviations};

/// Longest sound in a page, in seconds; the charts show all of the recording.
const LONGEST_S: f64 = 60.0;
/// Peak of the recording in a page, 1.0 = full scale; that of what is left is at most this.
const PEAK: f64 = 0.9;

/// Content of the page of many strikes.
#[derive(Clone, Copy, Debug)]
pub struct StrikesPage<'a> {
    /// Title of the page.
    pub name: &'a str,
    /// Path of the recording.
    pub input: &'a Path,
    /// Path of the fitted table.
    pub table: &'a Path,
    /// Path of the events that replay the recording.
    pub events: &'a Path,
    /// Fitted modes and strikes.
    pub estimate: &'a Estimate,
    /// The fitted table.
    pub kit: &'a kit::Kit,
    /// Samples of the recording, full scale 1.
    pub recording: &'a [f64],
    /// Samples of table and events as [`crate::render::replay::replay`] plays them, at the
    /// recording's rate, full scale 1. Samples that are missing at the end are silent.
    pub replay: &'a [f64],
    /// Guess at the material, with its confidence from 0 to 1.
    pub material: Option<(&'a str, f64)>,
    /// Decisions that were made without asking.
    pub notes: &'a [String],
    /// Time that the fit took, in seconds.
    pub seconds: f64,
}

impl StrikesPage<'_> {
    /// Length of the recording in seconds.
    pub(super) fn seconds(&self) -> f64 {
        self.recording.len() as f64 / self.estimate.rate_hz
    }

    /// Number of strikers.
    pub(super) fn strikers(&self) -> usize {
        1 + self.estimate.strikes.iter().map(|strike| strike.striker).max().unwrap_or(0)
    }

    /// Samples that the replay leaves of the recording.
    pub(super) fn left(&self) -> Vec<f64> {
        let played = self.replay.iter().copied().chain(std::iter::repeat(0.0));
        self.recording.iter().zip(played).map(|(x, played)| x - played).collect()
    }

    fn t60_s(&self) -> [f64; 2] {
        let t60 = self.estimate.modes.iter().map(ModeEstimate::t60_s);
        let (low, high) = t60.fold((f64::INFINITY, 0.0f64), |(low, high), t60| (low.min(t60), high.max(t60)));
        [low.min(high), high]
    }

    fn summary(&self) -> Summary {
        let strikes = &self.estimate.strikes;
        let strongest = strikes.iter().max_by(|a, b| a.peak_force.total_cmp(&b.peak_force));
        Summary {
            name: self.name.to_owned(),
            modes: self.estimate.modes.len(),
            lsd_db: None,
            lsd_with_residual_db: None,
            t60_s: self.t60_s(),
            contact_time_s: strongest.map_or(0.0, |strike| strike.contact_time_s),
            material: self.material.map(|(name, share)| (name.to_owned(), share)),
            room_t60_s: self.estimate.room.as_ref().map(|room| room.t60_s),
            seconds: self.seconds,
        }
    }
}

/// Writes the page of a recording whose strikes were fitted together, whole or not at all.
///
/// `report` is kept in the page as JSON.
///
/// # Errors
/// [`ReportError`] with the path of the page.
pub fn write_strikes_page(path: &Path, page: &StrikesPage<'_>, report: &impl Serialize) -> Result<(), ReportError> {
    let figures = Figures::of(path, page)?;
    let left = page.left();
    let mut body = heading(page);
    body += &tiles(page, &left);
    body += &players(path, page, &left)?;
    let Figures { over_time, laws } = figures;
    body += &format!("<h2>Over time</h2>\n<div class=\"charts\">\n{over_time}</div>\n{}", deviations(page));
    body += &format!("<h2>What was struck, and how</h2>\n<div class=\"charts\">\n{laws}</div>\n");
    body += &strikes(page);
    body += &modes(page);
    body += &notes(page.notes);
    body += &figures_as_json(path, &page.summary(), report)?;
    Ok(kit::file::write_whole(path, document(&format!("{}: fit", page.name), &body).as_bytes())?)
}

fn file_name(path: &Path) -> String {
    escaped(&path.file_name().unwrap_or_default().to_string_lossy())
}

fn heading(page: &StrikesPage<'_>) -> String {
    format!(
        "<h1>{}</h1>\n<p class=\"muted\">{}, {:.1} s at {} Hz, all strikes together; table {}, events {}</p>\n",
        escaped(page.name),
        file_name(page.input),
        page.seconds(),
        page.estimate.rate_hz,
        file_name(page.table),
        file_name(page.events)
    )
}

/// Level of a sound in dB of full scale.
fn level_dbfs(sound: &[f64]) -> f64 {
    let power = sound.iter().map(|x| x * x).sum::<f64>() / sound.len().max(1) as f64;
    10.0 * power.max(1e-30).log10()
}

fn tiles(page: &StrikesPage<'_>, left: &[f64]) -> String {
    let Estimate { strikes, modes, acceleration, left_dbfs, .. } = page.estimate;
    let [shortest, longest] = page.t60_s().map(significant);
    let contact = strikes.iter().map(|strike| 1e3 * strike.contact_time_s);
    let (low, high) = contact.fold((f64::INFINITY, 0.0f64), |(low, high), time| (low.min(time), high.max(time)));
    let least = strikes.iter().map(|strike| strike.peak_force).fold(1.0, f64::min);
    let recording_dbfs = level_dbfs(page.recording);
    let tiles = [
        ("Strikes", strikes.len().to_string()),
        ("Strikers", page.strikers().to_string()),
        ("Modes", modes.len().to_string()),
        ("T60", format!("{shortest} to {longest} s")),
        ("Contact time", format!("{low:.2} to {high:.2} ms")),
        ("Range of peaks", format!("{:.1} dB", -20.0 * least.log10())),
        ("Recording", format!("{recording_dbfs:.1} dBFS")),
        ("Left by the fit", format!("{left_dbfs:.1} dBFS")),
        ("Left by the replay", format!("{:.1} dBFS", level_dbfs(left))),
        (
            "Acceleration sound",
            if *acceleration == 0.0 { "none heard".to_owned() } else { format!("{acceleration:.2e}") },
        ),
        (
            "Material, a guess",
            page.material.map_or("none".to_owned(), |(name, share)| format!("{name}, {:.0} %", 100.0 * share)),
        ),
        ("Time", format!("{:.1} s", page.seconds)),
    ];
    let tiles: String = tiles.iter().map(|(term, value)| tile(term, value)).collect();
    format!("<dl class=\"tiles\">\n{tiles}</dl>\n")
}

fn players(path: &Path, page: &StrikesPage<'_>, left: &[f64]) -> Result<String, ReportError> {
    let shown = page.recording.len().min((LONGEST_S * page.estimate.rate_hz) as usize);
    let peak = |sound: &[f64]| sound.iter().fold(f64::MIN_POSITIVE, |peak: f64, x| peak.max(x.abs()));
    let scale = PEAK / peak(page.recording);
    let scaled =
        |sound: &[f64], scale: f64| -> Vec<f32> { sound.iter().take(shown).map(|x| (x * scale) as f32).collect() };
    // What is left is made as loud as the recording, by at most 60 dB.
    let louder = (peak(page.recording) / peak(left)).clamp(1.0, 1e3);
    let sounds = [
        ("Recording".to_owned(), scaled(page.recording, scale)),
        ("Replay".to_owned(), scaled(page.replay, scale)),
        (format!("What is left, {:.0} dB louder", 20.0 * louder.log10()), scaled(left, scale * louder)),
    ];
    let mut players = String::new();
    for (name, sound) in sounds {
        let uri = sound_uri(&sound, page.estimate.rate_hz)
            .map_err(|cause| ReportError::Sound { path: path.to_owned(), cause })?;
        // Writing into a string cannot fail.
        let _ = writeln!(
            players,
            "<div>{name}<audio controls preload=\"auto\" src=\"{uri}\" aria-label=\"{name}\"></audio></div>"
        );
    }
    let cut = if shown < page.recording.len() { " The first minute." } else { "" };
    Ok(format!(
        "<h2>Listen</h2>\n<div class=\"listen\">\n{players}</div>\n<p class=\"muted\">At the level that puts the recording's peak at 0.9. The replay is what <code>malleus play</code> makes of table and events.{cut}</p>\n"
    ))
}

/// A value with its standard deviation, if it has one.
fn with_deviation(value: f64, deviation: f64, digits: usize) -> String {
    match deviation.is_finite() {
        true => format!("{value:.digits$} ± {deviation:.digits$}"),
        false => format!("{value:.digits$}"),
    }
}

fn strikes(page: &StrikesPage<'_>) -> String {
    let has_positions = page.estimate.modes.iter().any(|mode| !mode.gains.is_empty());
    let rows: String = page
        .estimate
        .strikes
        .iter()
        .map(|strike| {
            let place = match has_positions {
                true => with_deviation(strike.position, strike.position_sd, 3),
                false => "\u{2013}".to_owned(),
            };
            format!(
                "<tr><td>{}</td><td>{}</td><td>{}</td><td>{place}</td><td>{}</td><td>{:+.1}</td><td>{}</td></tr>\n",
                with_deviation(1e3 * strike.at_s, 1e3 * strike.at_s_sd, 4),
                with_deviation(1e3 * strike.contact_time_s, 1e3 * strike.contact_time_s_sd, 4),
                with_deviation(strike.peak_force, strike.peak_force_sd, 5),
                strike.striker + 1,
                strike.left_db,
                if strike.is_clipped { "clipped" } else { "" }
            )
        })
        .collect();
    format!(
        "<details><summary>All strikes</summary>\n<div class=\"scroll\"><table>\n<tr><th>onset, ms</th><th>contact time, ms</th><th>peak, 1 = strongest</th><th>position</th><th>striker</th><th>left, dB over the median</th><th></th></tr>\n{rows}</table></div></details>\n"
    )
}

fn modes(page: &StrikesPage<'_>) -> String {
    let loudest = page.estimate.modes.iter().map(|mode| mode.gain[0].hypot(mode.gain[1])).fold(0.0, f64::max);
    let rows: String = page
        .estimate
        .modes
        .iter()
        .map(|mode| {
            format!(
                "<tr><td>{}</td><td>{}</td><td>{} s</td><td>{:.1} dB</td><td>{}</td></tr>\n",
                with_deviation(mode.frequency_hz, mode.frequency_hz_sd, 4),
                with_deviation(mode.decay_per_s, mode.decay_per_s_sd, 3),
                significant(mode.t60_s()),
                20.0 * (mode.gain[0].hypot(mode.gain[1]) / loudest).max(1e-9).log10(),
                mode.striker.map_or("object".to_owned(), |striker| format!("striker {}", striker + 1))
            )
        })
        .collect();
    format!(
        "<details><summary>All modes</summary>\n<div class=\"scroll\"><table>\n<tr><th>frequency, Hz</th><th>decay, 1/s</th><th>T60</th><th>gain under the largest</th><th>of</th></tr>\n{rows}</table></div></details>\n"
    )
}
