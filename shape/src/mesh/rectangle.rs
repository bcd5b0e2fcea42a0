//! Symmetric mesh over a rectangle: cells, each in four triangles around its centre.

use super::{BoundaryEdge, Mesh, Sizing};
use crate::outline::side::{between, distance, mix};
use crate::outline::{Outline, Point};

/// Share of a side by which the corners may be off a rectangle's.
const SQUARE: f64 = 1e-6;

/// Makes the mesh if the outline is a rectangle.
pub(super) fn mesh(outline: &Outline, sizing: &Sizing) -> Option<Mesh> {
    let [ring] = &outline.rings[..] else { return None };
    let [a, b, c, d] = ring[..] else { return None };
    if ring.iter().any(|side| side.curve.is_some()) {
        return None;
    }
    let [a, b, c, d] = [a, b, c, d].map(|side| side.from);
    let (along, across) = (between(a, b), between(a, d));
    let (width, height) = (distance(a, b), distance(a, d));
    let lean = (along[0] * across[0] + along[1] * across[1]).abs() / (width * height);
    let off = distance(c, [a[0] + along[0] + across[0], a[1] + along[1] + across[1]]);
    if lean > SQUARE || off > SQUARE * width.max(height) {
        return None;
    }
    let layers = |first: usize, second: usize| [sizing.is_layered(first), sizing.is_layered(second)];
    let columns = shares(width, sizing, layers(3, 1));
    let rows = shares(height, sizing, layers(0, 2));
    let (across, up) = (columns.len(), rows.len());
    let mut points = Vec::with_capacity(2 * across * up);
    for [low, high] in &rows {
        for [left, right] in &columns {
            points.push(corner_mean([a, b, c, d], [high * right, high * left, low * left, low * right]));
        }
    }
    let name = |column: usize, row: usize| row * across + column;
    let mut mesh = Mesh { points, triangles: Vec::with_capacity(4 * across * up), edges: Vec::new() };
    for row in 0..up - 1 {
        for column in 0..across - 1 {
            let corners = [name(column, row), name(column + 1, row), name(column + 1, row + 1), name(column, row + 1)];
            mesh.push_cell(corners);
        }
    }
    let mut edge = |side: usize, from: usize, to: usize| {
        mesh.edges.push(BoundaryEdge { vertices: [from, to], side, curve: None });
    };
    (0..across - 1).for_each(|k| edge(0, name(k, 0), name(k + 1, 0)));
    (0..up - 1).for_each(|k| edge(1, name(across - 1, k), name(across - 1, k + 1)));
    (0..across - 1).rev().for_each(|k| edge(2, name(k + 1, up - 1), name(k, up - 1)));
    (0..up - 1).rev().for_each(|k| edge(3, name(0, k + 1), name(0, k)));
    Some(mesh)
}

/// Gives the mean of four corners by weights, the opposite ones added first so that mirrored points
/// come out alike. A corner or a point on a side comes from that corner or side alone.
fn corner_mean(corners: [Point; 4], weights: [f64; 4]) -> Point {
    let term = |k: usize, axis: usize| corners[k][axis] * weights[k];
    [0, 1].map(|axis| (term(0, axis) + term(2, axis)) + (term(1, axis) + term(3, axis)))
}

/// Parts a length into even cells, with a layer at those ends that have one if both fit. Gives for
/// each line its shares of the length from the begin and from the end: a line and its mirror image
/// have the same two.
fn shares(length: f64, sizing: &Sizing, layers: [bool; 2]) -> Vec<[f64; 2]> {
    let layer = sizing.layer_m.filter(|layer| 4.0 * layer <= length).map_or(0.0, |layer| layer / length);
    let [begin, end] = layers.map(|layered| if layered { layer } else { 0.0 });
    let middle = 1.0 - begin - end;
    let count = (middle * length / sizing.size_m - 1e-9).ceil().max(1.0) as usize;
    let share = |k: usize, first: f64| first + middle * (k as f64 / count as f64);
    let mut lines: Vec<[f64; 2]> = (0..=count).map(|k| [share(k, begin), share(count - k, end)]).collect();
    if begin > 0.0 {
        lines.insert(0, [0.0, 1.0]);
    }
    if end > 0.0 {
        lines.push([1.0, 0.0]);
    }
    lines
}

impl Mesh {
    /// Parts a cell of four corners, counter-clockwise, into four triangles around its centre.
    pub(super) fn push_cell(&mut self, corners: [usize; 4]) {
        let [a, b, c, d] = corners.map(|corner| self.points[corner]);
        let centre = self.points.len();
        self.points.push(mix(mix(a, c, 0.5), mix(b, d, 0.5), 0.5));
        for k in 0..4 {
            self.triangles.push([corners[k], corners[(k + 1) % 4], centre]);
        }
    }
}
