//! Curvatures of a surface that is a map, in a `surf` section.

use zerocopy::byteorder::little_endian::I16;

use super::layout::{LIMITS, MapHeader};

/// Curvatures of a surface that is a map.
#[derive(Clone, Copy, Debug)]
pub struct Map<'a> {
    pub(super) header: &'a MapHeader,
    pub(super) points: [usize; 2],
    pub(super) row_step_m: f32,
    pub(super) coefficients: &'a [I16],
}

impl<'a> Map<'a> {
    /// Number of the grid's points in a row, and of its rows.
    pub fn points(&self) -> [usize; 2] {
        self.points
    }

    /// Distance of the grid's rows in metres.
    pub fn row_step_m(&self) -> f32 {
        self.row_step_m
    }

    /// Coefficients of the splines of `z_xx`, `2 z_xy` and `z_yy`, one map behind the other, row by
    /// row; each row has its [`GUARD`](super::layout::GUARD), and each map that of its rows.
    pub fn coefficients(&self) -> &'a [I16] {
        self.coefficients
    }

    /// Mean of the limited curvature at each limit over the direction θ, 1/m, on top of
    /// [`Surface::mean_per_m`](super::Surface::mean_per_m): factors of cos 2θ, sin 2θ, cos 4θ,
    /// sin 4θ, cos 6θ and sin 6θ.
    pub fn mean_waves_per_m(&self) -> [[f32; 6]; LIMITS] {
        self.header.mean_waves_per_m.map(|limit| limit.map(|wave| wave.get()))
    }
}
