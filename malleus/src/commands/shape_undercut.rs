//! `malleus shape --undercut`: the arch that tunes a bar.

use std::path::Path;

use ::shape::tune::{self, Tuned, Wish};
use kit::counting::counted;
use serde::Serialize;

use super::output::progress;
use super::shape::{STEPS, ShapeError};
use crate::arguments::ShapeArguments;

/// Tuned bar, as `--json` prints it (docs/json.md).
#[derive(Debug, Serialize)]
pub(super) struct UndercutReport {
    /// Frequencies of the tuned bending modes, Hz, and as multiples of the lowest.
    frequencies_hz: Vec<f64>,
    ratios: Vec<f64>,
    /// Thickness where it is least, and length, metres.
    thinnest_m: f64,
    length_m: f64,
    /// Number of Newton steps.
    steps: usize,
}

/// Finds the undercut that the arguments ask for; `None` if they ask for none. Writes nothing.
pub(super) fn find(input: &Path, text: &str, arguments: &ShapeArguments) -> Result<Option<Tuned>, ShapeError> {
    let Some(ratios) = &arguments.undercut else { return Ok(None) };
    let bar = progress(STEPS, "cutting the arch");
    let wish = Wish { ratios: ratios.0.clone(), fundamental_hz: arguments.hz };
    let tuned = tune::undercut(text, &wish, &mut |step| bar.set_position(step as u64));
    bar.finish_and_clear();
    tuned.map(Some).map_err(|error| ShapeError::Tune { path: input.to_owned(), error })
}

impl UndercutReport {
    pub(super) fn of(tuned: &Tuned) -> Self {
        let lowest = tuned.frequencies_hz.first().copied().unwrap_or(1.0);
        Self {
            ratios: tuned.frequencies_hz.iter().map(|hz| hz / lowest).collect(),
            frequencies_hz: tuned.frequencies_hz.clone(),
            thinnest_m: tuned.thinnest_m,
            length_m: tuned.length_m,
            steps: tuned.steps,
        }
    }

    pub(super) fn as_text(&self) -> String {
        let ratios: Vec<String> = self.ratios.iter().map(|ratio| format!("{ratio:.4}")).collect();
        format!(
            "undercut: {:.3} Hz, {}; {:.2} mm thick where it is thinnest, {:.2} mm long, after {}\n",
            self.frequencies_hz.first().copied().unwrap_or(0.0),
            ratios.join(" : "),
            1e3 * self.thinnest_m,
            1e3 * self.length_m,
            counted(self.steps, "steps")
        )
    }
}
