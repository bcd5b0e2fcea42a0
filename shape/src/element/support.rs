//! Supports of a body's sides, and what they hold at each node.

use super::{Error, Nodes};

/// Support of a side of the outline.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Support {
    /// Nothing is held.
    #[default]
    Free,
    /// Displacements are held, and the slope along the side; the body may turn about the side.
    /// Bodies whose nodes do not turn are clamped.
    Hinged,
    /// All is held.
    Clamped,
}

/// Sine of the angle from which on two hinged sides make a corner at which nothing can turn.
const CORNER: f64 = 0.1;

/// Components that are held at each node, in the node's own axes.
#[derive(Clone, Debug)]
pub(super) struct Ties {
    /// Direction of the first of the node's axes in the plane of two of its components; the second
    /// is a quarter turn on.
    pub(super) axes: Vec<[f64; 2]>,
    /// Which components are held.
    pub(super) fixed: Vec<[bool; 3]>,
}

impl Ties {
    /// Holds the nodes of all sides whose support is not free. At hinged ones this holds
    /// component 0, and of 1 and 2 the part along the side, if `hinges`; otherwise it holds all.
    pub(super) fn new(nodes: &Nodes, supports: &[Support], hinges: bool) -> Result<Self, Error> {
        let count = nodes.positions.len();
        let mut ties = Self { axes: vec![[1.0, 0.0]; count], fixed: vec![[false; 3]; count] };
        let mut tangents: Vec<Option<[f64; 2]>> = vec![None; count];
        for edge in &nodes.edges {
            let support = *supports.get(edge.side).ok_or(Error::Side(edge.side))?;
            for (&node, &tangent) in edge.nodes.iter().zip(&edge.tangents) {
                match support {
                    Support::Free => {}
                    Support::Hinged if hinges => {
                        let fixed = &mut ties.fixed[node];
                        fixed[0] = true;
                        fixed[1] = true;
                        match &mut tangents[node] {
                            None => tangents[node] = Some(tangent),
                            Some(before) => fixed[2] |= !joined(before, tangent),
                        }
                    }
                    Support::Hinged | Support::Clamped => ties.fixed[node] = [true; 3],
                }
            }
        }
        for (axis, tangent) in ties.axes.iter_mut().zip(tangents) {
            if let Some(tangent) = tangent {
                *axis = tangent;
            }
        }
        Ok(ties)
    }
}

/// Takes the mean of two directions; `false` if they make a corner.
fn joined(before: &mut [f64; 2], tangent: [f64; 2]) -> bool {
    if (before[0] * tangent[1] - before[1] * tangent[0]).abs() > CORNER {
        return false;
    }
    let sign = (before[0] * tangent[0] + before[1] * tangent[1]).signum();
    let sum = [before[0] + sign * tangent[0], before[1] + sign * tangent[1]];
    *before = sum.map(|part| part / sum[0].hypot(sum[1]));
    true
}
