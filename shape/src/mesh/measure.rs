//! Measures of a mesh.

use super::Mesh;
use super::boundary::angle;
use super::fill::polygon_area;
use crate::outline::FlatSide;
use crate::outline::side::{between, distance};

impl Mesh {
    /// Gives the area of a triangle with straight edges, square metres.
    pub fn triangle_area(&self, triangle: usize) -> f64 {
        polygon_area(&self.points, &self.triangles[triangle])
    }

    /// Gives the area of all triangles, with the curves of the edges on the outline, square metres.
    pub fn area(&self) -> f64 {
        let straight: f64 = (0..self.triangles.len()).map(|triangle| self.triangle_area(triangle)).sum();
        let bulge = |edge: &super::BoundaryEdge| {
            let [from, to] = edge.vertices.map(|vertex| self.points[vertex]);
            FlatSide { ring: 0, from, to, curve: edge.curve }.swept_area(from)
        };
        straight + self.edges.iter().map(bulge).sum::<f64>()
    }

    /// Gives the smallest angle of all triangles with straight edges, degrees.
    pub fn smallest_angle_deg(&self) -> f64 {
        let corners = |t: &[usize; 3]| [[t[0], t[1], t[2]], [t[1], t[2], t[0]], [t[2], t[0], t[1]]];
        let at = |[a, b, c]: [usize; 3]| {
            let [a, b, c] = [a, b, c].map(|vertex| self.points[vertex]);
            angle(between(a, b), between(a, c)).to_degrees()
        };
        self.triangles.iter().flat_map(corners).map(at).fold(f64::INFINITY, f64::min)
    }

    /// Gives the length of the longest edge, straight from end to end, metres.
    pub fn longest_edge_m(&self) -> f64 {
        let edges = |t: &[usize; 3]| [[t[0], t[1]], [t[1], t[2]], [t[2], t[0]]];
        let length = |[a, b]: [usize; 2]| distance(self.points[a], self.points[b]);
        self.triangles.iter().flat_map(edges).map(length).fold(0.0, f64::max)
    }
}

/// Gives about the length of all sides, metres.
pub(super) fn length(sides: &[FlatSide]) -> f64 {
    let along = |side: &FlatSide| {
        (0..8).map(|k| distance(side.point(f64::from(k) / 8.0), side.point(f64::from(k + 1) / 8.0))).sum::<f64>()
    };
    sides.iter().map(along).sum()
}
