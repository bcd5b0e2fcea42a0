//! A fitted recording as a page: its sound, pictures and figures in one HTML file that needs nothing else, and an index over many.
//!
//! Sounds and pictures are in the page as data; it fetches nothing, and says so to the browser (Content-Security-Policy). Its figures are in it as
//! JSON, too, from which the index is made.

mod chart;
mod error;
mod figures;
mod index;
mod markup;
mod page;
mod view;

pub use error::ReportError;
pub use index::{INDEX_FILE, write_index};
pub use page::{Summary, write_page};

/// Colours and layout, light and dark, wide and narrow.
const STYLE: &str = include_str!("style.css");
/// Only one sound plays at a time.
const SCRIPT: &str = include_str!("sound.js");
/// What the browser may load: nothing but what is in the page.
const POLICY: &str =
    "default-src 'none'; img-src data:; media-src data:; style-src 'unsafe-inline'; script-src 'unsafe-inline'";

/// The frame of a page.
fn document(title: &str, body: &str) -> String {
    format!(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n<meta name=\"color-scheme\" content=\"light dark\">\n<meta http-equiv=\"Content-Security-Policy\" content=\"{POLICY}\">\n<link rel=\"icon\" href=\"data:,\">\n<title>{title}</title>\n<style>\n{STYLE}</style>\n</head>\n<body>\n<main>\n{body}</main>\n<script>\n{SCRIPT}</script>\n</body>\n</html>\n",
        title = markup::escaped(title)
    )
}
