//! Faults of a surface.

use super::Point;

/// Reason why triangles are not the surface of one body.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum SurfaceError {
    /// A file that is none of STL or OBJ, or broken.
    #[error("the surface cannot be read: {0}")]
    Text(String),
    /// A file without a triangle.
    #[error(
        "the surface has no triangle of an area above 0: export the body as triangles (of an OBJ file, lines that begin with f)"
    )]
    Empty,
    /// A coordinate that is no number.
    #[error("vertex {0} of the surface has a coordinate that is not finite: export the body again")]
    NotFinite(usize),
    /// A triangle with a vertex that is not there.
    #[error("the surface names a vertex {0} that is not there: export the body again")]
    Vertex(usize),
    /// A triangle's edge without a neighbour.
    #[error("the surface has a gap at the edge from {} to {}: close it", at(.0[0]), at(.0[1]))]
    Gap([Point; 2]),
    /// Two triangles of which one is turned over.
    #[error("the triangles at the edge from {} to {} are turned opposite ways: turn one over", at(.0[0]), at(.0[1]))]
    Turned([Point; 2]),
    /// An edge of more than two triangles of one direction.
    #[error("more than two triangles meet in the edge from {} to {}: the surface must be that of a body", at(.0[0]), at(.0[1]))]
    Branched([Point; 2]),
    /// A surface that encloses a negative volume.
    #[error("the surface is inside out: its triangles must run counter-clockwise seen from outside; turn all over")]
    InsideOut,
    /// Several bodies.
    #[error("the surface is that of {0} separate bodies: give one")]
    Pieces(usize),
    /// A surface that crosses itself.
    #[error("the surface crosses itself near {}: unite its parts to one body", at(*.0))]
    Crossing(Point),
}

fn at(point: Point) -> String {
    format!("({:.6}, {:.6}, {:.6}) m", point[0], point[1], point[2])
}
