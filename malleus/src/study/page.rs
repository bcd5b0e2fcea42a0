//! Page on which a listener rates the sounds of all trials, blind (MUSHRA).

use std::path::{Path, PathBuf};

use serde::Serialize;

use super::error::StudyError;
use super::scene::RATE;
use super::trials::Experiment;
use crate::report::document::document_with;
use crate::report::markup::{json_in_script, sound_uri};

/// File name of the page.
const PAGE_FILE: &str = "index.html";

/// Script of the page.
const SCRIPT: &str = include_str!("mushra.js");

/// Trial with its sounds.
#[derive(Clone, Debug, PartialEq)]
pub struct Rated {
    /// Sentence that describes the event.
    pub text: String,
    /// Methods' names and sounds, 1.0 = full scale.
    pub sounds: Vec<(&'static str, Vec<f32>)>,
}

#[derive(Debug, Serialize)]
struct PageTrial<'a> {
    text: &'a str,
    methods: Vec<&'static str>,
    sounds: Vec<String>,
}

#[derive(Debug, Serialize)]
struct PageStudy<'a> {
    name: &'static str,
    trials: Vec<PageTrial<'a>>,
}

/// Title of a study's page.
fn title(experiment: Experiment) -> String {
    format!("Malleus: {} study", experiment.name())
}

/// Path of a study's page in a folder.
///
/// # Errors
/// [`StudyError::OtherPage`] if that is a page already, other than of this study.
pub fn page_path(folder: &Path, experiment: Experiment) -> Result<PathBuf, StudyError> {
    let path = folder.join(PAGE_FILE);
    let title = format!("<title>{}</title>", title(experiment));
    let is_own = || std::fs::read_to_string(&path).is_ok_and(|html| html.contains(&title));
    if path.exists() && !is_own() { Err(StudyError::OtherPage { path }) } else { Ok(path) }
}

/// Writes the page, whole or not at all. It holds all sounds as 16-bit WAV, and fetches nothing.
///
/// Trials and sounds come in an order that the page draws for each listener. Ratings are kept in
/// the browser until they are saved as CSV: listener, trial, method, rating, order, plays.
///
/// # Errors
/// [`StudyError`] if a sound is too long or the file cannot be written.
pub fn write_page(path: &Path, experiment: Experiment, rated: &[Rated]) -> Result<(), StudyError> {
    let name = experiment.name();
    let verb = match experiment {
        Experiment::Scraping => "scraped",
        Experiment::Rolling => "rolled over",
    };
    let trials = rated.iter().map(encoded).collect::<Result<_, StudyError>>()?;
    let data = serde_json::to_string(&PageStudy { name, trials })?;
    let body = format!(
        "<h1>How real does it sound?</h1>\n\
         <p>Each page describes how something is {verb}, and gives renderings of it in random order. Use headphones. \
         Play all of them as often as you like, and rate how well each one sounds like what is described.</p>\n\
         <noscript><p>This page needs JavaScript. It loads nothing from elsewhere.</p></noscript>\n\
         <section id=\"study\" aria-live=\"polite\"></section>\n\
         <script type=\"application/json\" id=\"data\">{}</script>\n",
        json_in_script(&data)
    );
    let page = document_with(&title(experiment), &body, SCRIPT);
    Ok(kit::file::write_whole(path, page.as_bytes())?)
}

fn encoded(rated: &Rated) -> Result<PageTrial<'_>, StudyError> {
    let uri = |(_, sound): &(&str, Vec<f32>)| {
        let seconds = sound.len() as f64 / RATE.hz();
        sound_uri(sound, RATE.hz()).map_err(|_| StudyError::Sound { seconds })
    };
    let sounds = rated.sounds.iter().map(uri).collect::<Result<_, _>>()?;
    Ok(PageTrial { text: &rated.text, methods: rated.sounds.iter().map(|(name, _)| *name).collect(), sounds })
}
