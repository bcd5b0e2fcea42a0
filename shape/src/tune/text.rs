//! Text of a tuned shape file: that of the bar, with other places.

use std::fmt::Write;
use std::ops::Range;

use serde::Deserialize;
use toml::Spanned;

use super::TuneError;
use super::arch::{Bar, SIDES};
use crate::file::{FileError, ShapeFile};
use crate::outline::Point;

/// Places in a text that a tuned bar changes.
#[derive(Deserialize)]
struct Places {
    shape: ShapePlaces,
    #[serde(default)]
    strike: StrikePlaces,
    #[serde(default)]
    sound: SoundPlaces,
}

#[derive(Deserialize)]
struct ShapePlaces {
    polygon_m: Spanned<toml::Value>,
}

#[derive(Default, Deserialize)]
struct StrikePlaces {
    path_m: Option<Spanned<Vec<Point>>>,
}

#[derive(Default, Deserialize)]
struct SoundPlaces {
    at_m: Option<Spanned<Vec<f64>>>,
}

/// The text with the bar's polygon; strikes and what is heard move with the length.
pub(super) fn with(text: &str, file: &ShapeFile, bar: &Bar) -> Result<String, TuneError> {
    let places: Places = toml::from_str(text).map_err(|error| FileError::Text(error.to_string()))?;
    let moved = |at: &[f64]| {
        let mut at = at.to_vec();
        at.iter_mut().take(1).for_each(|x| *x = bar.stretched(*x));
        at
    };
    let mut changes: Vec<(Range<usize>, String)> = vec![(places.shape.polygon_m.span(), points(&bar.polygon(SIDES)))];
    if bar.stretch() != 1.0 {
        if let Some(path) = &places.strike.path_m {
            let path_m = file.strike.path_m.as_deref().unwrap_or(&[]);
            let path_m: Vec<Vec<f64>> = path_m.iter().map(|at| moved(at)).collect();
            changes.push((path.span(), points(&path_m)));
        }
        if let Some(at) = &places.sound.at_m {
            changes.push((at.span(), point(&moved(file.sound.at_m.as_deref().unwrap_or(&[])))));
        }
    }
    changes.sort_by_key(|(span, _)| std::cmp::Reverse(span.start));
    let mut tuned = text.to_owned();
    for (span, value) in changes {
        tuned.replace_range(span, &value);
    }
    ShapeFile::parse(&tuned)?;
    Ok(tuned)
}

/// Coordinates to a tenth of a micrometre.
fn point(at: &[f64]) -> String {
    let plain = |x: &f64| {
        let digits = format!("{x:.7}");
        let short = digits.trim_end_matches('0').trim_end_matches('.');
        if short == "-0" { "0".to_owned() } else { short.to_owned() }
    };
    format!("[{}]", at.iter().map(plain).collect::<Vec<_>>().join(", "))
}

/// Points in rows of four.
fn points<P: AsRef<[f64]>>(points: &[P]) -> String {
    let mut text = String::from("[");
    for (number, at) in points.iter().enumerate() {
        let between = if points.len() > 4 && number % 4 == 0 { "\n    " } else { " " };
        let between = if number == 0 && points.len() <= 4 { "" } else { between };
        // Writing to a string does not fail.
        let _ = write!(text, "{between}{},", point(at.as_ref()));
    }
    text.truncate(text.trim_end_matches(',').len());
    text + if points.len() > 4 { ",\n]" } else { "]" }
}
