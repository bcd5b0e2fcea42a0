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
    /// Heights whose rows are the columns of these.
    pub(super) fn turned(&self) -> Self {
        let columns = 0..self.columns;
        let values = columns.flat_map(|column| self.values.iter().skip(column).step_by(self.columns.max(1))).copied();
        Self { step_m: self.step_m, columns: self.rows(), values: values.collect() }
    }

    /// Number of rows; 1 for a profile.
    pub fn rows(&self) -> usize {
        self.values.len() / self.columns.max(1)
    }
}
