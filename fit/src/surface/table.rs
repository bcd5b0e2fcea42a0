//! The table of a surface.

use std::fmt::Write;

use super::error::SurfaceError;

/// Largest number of heights: 64 KB.
pub(super) const MOST_POINTS: usize = 32_768;

/// A periodic surface of 16-bit heights.
#[derive(Clone, Debug, PartialEq)]
pub struct Table {
    /// Distance of neighbouring points in metres.
    pub step_m: f64,
    /// Number of rows; 1 for a profile.
    pub rows: usize,
    /// Height of one unit in metres.
    pub unit_m: f64,
    /// Shortest wavelength in metres.
    pub shortest_m: f64,
    /// Heights row by row: samples of a periodic function without waves shorter than `shortest_m`.
    pub heights: Vec<i16>,
}

impl Table {
    /// Table of heights in metres, row by row.
    ///
    /// # Errors
    /// [`SurfaceError::TooLarge`] or [`SurfaceError::Flat`].
    pub(super) fn new(heights: &[f64], rows: usize, step_m: f64, shortest_m: f64) -> Result<Self, SurfaceError> {
        let most = heights.iter().fold(0.0, |most: f64, height| most.max(height.abs()));
        if heights.len() > MOST_POINTS {
            return Err(SurfaceError::TooLarge { points: heights.len() });
        }
        if most == 0.0 {
            return Err(SurfaceError::Flat);
        }
        let unit_m = most / f64::from(i16::MAX);
        let heights = heights.iter().map(|height| (height / unit_m).round() as i16).collect();
        Ok(Self { step_m, rows, unit_m, shortest_m, heights })
    }

    /// The table's text in TOML, with a name, a source and a licence.
    pub fn to_toml(&self, name: &str, source: &str, licence: &str) -> String {
        let quoted = |text: &str| format!("{text:?}");
        let mut text = format!("format = 1\nname = {}\n\n[[surface]]\nname = {}\n", quoted(name), quoted(name));
        text += &format!("source = {}\nlicence = {}\n", quoted(source), quoted(licence));
        text += &format!("step_m = {:e}\nrows = {}\n", self.step_m, self.rows);
        text += &format!("unit_m = {:e}\nshortest_m = {:e}\nheights = [", self.unit_m, self.shortest_m);
        for (index, height) in self.heights.iter().enumerate() {
            let gap = if index % 16 == 0 { "\n    " } else { " " };
            // Writing to a string does not fail.
            let _ = write!(text, "{gap}{height},");
        }
        text + "\n]\n"
    }
}
