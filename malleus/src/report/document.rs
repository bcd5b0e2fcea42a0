//! The frame that all pages share.

use super::markup::escaped;

/// Style sheet of all pages: light and dark, wide and narrow.
const STYLE: &str = include_str!("style.css");
/// Script of the reports: only one sound plays at a time.
const SCRIPT: &str = include_str!("sound.js");
/// Policy for the browser, which may load only what the page itself holds.
const POLICY: &str =
    "default-src 'none'; img-src data:; media-src data:; style-src 'unsafe-inline'; script-src 'unsafe-inline'";

/// Writes an HTML document with the style and the policy of all pages, and the script of reports.
pub(super) fn document(title: &str, body: &str) -> String {
    document_with(title, body, SCRIPT)
}

/// Writes an HTML document with the style and the policy of all pages, and a script of its own.
pub(crate) fn document_with(title: &str, body: &str, script: &str) -> String {
    format!(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n<meta name=\"color-scheme\" content=\"light dark\">\n<meta http-equiv=\"Content-Security-Policy\" content=\"{POLICY}\">\n<link rel=\"icon\" href=\"data:,\">\n<title>{title}</title>\n<style>\n{STYLE}</style>\n</head>\n<body>\n<main>\n{body}</main>\n<script>\n{script}</script>\n</body>\n</html>\n",
        title = escaped(title)
    )
}
