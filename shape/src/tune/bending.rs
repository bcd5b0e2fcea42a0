//! Bending modes of a bar seen from its side.

use std::f64::consts::TAU;

use super::TuneError;
use crate::eigen;
use crate::file::ShapeFile;
use crate::outline::Outline;
use crate::solve::Body;

/// Modes that are looked at beside the bending ones: longitudinal ones lie among them.
const BESIDE: usize = 4;
/// Longest edge of a triangle, as a share of the bar's height. Elements are of order 4.
const EDGE: f64 = 0.75;

/// Frequencies of the lowest bending modes of a sheet along x, Hz. A mode bends if its motion is
/// across the length more than along it.
pub(super) fn frequencies_hz(file: &ShapeFile, count: usize) -> Result<Vec<f64>, TuneError> {
    let polygon = file.shape.polygon_m.as_deref().unwrap_or(&[]);
    let outline = Outline::polygon(polygon, &[]).map_err(crate::solve::SolveError::Outline)?;
    let [low, high] = outline.bounds().unwrap_or_default();
    let body = Body::of(file, &outline, 0.0)?;
    let mesh = body.mesh(EDGE * (high[1] - low[1]) / body.units.length_m)?;
    let discrete = body.elements(&mesh, 0)?;
    let wanted = eigen::Wanted::Lowest(discrete.rigid + count + BESIDE);
    let found = eigen::modes(&discrete.problem, wanted, &mut |_, _| {}).map_err(crate::solve::SolveError::Eigen)?;
    let bends = |vector: &[f64]| {
        let motions = (0..discrete.nodes.positions.len()).map(|node| discrete.at_node(vector, node));
        let [along, across] = motions.fold([0.0; 2], |sum, at| [sum[0] + at[0] * at[0], sum[1] + at[1] * at[1]]);
        across > along
    };
    let elastic = found.values.iter().zip(&found.vectors).skip(discrete.rigid);
    let bending = elastic
        .filter(|(_, vector)| bends(vector))
        .map(|(value, _)| body.units.rad_per_s * value.max(0.0).sqrt() / TAU);
    let frequencies: Vec<f64> = bending.take(count).collect();
    if frequencies.len() < count { Err(TuneError::NoBending { count }) } else { Ok(frequencies) }
}
