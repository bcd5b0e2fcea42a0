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
    /// Curvatures of a map; then the profile's curvature and slopes are empty.
    pub map: Option<Map>,
}

/// Curvatures of a surface in two directions, which begins anew at its edges.
#[derive(Clone, Debug, PartialEq)]
pub struct Map {
    /// Number of points in a row, and of rows.
    pub points: [usize; 2],
    /// Distance of the rows in metres.
    pub row_step_m: f64,
    /// Coefficients of the cubic B-splines of `z_xx`, `2 z_xy` and `z_yy`, 1/m, row by row.
    pub curvatures: [Vec<f64>; 3],
    /// Mean of the limited curvature at each limit over the direction θ, 1/m, on top of the
    /// surface's: factors of cos 2θ, sin 2θ, cos 4θ, sin 4θ, cos 6θ and sin 6θ.
    pub mean_waves_per_m: [[f64; 6]; 3],
}

impl Map {
    /// Curvature at a place, with the weights c², c s and s² of the direction (c, s), 1/m.
    pub(super) fn curvature_at(&self, [x, y]: [f64; 2], weights: [f64; 3]) -> f64 {
        let [columns, rows] = self.points.map(|points| points as i64);
        let (column, row) = (x.floor(), y.floor());
        let mut sum = 0.0;
        for (down, weight) in (-1..).zip(basis(y - row)) {
            let line = (row as i64 + down).rem_euclid(rows) * columns;
            for (right, share) in (-1..).zip(basis(x - column)) {
                let index = (line + (column as i64 + right).rem_euclid(columns)) as usize;
                let mixed: f64 = self.curvatures.iter().zip(weights).map(|(map, weight)| map[index] * weight).sum();
                sum += weight * share * mixed;
            }
        }
        sum
    }

    /// Mean of the limited curvature at a limit on top of the surface's, in a direction.
    pub(super) fn mean_at(&self, limit: usize, [c_square, c_s, s_square]: [f64; 3]) -> f64 {
        let angle = (2.0 * c_s).atan2(c_square - s_square);
        let waves = self.mean_waves_per_m[limit].chunks_exact(2);
        (1..)
            .zip(waves)
            .map(|(n, pair)| pair[0] * (f64::from(n) * angle).cos() + pair[1] * (f64::from(n) * angle).sin())
            .sum()
    }
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
    (-1..3).zip(basis(t)).map(|(offset, weight)| at(offset) * weight).sum()
}

/// Weights of the four coefficients about a place, at a fraction behind the second.
fn basis(t: f64) -> [f64; 4] {
    let weights = [
        (1.0 - t).powi(3),
        3.0 * t.powi(3) - 6.0 * t * t + 4.0,
        3.0 * (1.0 - t).powi(3) - 6.0 * (1.0 - t).powi(2) + 4.0,
        t.powi(3),
    ];
    weights.map(|weight| weight / 6.0)
}
