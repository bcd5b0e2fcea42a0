//! Heights as a file has them.

/// Heights on a grid; NaN is a missing point.
#[derive(Clone, Debug, PartialEq)]
pub struct Heights {
    /// Distance of neighbouring points in metres, along rows and between them.
    pub step_m: f64,
    /// Number of points of a row.
    pub columns: usize,
    /// Heights in metres, row by row; a profile is one row.
    pub values: Vec<f64>,
}

impl Heights {
    /// Number of rows; 1 for a profile.
    pub fn rows(&self) -> usize {
        self.values.len() / self.columns.max(1)
    }
}
