//! Surface as numbers on a grid.

/// Surface of `curvature.len()` points, which begins anew at its end.
#[derive(Clone, Debug, PartialEq)]
pub struct Surface {
    /// Distance of the points in metres.
    pub grid_step_m: f64,
    /// Coefficients of the cubic B-spline of the curvature `z''`, 1/m.
    pub curvature: Vec<f64>,
    /// Limits α in metres at which slopes are given, rising.
    pub alpha_m: [f64; 3],
    /// Mean of the limited curvature at each limit, 1/m, which the slopes leave out.
    pub mean_per_m: [f64; 3],
    /// Gain g by which a mix of the slopes at two neighbouring limits falls short: between them the
    /// weights `1 - s` and `s` become `(1 - s)(1 + g s)` and `s (1 + g (1 - s))`.
    pub mix_gain: [f64; 2],
    /// Coefficients of the cubic B-splines of the slope `S'` at each limit, octave by octave; the
    /// points of octave k lie `2^k` points of the grid apart.
    pub slopes: Vec<[Vec<f64>; 3]>,
}

impl Surface {
    /// Curvature at a place from 0 to the number of points, 1/m.
    pub(super) fn curvature_at(&self, place: f64) -> f64 {
        spline(&self.curvature, place)
    }

    /// Slope in an octave at one of the limits, at a place in points of the grid.
    pub(super) fn slope_at(&self, octave: usize, limit: usize, place: f64) -> f64 {
        spline(&self.slopes[octave][limit], place / (1u64 << octave) as f64)
    }
}

/// Cubic B-spline of periodic coefficients.
fn spline(coefficients: &[f64], place: f64) -> f64 {
    let index = place.floor();
    let t = place - index;
    let at = |offset: i64| coefficients[(index as i64 + offset).rem_euclid(coefficients.len() as i64) as usize];
    let weights = [
        (1.0 - t).powi(3),
        3.0 * t.powi(3) - 6.0 * t * t + 4.0,
        3.0 * (1.0 - t).powi(3) - 6.0 * (1.0 - t).powi(2) + 4.0,
        t.powi(3),
    ];
    (-1..3).zip(weights).map(|(offset, weight)| at(offset) * weight).sum::<f64>() / 6.0
}
