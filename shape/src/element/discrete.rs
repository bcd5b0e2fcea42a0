//! Body with finitely many unknowns.

use super::{Nodes, Triangle};
use crate::eigen::Problem;
use crate::outline::Point;

/// Body with finitely many unknowns: its matrices, and how to read its modes.
#[derive(Clone, Debug)]
pub struct Discrete {
    /// Matrices of stiffness and mass.
    pub problem: Problem,
    /// Nodes of the elements.
    pub nodes: Nodes,
    /// Number of components of the motion: 3 for plates (w, θx, θy) and bodies of revolution
    /// (u_r, u_θ, u_z), 2 for sheets (u, v), 1 for membranes (w).
    pub components: usize,
    /// Unknown of each component of each node, in the axes of the node; `None` if it is held.
    pub unknowns: Vec<[Option<usize>; 3]>,
    /// Direction of the first axis of each node; its second is a quarter turn on.
    pub axes: Vec<[f64; 2]>,
    /// First of the two components that are taken in the axes of the node; `None` if there are
    /// none.
    pub turned: Option<usize>,
    /// Number of motions that the supports allow and that store no energy.
    pub rigid: usize,
}

impl Discrete {
    /// Moves all nodes to a multiple of their positions; the matrices stay.
    pub(crate) fn stretch(&mut self, factor: f64) {
        self.nodes.stretch(factor);
    }

    /// Makes the slopes of a plate's modes smaller by a factor.
    pub(crate) fn turn_less(&self, vectors: &mut [Vec<f64>], factor: f64) {
        for slope in self.unknowns.iter().flat_map(|unknowns| &unknowns[1..]).flatten() {
            vectors.iter_mut().filter_map(|vector| vector.get_mut(*slope)).for_each(|value| *value /= factor);
        }
    }

    /// Returns the components of a mode at a node; those beyond `components` are zero.
    pub fn at_node(&self, vector: &[f64], node: usize) -> [f64; 3] {
        let own = self.unknowns[node].map(|unknown| unknown.and_then(|number| vector.get(number)).map_or(0.0, |v| *v));
        from_axes(own, self.axes[node], self.turned)
    }

    /// Returns the components of a mode at a point; `None` outside the body. Those beyond
    /// `components` are zero.
    pub fn value(&self, vector: &[f64], point: Point) -> Option<[f64; 3]> {
        let (triangle, local) = self.nodes.locate(point)?;
        Some(self.value_in(vector, triangle, local))
    }

    /// Returns the components of a mode at local coordinates of a triangle.
    pub fn value_in(&self, vector: &[f64], triangle: usize, local: [f64; 2]) -> [f64; 3] {
        let mut sum = [0.0; 3];
        for (node, factor) in self.nodes.triangles[triangle].iter().zip(self.functions().values(local)) {
            for (sum, value) in sum.iter_mut().zip(self.at_node(vector, *node)) {
                *sum += factor * value;
            }
        }
        sum
    }

    /// Returns the unknowns of a motion given at each point, as far as the supports allow it.
    pub fn vector(&self, motion: impl Fn(Point) -> [f64; 3]) -> Vec<f64> {
        let mut vector = vec![0.0; self.problem.size];
        for (node, unknowns) in self.unknowns.iter().enumerate() {
            let own = to_axes(motion(self.nodes.positions[node]), self.axes[node], self.turned);
            for (unknown, value) in unknowns.iter().zip(own) {
                if let Some(unknown) = unknown {
                    vector[*unknown] = value;
                }
            }
        }
        vector
    }

    /// Returns the functions of the elements.
    pub fn functions(&self) -> &Triangle {
        &self.nodes.functions
    }
}

/// Takes components from the axes of a node to those of the plane.
pub(super) fn from_axes(own: [f64; 3], axis: [f64; 2], turned: Option<usize>) -> [f64; 3] {
    let mut result = own;
    if let Some(first) = turned {
        result[first] = axis[0] * own[first] - axis[1] * own[first + 1];
        result[first + 1] = axis[1] * own[first] + axis[0] * own[first + 1];
    }
    result
}

/// Takes components from the axes of the plane to those of a node. A linear form of components,
/// such as a strain, goes the same way.
pub(super) fn to_axes(components: [f64; 3], axis: [f64; 2], turned: Option<usize>) -> [f64; 3] {
    from_axes(components, [axis[0], -axis[1]], turned)
}
