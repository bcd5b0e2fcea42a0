//! Mesh of triangles over an outline.

mod band;
mod boundary;
mod disc;
mod fill;
mod free;
mod measure;
mod polar;
mod rectangle;

use crate::outline::{Outline, OutlineError, Point};

/// Edge of a triangle on the outline.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BoundaryEdge {
    /// Vertices, the body to the left of the way from the first to the second.
    pub vertices: [usize; 2],
    /// Side of the outline, counted through all rings.
    pub side: usize,
    /// Control points of the cubic that the edge follows; `None` if it is straight.
    pub curve: Option<[Point; 2]>,
}

/// Triangles over a flat body.
#[derive(Clone, Debug, PartialEq)]
pub struct Mesh {
    /// Vertices, metres.
    pub points: Vec<Point>,
    /// Vertices of each triangle, counter-clockwise.
    pub triangles: Vec<[usize; 3]>,
    /// All edges on the outline.
    pub edges: Vec<BoundaryEdge>,
}

/// Size of a mesh's elements.
#[derive(Clone, Debug, PartialEq)]
pub struct Sizing {
    /// Length of the longest edge, metres. Edges in a row along a side may be longer by what its
    /// width and its corners add.
    pub size_m: f64,
    /// Width of a row of elements along the sides that are `layered`, metres; `None` for no row.
    pub layer_m: Option<f64>,
    /// True for each side, counted through all rings, with such a row; sides beyond the list's end
    /// have none.
    pub layered: Vec<bool>,
    /// Length of the edges at the corner where each side begins, metres; others follow by a ratio.
    /// `None`, and corners beyond the list's end, have edges of any length.
    pub corners_m: Vec<Option<f64>>,
}

impl Sizing {
    /// Makes a sizing without rows along the sides.
    pub fn even(size_m: f64) -> Sizing {
        Sizing { size_m, layer_m: None, layered: Vec::new(), corners_m: Vec::new() }
    }

    /// Gives the length of the edges at the corner where a side begins, metres.
    pub(super) fn corner_m(&self, side: usize) -> Option<f64> {
        self.corners_m.get(side).copied().flatten()
    }

    /// Tells whether a side has a row of elements along it.
    pub fn is_layered(&self, side: usize) -> bool {
        self.layer_m.is_some() && self.layered.get(side).copied().unwrap_or(false)
    }
}

/// Reason why a mesh cannot be made.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum MeshError {
    /// An outline that is no body's.
    #[error(transparent)]
    Outline(#[from] OutlineError),
    /// A size that is no length.
    #[error("elements of {size_m} m cannot be made: give a size above 0 m")]
    BadSize {
        /// Size, metres.
        size_m: f64,
    },
    /// A size so small that the mesh would be too large.
    #[error("elements of {size_m} m would be about {triangles:.0} triangles, more than {most:.0}: give a larger size")]
    TooFine {
        /// Size, metres.
        size_m: f64,
        /// Estimate of the count of triangles.
        triangles: f64,
        /// Largest count.
        most: f64,
    },
    /// A curve that bends too sharply for any triangle beside it.
    #[error("the curve near ({:.6}, {:.6}) m leaves no room for triangles: widen the corner there", at[0], at[1])]
    Curve {
        /// Place, metres.
        at: Point,
    },
    /// A triangulation that failed.
    #[error("the body cannot be triangulated: {reason}; give another size, or simplify the outline")]
    Failed {
        /// Step that failed.
        reason: String,
    },
}

/// Largest count of triangles.
const MOST: f64 = 2e6;

impl Mesh {
    /// Makes the mesh over an outline: a symmetric one over rectangles and over circles with or
    /// without a concentric hole, one of well-formed triangles over any other.
    ///
    /// # Errors
    /// Says what is wrong with the outline or the sizes, or where no triangles fit.
    pub fn over(outline: &Outline, sizing: &Sizing) -> Result<Mesh, MeshError> {
        let lengths = [Some(sizing.size_m), sizing.layer_m];
        if let Some(size_m) = lengths.into_iter().flatten().find(|size| !(*size > 0.0 && size.is_finite())) {
            return Err(MeshError::BadSize { size_m });
        }
        outline.check()?;
        let sides = outline.sides();
        let size_m = sizing.size_m;
        let triangles = 4.0 * outline.area() / (size_m * size_m) + 2.0 * measure::length(&sides) / size_m;
        if triangles > MOST {
            return Err(MeshError::TooFine { size_m, triangles, most: MOST });
        }
        if let Some(mesh) = rectangle::mesh(outline, sizing).or_else(|| disc::mesh(outline, &sides, sizing)) {
            return Ok(mesh);
        }
        free::mesh(outline, &sides, sizing)
    }
}
