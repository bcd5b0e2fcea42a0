//! Surface of an outline with a thickness.

use super::{Surface, SurfaceError};
use crate::mesh::{Mesh, MeshError, Sizing};
use crate::outline::Outline;

/// Chords of a curved side by the length of the outline's longer extent: a disc becomes a polygon
/// of 200 sides, whose area is 0.016 % too small.
const CHORDS: f64 = 64.0;

/// Reason why an outline has no surface.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ExtrudeError {
    /// Outline without a mesh.
    #[error(transparent)]
    Mesh(#[from] MeshError),
    /// Triangles that close no body.
    #[error(transparent)]
    Surface(#[from] SurfaceError),
}

impl Surface {
    /// Makes the surface of the body over an outline, from z = 0 to z = `thickness_m`; curves
    /// become chords.
    ///
    /// # Errors
    /// Says why the outline has no mesh.
    pub fn extruded(outline: &Outline, thickness_m: f64) -> Result<Self, ExtrudeError> {
        let [low, high] = outline.bounds().unwrap_or_default();
        let extent = (high[0] - low[0]).max(high[1] - low[1]);
        let size_m = if outline.is_curved() { extent / CHORDS } else { extent };
        let mesh = Mesh::over(outline, &Sizing::even(size_m))?;
        let count = mesh.points.len();
        let mut points: Vec<_> = mesh.points.iter().map(|point| [point[0], point[1], 0.0]).collect();
        points.extend(mesh.points.iter().map(|point| [point[0], point[1], thickness_m]));
        let mut triangles = Vec::new();
        for &[a, b, c] in &mesh.triangles {
            triangles.push([a, c, b]);
            triangles.push([a, b, c].map(|vertex| vertex + count));
        }
        for edge in &mesh.edges {
            let [from, to] = edge.vertices;
            triangles.push([from, to, to + count]);
            triangles.push([from, to + count, from + count]);
        }
        Ok(Self::new(&points, &triangles)?)
    }
}
