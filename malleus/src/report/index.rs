//! Index of all pages in a folder.

use std::fs;
use std::path::Path;

use kit::file::FileError;

use super::document::document;
use super::error::ReportError;
use super::markup::escaped;
use super::page::{Summary, material, significant};
use kit::counting::counted;

/// File name of the index.
pub const INDEX_FILE: &str = "index.html";

/// Writes the index [`INDEX_FILE`] of a folder, whole or not at all.
///
/// It has a row for each page of a recording in the folder, whichever run made it, in order of
/// name. Behind them follow the recordings that could not be fitted: `failed` gives their names and
/// the reasons.
///
/// # Errors
/// [`ReportError`] with the path of the folder, or of the file in it that cannot be read or
/// written.
pub fn write_index(folder: &Path, failed: &[(String, String)]) -> Result<(), ReportError> {
    let unreadable = |cause| FileError { action: "read", path: folder.to_owned(), cause };
    let mut pages: Vec<(String, Summary)> = Vec::new();
    for entry in fs::read_dir(folder).map_err(unreadable)? {
        let path = entry.map_err(unreadable)?.path();
        let Some(file) = path.file_name().and_then(|name| name.to_str()) else { continue };
        if file == INDEX_FILE || path.extension().is_none_or(|extension| extension != "html") {
            continue;
        }
        let html = kit::file::read_whole(&path)?;
        if let Some(summary) = std::str::from_utf8(&html).ok().and_then(Summary::in_page) {
            pages.push((file.to_owned(), summary));
        }
    }
    pages.sort_by(|a, b| a.1.name.cmp(&b.1.name).then_with(|| a.0.cmp(&b.0)));
    Ok(kit::file::write_whole(&folder.join(INDEX_FILE), index(&pages, failed).as_bytes())?)
}

/// Distance in dB, or a dash for pages of many strikes, which have none.
fn decibels(distance_db: Option<f64>) -> String {
    distance_db.map_or("\u{2013}".to_owned(), |db| format!("{db:.2}"))
}

fn index(pages: &[(String, Summary)], failed: &[(String, String)]) -> String {
    let mut rows = String::new();
    for (file, summary) in pages {
        rows += &format!(
            "<tr><td><a href=\"{}\">{}</a></td><td>{}</td><td>{}</td><td>{}</td><td>{} to {}</td><td>{:.2}</td><td>{}</td><td>{}</td><td>{:.1}</td></tr>\n",
            address(file),
            escaped(&summary.name),
            summary.modes,
            decibels(summary.lsd_db),
            decibels(summary.lsd_with_residual_db),
            significant(summary.t60_s[0]),
            significant(summary.t60_s[1]),
            summary.contact_time_s * 1e3,
            escaped(&material(summary)),
            summary.room_t60_s.map_or("\u{2013}".to_owned(), |t60_s| format!("{t60_s:.2}")),
            summary.seconds
        );
    }
    for (name, why) in failed {
        rows +=
            &format!("<tr><td>{}</td><td class=\"failed\" colspan=\"8\">{}</td></tr>\n", escaped(name), escaped(why));
    }
    let mut lsd: Vec<f64> = pages.iter().filter_map(|(_, summary)| summary.lsd_db).collect();
    lsd.sort_by(f64::total_cmp);
    let median = fit::score::quantile(&lsd, 0.5);
    let median = if lsd.is_empty() { String::new() } else { format!(", median LSD {median:.2} dB") };
    let body = format!(
        "<h1>Fitted recordings</h1>\n<p class=\"muted\">{}{median}</p>\n<div class=\"scroll\"><table>\n<tr><th>recording</th><th>modes</th><th>LSD, dB</th><th>with residual</th><th>T60, s</th><th>contact, ms</th><th>material, a guess</th><th>room T60, s</th><th>seconds</th></tr>\n{rows}</table></div>\n",
        counted(pages.len(), "recordings")
    );
    document("Fitted recordings", &body)
}

/// Relative address of a file in the folder of the index.
fn address(file: &str) -> String {
    let mut address = String::from("./");
    for byte in file.bytes() {
        if byte.is_ascii_alphanumeric() || b"-._~".contains(&byte) {
            address.push(char::from(byte));
        } else {
            address += &format!("%{byte:02X}");
        }
    }
    address
}
