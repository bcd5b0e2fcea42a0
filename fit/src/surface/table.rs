//! The table of a surface.

use std::fmt::Write;

use super::error::SurfaceError;

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

/// Units below the largest number that are left to the rounding of a profile.
const MARGIN: i16 = 64;
/// Double pole c and double zero -b of the errors' shape.
const SHAPE: [f64; 2] = [0.9, 0.5];

impl Table {
    /// Table of a profile's heights in metres.
    ///
    /// Rounded one by one, heights would have errors whose curvature grows as f⁴, a whistle of the
    /// table's steps. So errors of rounding e, white and at most half a unit, make the heights'
    /// errors `d = e (1 + b z⁻¹)² / (1 - c z⁻¹)²`, whose curvature falls towards the steps.
    ///
    /// # Errors
    /// [`SurfaceError::Flat`].
    pub(super) fn of_profile(heights: &[f64], step_m: f64, shortest_m: f64) -> Result<Self, SurfaceError> {
        let most = heights.iter().fold(0.0, |most: f64, height| most.max(height.abs()));
        if most == 0.0 {
            return Err(SurfaceError::Flat);
        }
        let unit_m = most / f64::from(i16::MAX - MARGIN);
        let [pole, zero] = SHAPE;
        let (mut of_heights, mut of_rounding) = ([0.0; 2], [0.0; 2]);
        let mut rounded = |height: &f64| {
            let exact = height / unit_m;
            let poles = 2.0 * pole * of_heights[0] - pole * pole * of_heights[1];
            let wanted = exact + poles + 2.0 * zero * of_rounding[0] + zero * zero * of_rounding[1];
            let height = wanted.round();
            of_heights = [height - exact, of_heights[0]];
            of_rounding = [height - wanted, of_rounding[0]];
            height as i16
        };
        // A profile begins anew at its end: the errors of its end come before its beginning.
        heights.iter().for_each(|height| _ = rounded(height));
        let heights = heights.iter().map(rounded).collect();
        Ok(Self { step_m, rows: 1, unit_m, shortest_m, heights })
    }

    /// Table of a map's heights in metres, row by row.
    ///
    /// # Errors
    /// [`SurfaceError::Flat`].
    pub(super) fn of_map(heights: &[f64], rows: usize, step_m: f64, shortest_m: f64) -> Result<Self, SurfaceError> {
        let most = heights.iter().fold(0.0, |most: f64, height| most.max(height.abs()));
        if most == 0.0 {
            return Err(SurfaceError::Flat);
        }
        let unit_m = most / f64::from(i16::MAX);
        let heights = heights.iter().map(|height| (height / unit_m).round() as i16).collect();
        Ok(Self { step_m, rows, unit_m, shortest_m, heights })
    }

    /// Bytes that the table takes in a kit, built as `malleus kit build` builds it.
    ///
    /// # Errors
    /// [`SurfaceError::NotOfKit`] if no kit takes it.
    pub(super) fn bytes_of_kit(&self) -> Result<usize, SurfaceError> {
        let surface = kit::Surface {
            name: "surface".to_owned(),
            source: String::new(),
            licence: String::new(),
            step_m: self.step_m as f32,
            rows: self.rows,
            unit_m: self.unit_m as f32,
            shortest_m: self.shortest_m as f32,
            heights: self.heights.clone(),
        };
        let bytes = |surfaces| {
            let kit = kit::Kit { name: "surface".to_owned(), surfaces, ..kit::Kit::default() };
            kit::binary::build(&kit).map_err(|cause| SurfaceError::NotOfKit { cause: Box::new(cause) })
        };
        Ok(bytes(vec![surface])?.len() - bytes(Vec::new())?.len())
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
