//! Finite elements: from a mesh and a material to the matrices of stiffness and mass.
//!
//! A body ([`Plate`], [`Sheet`], [`Membrane`] or [`Revolve`]) makes a [`Discrete`] of a mesh:
//! the matrices, and the nodes by which a mode is read at any point. Elements are isoparametric
//! triangles of order 1 to 4 ([`Triangle`]); at order 4 they follow the cubic curves of the
//! outline exactly.

mod assembly;
mod discrete;
mod locate;
mod material;
mod membrane;
mod nodes;
mod plate;
mod revolve;
mod sheet;
mod support;
mod triangle;
mod wide;

pub use discrete::Discrete;
pub use material::{Elasticity, Material};
pub use membrane::Membrane;
pub use nodes::{NodeEdge, Nodes};
pub use plate::Plate;
pub use revolve::Revolve;
pub use sheet::{PlaneState, Sheet};
pub use support::Support;
pub use triangle::{Sample, Triangle};
pub use wide::Wide;

/// Error of a discretisation.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum Error {
    /// There are no elements of this order.
    #[error("elements have orders from 1 to 4, not {0}")]
    Order(usize),
    /// A triangle or an edge names a vertex that the mesh does not have.
    #[error("the mesh has no vertex {0}")]
    Vertex(usize),
    /// A vertex belongs to no triangle.
    #[error("vertex {0} belongs to no triangle")]
    Loose(usize),
    /// An edge on the outline belongs to no triangle.
    #[error("the edge from vertex {} to vertex {} belongs to no triangle", .0[0], .0[1])]
    Edge([usize; 2]),
    /// A triangle is clockwise, has no area, or its curved edges cross others.
    #[error("triangle {0} is clockwise, empty or folded by its curved edges")]
    Folded(usize),
    /// The support of a side is not given.
    #[error("the support of side {0} is not given")]
    Side(usize),
    /// A quantity of the body is out of its range.
    #[error("{name} is {value}, which no body can have")]
    Quantity {
        /// Name of the quantity.
        name: &'static str,
        /// Its value, in the unit that its field names.
        value: f64,
    },
    /// An orthotropic material was given to a body whose strain it says too little of.
    #[error("plane strain and bodies of revolution need an isotropic material")]
    Orthotropic,
    /// The supports hold all unknowns.
    #[error("the supports leave nothing that can move")]
    Held,
}

/// Passes a quantity that is finite and above zero.
fn positive(name: &'static str, value: f64) -> Result<f64, Error> {
    if value.is_finite() && value > 0.0 { Ok(value) } else { Err(Error::Quantity { name, value }) }
}
